#include "paper/tables.hpp"

#include <cmath>
#include <limits>

#include "paper/bounds.hpp"
#include "paper/question.hpp"
#include "paper/recursions.hpp"

namespace osculate::paper {

namespace {

// Task rows whose pivot of Omega falls below this fraction of the largest of their kind are left out of the
// task.
constexpr double row_floor = 1e-6;

}  // namespace

const std::vector<Statement>& statements() {
  static const std::vector<Statement> all = [] {
    std::vector<Statement> out;
    for (const auto& i : dense::identities<double>()) out.push_back({i.equation, i.statement, "identities"});
    for (const auto& r : recursions<double>()) out.push_back({r.equation, r.statement, r.place});
    return out;
  }();
  return all;
}

const std::vector<Statement>& printed_forms() {
  static const std::vector<Statement> all = [] {
    std::vector<Statement> out;
    for (const auto& i : dense::printed_errors<double>())
      out.push_back({i.equation, i.statement, "printed_errors"});
    out.push_back({"section 4.3", "the same recipe by the sweeps", "compliance_at_tip"});
    return out;
  }();
  return all;
}

std::vector<double> residuals(const Chain<double>& chain, const VectorX<double>& q, const VectorX<double>& qd,
                              std::uint64_t seed) {
  const auto joints = positions(chain, std::span<const double>(q.data(), static_cast<std::size_t>(q.size())));
  const Trial<double> t = trial(question(chain, joints, qd, seed, row_floor));
  constexpr double missing = std::numeric_limits<double>::quiet_NaN();
  // A residual that is not a number is worse than any.
  const auto judged = [](const Sides<double>& sides) {
    const double value = dense::residual(sides);
    return std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
  };
  std::vector<double> out;
  for (const auto& identity : dense::identities<double>())
    out.push_back(identity.regular_tip && t.ask.rows.size() < 6 ? missing : judged(identity.sides(t.x)));
  for (const auto& recursion : recursions<double>())
    out.push_back(recursion.square && t.swept.torque.resolved.size() == 0 ? missing
                                                                          : judged(recursion.sides(t)));
  return out;
}

RandomState random_state(const Chain<double>& chain, std::uint64_t seed) {
  Random random(seed);
  RandomState out{VectorX<double>(chain.positions()), VectorX<double>(chain.velocities())};
  Eigen::Index i = 0;
  const auto angle = [&] { out.q[i++] = random.uniform(-std::numbers::pi, std::numbers::pi); };
  const auto displacement = [&] { out.q[i++] = random.uniform(-0.5, 0.5); };
  for (const auto& link : chain.links) switch (link.type) {
      case JointType::revolute:
        angle();
        break;
      case JointType::prismatic:
        displacement();
        break;
      case JointType::cylindrical:
        angle(), displacement();
        break;
      case JointType::universal:
        angle(), angle();
        break;
      case JointType::planar:
        displacement(), displacement(), angle();
        break;
      case JointType::spherical:
      case JointType::floating:
        // Four numbers in a box are a quaternion of some length, which is then made 1.
        for (int j = 0; j < 4; ++j) out.q[i + j] = random.uniform(-1, 1);
        out.q.segment<4>(i).normalize();
        i += 4;
        if (link.type == JointType::floating) displacement(), displacement(), displacement();
        break;
    }
  for (double& rate : out.qd) rate = random.uniform(-2, 2);
  return out;
}

std::vector<Row> check(const Chain<double>& chain, int states, std::uint64_t first_seed) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < statements().size(); ++i) {
    rows.push_back({statements()[i]});
    rows[i].bound = paper_bounds[i].constant * std::numeric_limits<double>::epsilon();
  }
  for (int state = 0; state < states; ++state) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(state);
    const auto [q, qd] = random_state(chain, seed);
    const std::vector<double> now = residuals(chain, q, qd, seed);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (std::isnan(now[i])) continue;
      ++rows[i].judged;
      rows[i].worst = std::max(rows[i].worst, now[i]);
    }
  }
  return rows;
}

}  // namespace osculate::paper
