// The exact torque at one sample, and what each known mistake adds to it. Dense definitions only.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "control/pose_error.hpp"
#include "judge/judge.hpp"

namespace osculate {

/// What a controller may believe of its arm that the model does not say.
struct Belief {
  VectorX<double> armature;                              // change for each velocity coordinate: kg m^2 or kg
  Eigen::Vector4d payload = Eigen::Vector4d::Zero();     // kg, and kg m: first moment about the tip, tip axes
  Vector3<double> tip_offset = Vector3<double>::Zero();  // m, tip axes
};

/// The model as such a controller sees it.
Chain<double> believed(const Chain<double>& model, const Belief& belief);

/// The state of the arm and what was asked of it. One of u and reference.
struct Sample {
  std::vector<double> q;
  VectorX<double> qd;
  Vector6 u = Vector6::Zero();  // angular first; rows that the task does not control are zero
  TipReference reference;
  Eigen::Vector4d quaternion = Eigen::Vector4d::Zero();  // of the reference, w x y z
};

enum class CandidateKind {
  term,       // a term of the exact law: -1 omitted, +1 counted twice
  mistake,    // 1: made
  parameter,  // values with units
  gains,      // not given; estimated
};

struct Candidate {
  std::string id, phrase;
  CandidateKind kind = CandidateKind::term;
  int first = 0, columns = 1;
  std::vector<std::string> names = {}, units = {};  // for each column of a parameter
};

/// Columns are torques: N m or N per unit of their coefficient.
class Candidates {
 public:
  Candidates(const Chain<double>& model, const JudgeOptions& options, bool from_reference, bool order_known,
             ErrorLaw error_law);

  const std::vector<Candidate>& list() const { return list_; }
  int columns() const { return columns_; }
  /// Whether a controller may believe this: loads between nothing and the arm's own mass, a tip within 0.5 m.
  bool possible(const Belief& belief) const;
  /// Of the model, for each velocity coordinate: kg m^2 or kg.
  VectorX<double> armature() const;
  /// The same for what does not move the tip, with more joints than task rows.
  const std::vector<Candidate>& null_space() const { return null_list_; }
  int null_columns() const { return null_columns_; }

  /// Makes the reference of a sample one that the tip is on, accelerated by u; where the log has references.
  void follow(Sample& sample) const;

  struct Columns {
    VectorX<double> exact;  // n; the exact torque, which has no null-space part of its own
    MatrixX<double> P;      // n x n; J* Lambda J M^-1: what the tip feels of a torque
    MatrixX<double> X;      // n x columns(), all in the range of P
    MatrixX<double> null;   // n x null_columns(), all in that of 1 - P
  };
  /// False where the arm is singular on the task rows. `parameters`: whether the columns of armature, payload
  /// and tip point are wanted.
  bool evaluate(const Belief& belief, const Sample& sample, Columns& out, bool parameters = true) const;
  /// The exact torque alone.
  bool exact(const Belief& belief, const Sample& sample, VectorX<double>& out) const;

 private:
  struct Point;
  bool look(const Chain<double>& chain, const Sample& sample, Point& at) const;
  Vector6 command(const Point& at, const TipReference& reference, const Gains& gains, bool feedforward) const;
  void add(std::vector<Candidate>& list, int& columns, Candidate candidate, int count = 1) const;

  Chain<double> model_;
  JudgeOptions options_;
  bool from_reference_, turns_, slides_;  // whether all three rows are controlled
  bool redundant_;
  ErrorLaw error_law_;
  std::vector<Candidate> list_, null_list_;
  int columns_ = 0, null_columns_ = 0;
};

}  // namespace osculate
