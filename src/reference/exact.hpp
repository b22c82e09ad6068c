// The dense formulation and its operators over exact fractions, compiled once, in exact.cpp.
#pragma once

#include "reference/dense.hpp"
#include "reference/operators.hpp"
#include "scalar/rational.hpp"

namespace osculate::dense {

#define OSCULATE_EXACT(how, Q)                                                                            \
  how template Ldlt<Q> factor(const MatrixX<Q>&);                                                         \
  how template void factor(const MatrixX<Q>&, Ldlt<Q>&);                                                  \
  how template void inverse(const Ldlt<Q>&, MatrixX<Q>&);                                                 \
  how template MatrixX<Q> solve(const Ldlt<Q>&, MatrixX<Q>);                                              \
  how template VectorX<Q> solve(const Ldlt<Q>&, VectorX<Q>);                                              \
  how template Places<Dual<Q>> moving_places(const Chain<Q>&, const Positions<Q>&, const VectorX<Q>&,     \
                                             const BaseMotion<Q>&);                                       \
  how template Kinematics<Q> kinematics(const Chain<Q>&, const Positions<Q>&, const VectorX<Q>&,          \
                                        const BaseMotion<Q>&);                                            \
  how template JointSpace<Q> joint_space(const Chain<Q>&, const Positions<Q>&, const VectorX<Q>&,         \
                                         const BaseMotion<Q>&);                                           \
  how template State<Q> state(const Chain<Q>&, const Positions<Q>&, const VectorX<Q>&,                    \
                              const BaseMotion<Q>&);                                                      \
  how template Mobility<Q> mobility(const Kinematics<Q>&, const JointSpace<Q>&, const std::vector<int>&); \
  how template TaskTerms<Q> task_terms(const Mobility<Q>&);                                               \
  how template TaskForce<Q> task_force(const Mobility<Q>&, const TaskTerms<Q>&, const VectorX<Q>&);       \
  how template VectorX<Q> forward_dynamics(const JointSpace<Q>&, const Jacobian<Q>&, const VectorX<Q>&,   \
                                           const Vector6<Q>&);                                            \
  how template Q kinetic_energy(const JointSpace<Q>&, const VectorX<Q>&);                                 \
  how template Q potential_energy(const Chain<Q>&, const Positions<Q>&)
OSCULATE_EXACT(extern, Rational);
OSCULATE_OPERATORS(extern, Rational);

}  // namespace osculate::dense
