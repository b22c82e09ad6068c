#include "benchmarks/arms.hpp"

#include <Eigen/Eigenvalues>
#include <numbers>
#include <stdexcept>

#include "model/random_arm.hpp"
#include "model/urdf.hpp"

namespace osculate::bench {

namespace {

Chain<double> random_chain(int n) {
  Random random(static_cast<std::uint64_t>(n));
  Chain<double> chain;
  for (int i = 0; i < n; ++i) chain.links.push_back(random_link(random, JointType::revolute));
  random_ends(random, chain);
  return chain;
}

Chain<double> model(const std::string& name) {
  ChainChoice choice;
  choice.tip = "tool0";
  return load_urdf(OSCULATE_SOURCE_DIR "/models/" + name + ".urdf", choice).chain;
}

Chain<double> with_rotors(const std::string& name) {
  if (name == "puma560" || name == "arm7") return model(name);
  if (name.starts_with("random")) return random_chain(std::stoi(name.substr(6)));
  throw std::invalid_argument("no arm is named " + name + ": puma560, arm7, random<n>");
}

/// Two of the PUMA's links have numbers that no solid has, which some peers refuse: raises them where needed.
void make_solid(Link<double>& link) {
  if (link.mass == 0) link.mass = 1;
  const Vector3<double> moments =
      Eigen::SelfAdjointEigenSolver<Matrix3<double>>(link.inertia).eigenvalues();  // ascending
  const double shortfall = moments[2] - moments[0] - moments[1];
  if (shortfall >= 0) link.inertia += 1.01 * shortfall * Matrix3<double>::Identity();
}

}  // namespace

Chain<double> chain_named(const std::string& name) {
  Chain<double> chain = with_rotors(name);
  for (Link<double>& link : chain.links) {
    link.armature = 0;
    make_solid(link);
  }
  return chain;
}

std::vector<State> states(int n) {
  Random random(2026);
  const auto list = [&](double bound) {
    std::vector<double> out;
    for (int i = 0; i < n; ++i) out.push_back(random.uniform(-bound, bound));
    return out;
  };
  std::vector<State> out(state_count);
  for (State& state : out) {
    state.q = list(std::numbers::pi);
    state.qd = list(1);
    state.T = list(10);
    for (double& u : state.u) u = random.uniform(-5, 5);
  }
  return out;
}

}  // namespace osculate::bench
