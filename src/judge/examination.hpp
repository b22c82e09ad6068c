// One way to read a log, and what explains the difference then.
#pragma once

#include "judge/candidates.hpp"
#include "judge/explanation.hpp"

namespace osculate {

/// How a log is read where it does not say.
struct Reading {
  RowOrder u_order = RowOrder::angular_first;
  QuaternionOrder quaternion_order = QuaternionOrder::w_first;
  ErrorLaw error_law = ErrorLaw::rotation_vector;
};

/// The samples of a log as the candidates want them.
class Samples {
 public:
  Samples(const Log& log, const JudgeOptions& options, const Reading& reading)
      : log_(log), options_(options), reading_(reading) {}
  Sample at(Eigen::Index k) const;
  const Reading& reading() const { return reading_; }

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

/// How a controller differs from the exact law in what the torque is not linear in.
struct Deviation {
  Belief belief;
  double delay = 0;        // s
  std::vector<int> moved;  // groups whose parameters these are
};

class Examination {
 public:
  /// `order_known`: u is read as declared, so that another order is a mistake of the controller. The
  /// arguments outlive this object.
  Examination(const Chain<double>& model, const Log& log, const JudgeOptions& options, const Reading& reading,
              bool order_known);

  /// Explains the difference. Parameters that the torque is not linear in are found by steps of Gauss and
  /// Newton; those without which the rest explains as much are dropped again. Throws LogError if too few
  /// samples can be used.
  void explain();
  /// The first round of explain() alone: enough to compare readings.
  void glance();
  const Reading& reading() const { return samples_.reading(); }

  /// The best explanation, and all that are not much worse: see Explanations::search.
  const Fit& best() const { return now_.fits.front(); }
  const std::vector<Fit>& fits() const { return now_.fits; }
  const Difference& difference() const { return now_.difference; }
  const Candidates& candidates() const { return candidates_; }
  /// One for each candidate, and one for the delay.
  const std::vector<ColumnGroup>& groups() const { return groups_; }
  int delay_group() const { return static_cast<int>(groups_.size()) - 1; }
  /// Parameters that moved away from the model on the way to the best explanation.
  const Belief& belief() const { return now_.deviation.belief; }
  double delay() const { return now_.deviation.delay; }  // s
  /// Mean square of what all candidates together leave, times how far neighbouring rows hang together: what a
  /// standard deviation has to be scaled by, squared.
  double noise_square() const { return now_.noise_square; }
  double price() const { return now_.price; }  // of one column
  /// Mean square of the difference from the model's exact torque as far as the tip feels it: (N m)^2 or N^2.
  double asked() const { return asked_; }
  /// Mean square that the best explanation leaves: (N m)^2 or N^2.
  double left_over() const { return left(now_.difference, best()); }
  /// The same as a part of asked(), and by which part it would grow without one of its groups.
  double rest() const;
  double explained_by(int g) const;
  Sample sample(Eigen::Index k) const { return samples_.at(k); }
  const std::vector<Eigen::Index>& chosen() const { return chosen_; }

 private:
  struct Attempt {
    Deviation deviation;
    Difference difference;
    double noise_square = 1, price = 0;
    std::vector<Fit> fits;
  };
  /// The whole difference from the model's exact law. False where it is no more than rounding.
  bool weigh(const Deviation& none);
  /// Up to `most` rounds of Gauss and Newton from `start`, without the groups in `banned`; given up where the
  /// score is far above that of `rival`. Without fits where `start` is no arm.
  Attempt solve(const Deviation& start, const std::vector<int>& banned, const Attempt* rival, int most) const;
  /// Bans a group that explains next to nothing, or whose parameters nothing needs. False if there is none.
  bool drop_one(std::vector<int>& banned);
  Difference gather(const Deviation& deviation) const;
  /// Mean square of what a fit leaves: (N m)^2 or N^2.
  double left(const Difference& difference, const Fit& fit) const;
  bool sensible(const Fit& fit, const Deviation& deviation, const std::vector<int>& banned) const;
  std::string id_of(int g) const;
  void set_price(const Explanations& all, Attempt& attempt) const;
  /// Adds what a fit says of this group to the deviation. False for a group that is none of its parameters.
  bool add_step(int g, const Fit& fit, Deviation& deviation) const;
  /// Moves the deviation by what a fit says of this group. False if nothing changed that matters.
  bool take(int g, const Attempt& attempt, Deviation& deviation) const;
  /// The same deviation without the parameters of this group.
  Deviation without(int g, Deviation deviation) const;

  const Log& log_;
  const JudgeOptions& options_;
  Samples samples_;
  Candidates candidates_;
  Eigen::Index n_;
  std::vector<ColumnGroup> groups_;
  std::vector<Eigen::Index> chosen_;
  Eigen::Index saturated_ = 0;      // samples left out for that
  double asked_ = 0, weighed_ = 0;  // the whole difference: mean square, and squares over the noise
  Attempt now_;
};

}  // namespace osculate
