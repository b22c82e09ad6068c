// One way to read a log, and what explains the difference then.
#pragma once

#include "judge/candidates.hpp"
#include "judge/explanation.hpp"

namespace osculate {

/// How a log is read where it does not say.
struct Reading {
  RowOrder u_order = RowOrder::angular_first;
  QuaternionOrder quaternion_order = QuaternionOrder::w_first;
};

/// The samples of a log as the candidates want them.
class Samples {
 public:
  Samples(const Log& log, const JudgeOptions& options, const Reading& reading)
      : log_(log), options_(options), reading_(reading) {}
  Sample at(Eigen::Index k) const;

 private:
  const Log& log_;
  const JudgeOptions& options_;
  Reading reading_;
};

/// The difference on the chosen samples for one belief. Rows are joints, sample by sample, each divided by
/// its noise.
struct Difference {
  Regression regression;       // of what the tip feels
  Regression null;             // of the rest; empty where there is none
  VectorX<double> sigma;       // noise of each joint's difference: N m or N
  double size = 0, noise = 0;  // rms: N m or N
  Eigen::Index samples = 0, left_out = 0;
};

class Examination {
 public:
  /// `order_known`: u is read as declared, so that another order is a mistake of the controller. The
  /// arguments outlive this object.
  Examination(const Chain<double>& model, const Log& log, const JudgeOptions& options, const Reading& reading,
              bool order_known);

  /// Explains the difference; parameters that the torque is not linear in are found by steps of Gauss and
  /// Newton. Throws LogError if too few samples can be used.
  void explain();

  /// The best explanation, and all that are not much worse: see Explanations::search.
  const Fit& best() const { return fits_.front(); }
  const std::vector<Fit>& fits() const { return fits_; }
  const Difference& difference() const { return difference_; }
  const Candidates& candidates() const { return candidates_; }
  /// One for each candidate, and one for the delay.
  const std::vector<ColumnGroup>& groups() const { return groups_; }
  int delay_group() const { return static_cast<int>(groups_.size()) - 1; }
  /// Parameters that moved away from the model on the way to the best explanation.
  const Belief& belief() const { return belief_; }
  double delay() const { return delay_; }  // s
  /// Mean square of what all candidates together leave, times how far neighbouring rows hang together: what a
  /// standard deviation has to be scaled by, squared.
  double noise_square() const { return noise_square_; }
  double price() const { return price_; }  // of one column
  /// Root mean square of what the best explanation leaves, N m or N.
  double rest() const;
  Sample sample(Eigen::Index k) const { return samples_.at(k); }
  const std::vector<Eigen::Index>& chosen() const { return chosen_; }

 private:
  Difference gather() const;
  void set_price(const Explanations& all);
  /// Moves the belief by what the best fit says of this group. False if nothing changed that matters.
  bool take(int g);

  const Log& log_;
  const JudgeOptions& options_;
  Samples samples_;
  Candidates candidates_;
  Eigen::Index n_;
  std::vector<ColumnGroup> groups_;
  std::vector<Eigen::Index> chosen_;
  Eigen::Index saturated_ = 0;  // samples left out for that
  Belief belief_;
  double delay_ = 0;  // s
  std::vector<int> moved_;
  Difference difference_;
  double price_ = 0, noise_square_ = 1;
  std::vector<Fit> fits_;
};

}  // namespace osculate
