#include "jury/states.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/random_arm.hpp"
#include "reference/conditioning.hpp"
#include "reference/dense.hpp"

namespace osculate::jury {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double nearly_singular_condition = 1e8;

struct Range {
  double low, high;
};

/// Of a joint with one axis. A continuous joint has no limits, whatever the file says.
Range position_range(const JointInfo& joint) {
  if (!joint.continuous && joint.lower && joint.upper && *joint.lower <= *joint.upper)
    return {*joint.lower, *joint.upper};
  return joint.type == JointType::revolute ? Range{-pi, pi} : Range{-0.5, 0.5};
}

double capped(const std::optional<double>& limit, double most) {
  return limit && *limit > 0 ? std::min(*limit, most) : most;
}

void draw_position(Random& random, const JointInfo& joint, double* q) {
  if (one_axis(joint.type)) {
    const auto [low, high] = position_range(joint);
    q[0] = random.uniform(low, high);
    return;
  }
  const auto angle = [&random] { return random.uniform(-pi, pi); };
  const auto displacement = [&random] { return random.uniform(-0.5, 0.5); };
  switch (joint.type) {
    case JointType::cylindrical:
      q[0] = angle(), q[1] = displacement();
      break;
    case JointType::universal:
      q[0] = angle(), q[1] = angle();
      break;
    case JointType::planar:
      q[0] = displacement(), q[1] = displacement(), q[2] = angle();
      break;
    default: {  // spherical, floating
      Eigen::Vector4d e;
      do
        for (double& x : e) x = random.uniform(-1, 1);
      while (!(e.squaredNorm() <= 1 && e.squaredNorm() > 0.01));
      e /= e[0] < 0 ? -e.norm() : e.norm();
      std::copy_n(e.data(), 4, q);
      if (joint.type == JointType::floating)
        for (int i = 4; i < 7; ++i) q[i] = displacement();
    }
  }
}

JointState draw(Random& random, const ArmDescription& arm) {
  const int np = arm.chain.positions(), nv = arm.chain.velocities();
  JointState out{StateKind::random,   VectorX<double>(np), VectorX<double>(nv),
                 VectorX<double>(nv), VectorX<double>(nv), Vector6::Zero()};
  double* q = out.q.data();
  for (const JointInfo& joint : arm.joints) {
    draw_position(random, joint, q);
    q += position_count(joint.type);
  }
  Eigen::Index at = 0;
  for (const JointInfo& joint : arm.joints) {
    const double fastest = capped(joint.velocity, 2), strongest = capped(joint.effort, 20);
    for (int i = 0; i < velocity_count(joint.type); ++i, ++at) {
      out.qd[at] = random.uniform(-fastest, fastest);
      out.tau[at] = random.uniform(-strongest, strongest);
      out.qdd[at] = random.uniform(-5, 5);
    }
  }
  for (double& u : out.u) u = random.uniform(-5, 5);
  return out;
}

/// Condition number of Omega on the task rows, scaled to unit diagonal; infinite where it has lost rank.
double condition_at(const Chain<double>& chain, const TaskRows& rows, const VectorX<double>& q) {
  const auto joints = positions<double>(chain, {q.data(), static_cast<std::size_t>(q.size())});
  const auto state = dense::state<double>(chain, joints, VectorX<double>::Zero(chain.velocities()));
  return scaled_condition(dense::mobility(state.tip, state.joint, rows).Omega);
}

/// Where the search for a singularity may move one coordinate. Of long arms the last eight are enough to ask
/// for.
struct Coordinate {
  Eigen::Index at;
  Range range;
};
std::vector<Coordinate> one_axis_coordinates(const ArmDescription& arm) {
  std::vector<Coordinate> out;
  Eigen::Index at = 0;
  for (const JointInfo& joint : arm.joints) {
    if (one_axis(joint.type)) out.push_back({at, position_range(joint)});
    at += position_count(joint.type);
  }
  if (out.size() > 8) out.erase(out.begin(), out.end() - 8);
  return out;
}

/// Follows one coordinate after the other to the largest condition number along it: by a grid over its range,
/// then by thirds between the neighbours of the best place.
VectorX<double> towards_singularity(const ArmDescription& arm, const TaskRows& rows, VectorX<double> q) {
  const auto condition = [&](const VectorX<double>& x) { return condition_at(arm.chain, rows, x); };
  constexpr int grid = 36, thirds = 40, rounds = 3;
  double best = condition(q);
  for (int round = 0; round < rounds; ++round)
    for (const Coordinate& coordinate : one_axis_coordinates(arm)) {
      const Eigen::Index at = coordinate.at;
      const Range range = coordinate.range;
      if (best > 100 * nearly_singular_condition) return q;
      const double step = (range.high - range.low) / grid;
      VectorX<double> x = q;
      const auto along = [&](double value) {
        x[at] = value;
        return condition(x);
      };
      double place = q[at];
      for (int i = 0; i <= grid; ++i)
        if (const double c = along(range.low + i * step); c > best) best = c, place = range.low + i * step;
      double low = std::max(range.low, place - step), high = std::min(range.high, place + step);
      for (int i = 0; i < thirds; ++i) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        const bool rises = along(a) < along(b);
        (rises ? low : high) = rises ? a : b;
      }
      if (const double middle = (low + high) / 2, c = along(middle); c > best) best = c, place = middle;
      q[at] = place;
    }
  return q;
}

/// A place on the way from q to `singular` where the condition number passes nearly_singular_condition;
/// `singular` itself if it stays below.
VectorX<double> nearly_singular(const ArmDescription& arm, const TaskRows& rows, const VectorX<double>& q,
                                const VectorX<double>& singular) {
  const auto place = [&](double s) { return VectorX<double>(q + s * (singular - q)); };
  const auto below = [&](double s) {
    return condition_at(arm.chain, rows, place(s)) < nearly_singular_condition;
  };
  if (below(1)) return singular;
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) (below((low + high) / 2) ? low : high) = (low + high) / 2;
  return place(low);
}

}  // namespace

std::string name_of(StateKind kind) {
  switch (kind) {
    case StateKind::random:
      return "random";
    case StateKind::nearly_singular:
      return "nearly_singular";
    case StateKind::at_rest:
      return "at_rest";
  }
  return "?";
}

std::vector<JointState> random_states(const ArmDescription& arm, int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<JointState> out;
  for (int i = 0; i < count; ++i) out.push_back(draw(random, arm));
  return out;
}

std::vector<JointState> reference_states(const ArmDescription& arm, const TaskRows& rows, int count,
                                         std::uint64_t seed) {
  std::vector<JointState> out = random_states(arm, count, seed);
  out.at(0).kind = StateKind::at_rest;
  out.at(0).qd.setZero();
  JointState& singular = out.at(1);
  if (arm.chain.velocities() < static_cast<int>(rows.size())) return out;  // singular everywhere
  singular.kind = StateKind::nearly_singular;
  singular.q = nearly_singular(arm, rows, singular.q, towards_singularity(arm, rows, singular.q));
  return out;
}

std::string definition() {
  return "Random numbers: splitmix64 (Steele, Lea, Flood 2014) started at the seed; a number in [low, high) "
         "is "
         "low + (high - low) * ((next >> 11) * 2^-53). State after state: q of every joint, base to tip, "
         "then "
         "for every velocity coordinate qd, tau, qdd_given, then u (6). Ranges: q within the limits of the "
         "file; without limits, and for continuous joints, [-pi, pi) rad or [-0.5, 0.5) m; a quaternion is "
         "four "
         "numbers in [-1, 1), drawn again unless 0.01 < their sum of squares <= 1, divided by their length, "
         "w >= 0. |qd| < the velocity limit, at most 2; |tau| < the effort limit, at most 20; |qdd_given| < "
         "5; "
         "|u| < 5. State 0: qd = 0. State 1: q moved towards a singularity of the task rows.";
}

}  // namespace osculate::jury
