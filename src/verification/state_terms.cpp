#include "verification/state_terms.hpp"

#include "simulation/integrator.hpp"
#include "verification/step_check.hpp"

namespace osculate {

StateTerms terms_at(const Chain<double>& chain, std::span<const double> q, std::span<const double> qd,
                    const Vector6& u, const TaskRows& rows) {
  std::vector<double> y(q.begin(), q.end());
  y.insert(y.end(), qd.begin(), qd.end());
  y.insert(y.end(), 3, 0.0);
  const auto judge = [&](Law law) {
    LawOptions options;
    options.law = law;
    options.rows = rows;
    options.constant_command = u;
    Controller controller(chain, {}, options, make_path(HoldOptions{}), tip_pose(chain, q));
    Plant plant;
    plant.chain = chain;
    ClosedLoop loop(std::move(controller), std::move(plant));
    return gather(loop, 0, y);
  };
  StateTerms out;
  out.evidence = judge(Law::free);
  out.rank = scaled_rank(out.evidence.task.Omega);
  if (out.rank == static_cast<int>(rows.size())) {
    try {
      out.evidence = judge(Law::operational_space);
    } catch (const IntegrationStopped&) { out.evidence.terms = {}; }
  } else {
    out.evidence.terms = {};
  }
  out.residuals = assess(out.evidence);
  out.condition = scaled_condition(out.evidence.task.Omega);
  if (!out.regular())
    out.warnings.push_back(
        "Omega has rank " + std::to_string(out.rank) + " of " + std::to_string(rows.size()) +
        ": Lambda, c, g, F, T and qdd do not exist" +
        (chain.velocities() < static_cast<int>(rows.size())
             ? "; with " + std::to_string(chain.velocities()) + " joints choose fewer rows with --rows"
             : "; the arm is singular here"));
  return out;
}

bool fails(const StateTerms& terms) {
  for (const auto& [key, claim] : judged_terms) {
    const Residual& r = terms.residual(claim);
    if (r.applies && r.bound <= undecided_bound && !(r.value <= r.bound)) return true;
  }
  return false;
}

DenseForce dense_force(const StateTerms& terms) {
  const Evidence& e = terms.evidence;
  const auto [F, T] = dense::task_force(e.task, e.terms, e.u);
  return {F, T, dense::forward_dynamics(e.plant.joint, e.plant.tip.J, T)};
}

}  // namespace osculate
