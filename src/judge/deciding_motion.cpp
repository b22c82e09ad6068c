#include "judge/deciding_motion.hpp"

#include <functional>
#include <random>

#include "model/pose.hpp"
#include "reference/dense.hpp"

namespace osculate {

namespace {

using Vector = VectorX<double>;
using Eigen::Index;

constexpr double decides = 0.2;  // part of the difference that the other explanation cannot imitate
constexpr int states = 40;

/// What a motion shakes: joint positions, velocities, commanded accelerations.
struct Shaking {
  std::string words;
  double places, speeds;    // rad or m, rad/s or m/s
  double turning, sliding;  // rad/s^2, m/s^2
  int joint = -1;           // the only one that moves; -1: all
};

}  // namespace

std::string deciding_motion(const Examination& examination, const Fit& best, const Fit& other) {
  const Sample middle = examination.sample(examination.chosen()[examination.chosen().size() / 2]);
  const Index n = middle.qd.size();
  std::vector<Shaking> motions{{"hold still, one after the other, in several poses", 0.5, 0, 0, 0, -1},
                               {"from rest, accelerate the tip along each axis", 0, 0, 0, 2, -1},
                               {"from rest, accelerate the tip about and along each axis", 0, 0, 4, 2, -1}};
  for (Index i = 0; i < n; ++i)
    motions.push_back(
        {"move joint " + std::to_string(i + 1) + " alone, to and fro", 0.1, 1, 0, 0, static_cast<int>(i)});
  motions.push_back(
      {"move all joints at once at different speeds, without commanded acceleration", 0.3, 1, 0, 0, -1});
  motions.push_back({"move all joints at once at different speeds while the tip accelerates and turns", 0.3,
                     1.5, 4, 2, -1});

  const Candidates& candidates = examination.candidates();
  const VectorX<double> weight = examination.difference().sigma.cwiseInverse();
  for (const Shaking& motion : motions) {
    std::mt19937_64 random(1);
    const auto shaken = [&random](double size) {
      return size * (2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1);
    };
    Regression r;
    r.X.setZero(states * n, candidates.columns() + 1);
    r.d.resize(states * n);
    Index at = 0;
    Candidates::Columns columns;
    for (int k = 0; k < states; ++k) {
      Sample sample = middle;
      for (std::size_t i = 0; i < sample.q.size() && sample.q.size() == static_cast<std::size_t>(n); ++i)
        if (motion.joint < 0 || motion.joint == static_cast<int>(i)) sample.q[i] += shaken(motion.places);
      for (Index i = 0; i < n; ++i)
        sample.qd[i] = motion.joint < 0 || motion.joint == i ? shaken(motion.speeds) : 0;
      for (int i = 0; i < 6; ++i) sample.u[i] = shaken(i < 3 ? motion.turning : motion.sliding);
      candidates.follow(sample);
      if (!candidates.evaluate(examination.belief(), sample, columns)) continue;
      r.X.middleRows(at, n).leftCols(candidates.columns()) = weight.asDiagonal() * columns.X;
      at += n;
    }
    if (at == 0) continue;
    r.X.conservativeResize(at, Eigen::NoChange);
    r.d = r.X * best.beta;
    const double all = r.d.squaredNorm();
    if (!(all > 0)) continue;
    const Explanations there(std::move(r), examination.groups());
    if (there.fit(other.groups).rss > decides * decides * all) return motion.words;
  }
  return "none of the motions tried; declare what is known of the controller";
}

}  // namespace osculate
