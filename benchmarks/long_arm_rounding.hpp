// How far rounding takes the terms of long arms in double from the same recursions with 113 bits, and how
// far an error of eps in the arm's own numbers would take them.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <vector>

#include "benchmarks/long_arm.hpp"
#include "reference/conditioning.hpp"
#include "scalar/quad.hpp"

namespace osculate::long_arms {

/// Error of one term in eps of its size, and its condition. The size is the largest number of the same kind:
/// of the angular or the linear rows (Omega: of its angular block or the rest), of the turning or the sliding
/// joints.
struct Rounding {
  const char* name;
  double error = 0;      // eps
  double condition = 1;  // change in eps of the size, at least 1, when every number of the arm changes by
                         // eps; of F and T at least the condition of Omega, rows scaled to unit diagonal
};

/// The same state with every number of it up or down by eps relative to itself.
inline State<Quad> perturbed(State<Quad> at, std::uint64_t seed) {
  Random random(seed);
  const auto shake = [&random](Quad& x) { x *= Quad(1) + Quad(random.sign() * 0x1p-52); };
  for (Link<Quad>& link : at.chain.links) {
    for (Vector3<Quad>* v : {&link.p_origin, &link.com, &link.axis})
      for (Quad& x : *v) shake(x);
    for (int i = 0; i < 3; ++i) shake(link.inertia(i, i));
    shake(link.mass);
    shake(link.armature);
  }
  for (VectorX<Quad>* list : {&at.q, &at.qd, &at.T0, &at.u})
    for (Quad& x : *list) shake(x);
  return at;
}

/// Largest |a - b| over its size, in eps. kind(i): 0 or 1, which entries share a size.
inline double difference(std::span<const Quad> a, std::span<const Quad> b,
                         const std::function<int(std::size_t)>& kind) {
  double size[2] = {0, 0}, off[2] = {0, 0}, worst = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const int k = kind(i);
    const double error = std::abs(double(a[i] - b[i]));
    size[k] = std::max(size[k], std::abs(double(b[i])));
    if (!(error <= off[k])) off[k] = error;  // a NaN stays
  }
  for (const int k : {0, 1})
    if (off[k] != 0 && !(off[k] / size[k] <= worst)) worst = off[k] / size[k];
  return worst / std::numeric_limits<double>::epsilon();
}

/// The terms in one order.
using Parts = std::array<std::vector<Quad>, 7>;
template <Field S>
Parts parts_of(const Terms<S>& x) {
  Parts out;
  const auto take = [](const auto& list, std::vector<Quad>& to) {
    for (Eigen::Index i = 0; i < list.size(); ++i) to.push_back(Quad(list(i)));
  };
  take(x.Omega, out[0]);
  const VectorX<S>* lists[] = {&x.c, &x.g, &x.c_plus_g, &x.F, &x.T, &x.qdd};
  for (std::size_t i = 0; i < 6; ++i) take(*lists[i], out[i + 1]);
  return out;
}

/// All seven terms at one state. Costs three evaluations in 113 bits.
inline std::array<Rounding, 7> rounding_of(const State<double>& at, std::uint64_t seed) {
  const Terms<double> in_double = terms_of(at);
  const State<Quad> wide = cast_state<Quad>(at);
  const Parts here = parts_of(in_double), exact = parts_of(terms_of(wide));
  const Parts shaken[] = {parts_of(terms_of(perturbed(wide, seed))),
                          parts_of(terms_of(perturbed(wide, seed + 1)))};
  const auto entry = [](std::size_t i) { return i % 6 < 3 && i < 18 ? 0 : 1; };
  const auto row = [](std::size_t i) { return i < 3 ? 0 : 1; };
  const auto joint = [&at](std::size_t i) { return at.chain.links[i].type == JointType::prismatic ? 1 : 0; };
  const std::function<int(std::size_t)> kinds[] = {entry, row, row, row, row, joint, joint};
  const char* const names[] = {"Omega", "Omega c", "Omega g", "Omega (c + g)", "F", "T", "qdd"};
  const double spread = scaled_condition(in_double.Omega);
  std::array<Rounding, 7> out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const bool solved = i == 4 || i == 5;
    out[i] = {names[i], difference(here[i], exact[i], kinds[i]), solved ? spread : 1};
    for (const Parts& other : shaken)
      out[i].condition = std::max(out[i].condition, difference(other[i], exact[i], kinds[i]));
  }
  return out;
}

}  // namespace osculate::long_arms
