// Many states of one arm, one after the other: what the Python module evaluates. Joints base to tip; base
// frame, about the tip point; six-vectors angular part first; SI units and radians.
#pragma once

#include <cstddef>
#include <span>

#include "model/urdf.hpp"
#include "recursion/task.hpp"

namespace osculate {

/// One row of numbers for each state, or one row that stands for all of them.
struct StateRows {
  const double* first = nullptr;  // rows lie one behind the other
  std::size_t columns = 0;
  bool one_for_all = true;

  std::span<const double> operator[](std::size_t state) const {
    return {first + (one_for_all ? 0 : state * columns), columns};
  }
};

/// Torques T = J* F + T0 (N m or N) that give the tip the acceleration u on the task rows, by four sweeps for
/// each state. q: chain.positions() columns; qd, T0: chain.velocities(); u: rows.size(). T: one row for each
/// state. Throws SingularArm, with the number of the state, where the rows cannot be moved independently.
void operational_space_torques(const Chain<double>& chain, std::size_t states, const StateRows& q,
                               const StateRows& qd, const StateRows& u, const TaskRows& rows,
                               const StateRows& T0, double* T);

/// Joint accelerations (51) under the joint torques T and the wrench F_ext on the tip (6 columns: N m, N).
void forward_dynamics(const Chain<double>& chain, std::size_t states, const StateRows& q, const StateRows& qd,
                      const StateRows& T, const StateRows& F_ext, double* qdd);

}  // namespace osculate
