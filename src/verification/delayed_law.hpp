// The torque of a sampled law with delay by its definition, from the dense operators: what the controller's
// sweeps are judged against.
#pragma once

#include "control/law.hpp"
#include "control/memory.hpp"
#include "reference/operators.hpp"

namespace osculate {

/// Remembers what the definition needs of earlier samples. Vectors of link k are kept in its own axes, the
/// tip force in the tip's, as the law does (sampled values move with the arm).
class DelayedLaw {
 public:
  DelayedLaw(const Chain<double>& model, const LawOptions& options) : model_(model), options_(options) {}

  /// J* F + T0 (base to tip) of the next sample. u: on the task rows. Call once for each sample, in order.
  /// tip_force: the wrench on the tip that the law knows.
  VectorX<double> torque(std::span<const double> q, const VectorX<double>& qd, const VectorX<double>& u,
                         const VectorX<double>& T0, const Vector6& tip_force);
  void remember(Memory& memory) { memory(samples_, last_, before_, last_F_, before_F_); }

 private:
  /// a(1) ... a(n), a(0), b(1) ... b(n): n + 1 accelerations and n forces, six numbers each.
  struct Biases {
    std::vector<Vector6> a, b;

    void remember(Memory& memory) { memory(a, b); }
  };

  Chain<double> model_;
  LawOptions options_;
  long samples_ = 0;
  Biases last_, before_;  // of the sample before, and of the one before that; link axes
  Vector6 last_F_ = Vector6::Zero(), before_F_ = Vector6::Zero();  // tip axes
};

}  // namespace osculate
