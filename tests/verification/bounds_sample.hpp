// The states from which the bounds of the verdict are measured: random arms of every kind, at random states,
// evaluated by the lines that a run evaluates. A seed names one state.
#pragma once

#include "control/rotation.hpp"
#include "model/random_arm.hpp"
#include "model/urdf.hpp"
#include "simulation/integrator.hpp"
#include "verification/step_check.hpp"

namespace osculate::testing {

/// One sampled state, before anything is computed, and of what kind it is.
struct Sample {
  RandomArm arm;
  LawOptions options;
  Pose target;
  bool shipped = false;  // one of the arms in models/
  bool graded = false;   // masses fall along the chain by up to 1000
  bool nearly_singular = false;
  bool slow = false;     // rates below 2e-3 rad/s or m/s
  bool mixed = false;    // joints with several axes among the others
  bool chart = false;    // the law tracks coordinates of its own
  double heavy_tip = 1;  // the last link's mass and inertia were multiplied by this

  bool armature() const {
    return std::any_of(arm.chain.links.begin(), arm.chain.links.end(),
                       [](const auto& link) { return link.armature > 0; });
  }
  bool prismatic() const {
    return std::any_of(arm.chain.links.begin(), arm.chain.links.end(),
                       [](const auto& link) { return link.type == JointType::prismatic; });
  }
};

/// One of the arms in models/ that can hold a pose, without motors or with the inertia of some, in a random
/// state.
inline RandomArm shipped_arm(Random& random) {
  static const std::vector<Chain<double>> arms = [] {
    std::vector<Chain<double>> out;
    for (const char* name : {"puma560", "puma560_akb86", "arm7", "prismatic_arm"}) {
      ChainChoice choice;
      choice.tip = "tool0";
      out.push_back(
          load_urdf(std::filesystem::path(OSCULATE_SOURCE_DIR) / "models" / (std::string(name) + ".urdf"),
                    choice)
              .chain);
    }
    return out;
  }();
  RandomArm arm;
  arm.chain = arms[static_cast<std::size_t>(random.integer(0, 3))];
  const bool motors = random.integer(0, 1) == 0;
  arm.q.resize(arm.chain.n());
  arm.qd.resize(arm.chain.n());
  for (int i = 0; i < arm.chain.n(); ++i) {
    Link<double>& link = arm.chain.links[static_cast<std::size_t>(i)];
    if (motors) link.armature = random.uniform(0.1, 2);
    arm.q[i] = link.type == JointType::revolute ? random.uniform(-3.14, 3.14) : random.uniform(0, 0.5);
    arm.qd[i] = random.uniform(-2, 2);
  }
  return arm;
}

/// Takes the arm to a distance of about `distance` (rad, m) from losing a direction. A shipped arm
/// straightens its wrist. In a random arm every joint from the sixth on turns (or slides) about nearly the
/// same axis as the fifth, so that five directions are left.
inline void straighten(Random& random, bool shipped, double distance, RandomArm& arm) {
  const int n = arm.chain.n();
  if (shipped) {
    arm.q[n - 2] = random.sign() * distance;
    return;
  }
  const Link<double> fifth = arm.chain.links[4];
  for (int i = 5; i < n; ++i) {
    Link<double>& link = arm.chain.links[static_cast<std::size_t>(i)];
    link.type = fifth.type;
    link.axis = fifth.axis;
    link.R_origin = rotation<double>(random.direction(), std::cos(distance), std::sin(distance));
    link.p_origin = distance * random.direction();
    if (link.type == JointType::prismatic) arm.q[i] = random.uniform(-0.3, 0.3);
  }
}

/// 3 to 6 joints of any type, as many as it takes to have at least six coordinates.
inline RandomArm mixed_arm(Random& random, std::uint64_t seed) {
  std::vector<JointType> types;
  int coordinates = 0;
  while (types.size() < 3 || coordinates < 6) {
    types.push_back(static_cast<JointType>(random.integer(0, 6)));
    coordinates += velocity_count(types.back());
  }
  return random_arm_of(seed, types);
}

/// The state of a seed. One in four is of a shipped arm, one in four of these with a payload of 1 to 1000
/// times the last link. The others have n = 6..9 links, one in six of
/// them joints of all types; in half of them the masses fall along the chain, as
/// in real arms, by up to 1000 from base to tip, and in a quarter the last link is 10 to 1e6 times as heavy
/// as drawn. One in eight of all is nearly singular, one in eight slow. u comes from
/// a random pose error; in one of four states the law tracks operational coordinates of its own.
inline Sample draw(std::uint64_t seed) {
  Random random(seed ^ 0x05c111a7e);
  Sample sample;
  RandomArm& arm = sample.arm;
  sample.shipped = random.integer(0, 3) == 0;
  if (sample.shipped) {
    arm = shipped_arm(random);
    if (random.integer(0, 3) == 0) sample.heavy_tip = std::pow(10.0, random.uniform(0, 3));
  } else {
    sample.mixed = random.integer(0, 5) == 0;
    arm = sample.mixed ? mixed_arm(random, seed) : random_arm(seed, random.integer(6, 9));
    const int masses = random.integer(0, 3);
    if (masses == 0) sample.heavy_tip = std::pow(10.0, random.uniform(1, 6));
    sample.graded = masses > 1;
  }
  const int n = arm.chain.n();
  if (sample.graded) {
    const double per_link = std::pow(10.0, random.uniform(-3, 0) / std::max(n - 1, 1));
    double factor = 1;
    for (auto& link : arm.chain.links) {
      link.mass *= factor;
      link.inertia *= factor;
      link.armature *= factor;
      factor *= per_link;
    }
  }
  arm.chain.links.back().mass *= sample.heavy_tip;
  arm.chain.links.back().inertia *= sample.heavy_tip;
  sample.nearly_singular = random.integer(0, 7) == 0 && !sample.mixed;
  if (sample.nearly_singular) straighten(random, sample.shipped, std::pow(10.0, random.uniform(-6, -2)), arm);
  sample.slow = random.integer(0, 7) == 0;
  if (sample.slow) arm.qd *= 1e-3;

  if (arm.chain.velocities() > 6) sample.options.null_space.damping = random.integer(0, 1);
  sample.target = tip_pose(arm.chain, {arm.q.data(), static_cast<std::size_t>(arm.q.size())});
  sample.target.p += random.uniform(0, 0.1) * random.direction();
  sample.target.R = exp_rotation(random.uniform(0, 0.5) * random.direction()) * sample.target.R;
  sample.chart = random.integer(0, 3) == 0;
  if (sample.chart) {
    sample.options.orientation = static_cast<OrientationCoordinates>(random.integer(0, 3));
    sample.options.position = static_cast<PositionCoordinates>(random.integer(0, 2));
  }
  return sample;
}

/// Both sides at a sampled state. Throws IntegrationStopped where the arm is singular to working accuracy.
inline Evidence evidence(const Sample& sample) {
  const RandomArm& arm = sample.arm;
  Controller controller(arm.chain, {}, sample.options, make_path(HoldOptions{}), sample.target);
  ClosedLoop loop(std::move(controller), Plant{arm.chain, {}, Vector6::Zero()});
  std::vector<double> y(loop.states(), 0.0);
  std::copy(arm.q.begin(), arm.q.end(), y.begin());
  std::copy(arm.qd.begin(), arm.qd.end(), y.begin() + loop.positions());
  return gather(loop, 0, y);
}

inline Evidence sample_state(std::uint64_t seed) { return evidence(draw(seed)); }

}  // namespace osculate::testing
