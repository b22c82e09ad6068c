#include "python/states.hpp"

#include <string>
#include <vector>

#include "control/law.hpp"
#include "control/task_inverse.hpp"
#include "recursion/forward_dynamics.hpp"

namespace osculate {

namespace {

constexpr double pivot_floor = 1e-13;  // as in control/law.cpp

/// work(H) for the joint type that the chain needs: Hinge<double>, or Joint<double> with several axes.
template <class Work>
void for_joints(const Chain<double>& chain, const Work& work) {
  if (chain.one_axis_joints())
    work(std::type_identity<Hinge<double>>());
  else
    work(std::type_identity<Joint<double>>());
}

std::span<double> row(double* first, std::size_t state, std::size_t columns) {
  return {first + state * columns, columns};
}

template <class H>
void torques(const Chain<double>& chain, std::size_t states, const StateRows& q, const StateRows& qd,
             const StateRows& u, const TaskRows& rows, const StateRows& T0, double* T) {
  BasicOperationalSpace<H> space(chain);
  std::vector<JointPosition<double>> joints;
  for (std::size_t i = 0; i < states; ++i) {
    set_positions(chain, q[i], joints);
    space.place(joints);
    space.sweep(qd[i], T0[i]);
    const TaskInverse Omega(space.Omega(), rows);
    if (const int lost = Omega.lost(pivot_floor); lost >= 0)
      throw SingularArm("state " + std::to_string(i) + ": the arm is singular: task row " +
                        std::to_string(lost) + " of " + std::to_string(rows.size()) +
                        " depends on those before it. Choose fewer rows, or another state.");
    TaskVector<double> right = restricted(space.right_side(), rows);
    for (std::size_t k = 0; k < rows.size(); ++k) right[k] += u[i][k];
    space.torques(wrench(Omega.solve(right), rows), row(T, i, qd.columns));
  }
}

template <class H>
void accelerations(const Chain<double>& chain, std::size_t states, const StateRows& q, const StateRows& qd,
                   const StateRows& T, const StateRows& F_ext, double* qdd) {
  BasicForwardDynamics<H> plant(chain);
  std::vector<JointPosition<double>> joints;
  for (std::size_t i = 0; i < states; ++i) {
    set_positions(chain, q[i], joints);
    plant.place(joints);
    const std::span<const double> F = F_ext[i];
    plant.accelerations(qd[i], T[i], {{F[0], F[1], F[2]}, {F[3], F[4], F[5]}}, row(qdd, i, qd.columns));
  }
}

}  // namespace

void operational_space_torques(const Chain<double>& chain, std::size_t states, const StateRows& q,
                               const StateRows& qd, const StateRows& u, const TaskRows& rows,
                               const StateRows& T0, double* T) {
  for_joints(chain,
             [&]<class H>(std::type_identity<H>) { torques<H>(chain, states, q, qd, u, rows, T0, T); });
}

void forward_dynamics(const Chain<double>& chain, std::size_t states, const StateRows& q, const StateRows& qd,
                      const StateRows& T, const StateRows& F_ext, double* qdd) {
  for_joints(chain,
             [&]<class H>(std::type_identity<H>) { accelerations<H>(chain, states, q, qd, T, F_ext, qdd); });
}

}  // namespace osculate
