// Constants of an arm that all lanes of a packet share: one double each, spread over the lanes where it
// multiplies.
#pragma once

#include <stdexcept>

#include "scalar/packet.hpp"
#include "spatial/vector3.hpp"

namespace osculate {

/// The number that stands in every lane. Throws std::invalid_argument where lanes differ: one packet is one
/// arm.
template <int N>
double shared_by_lanes(const Packet<N>& x) {
  for (int i = 1; i < N; ++i)
    if (!(x[i] == x[0])) throw std::invalid_argument("the lanes of a packet have different arms");
  return x[0];
}

template <int N>
struct Coefficients<Packet<N>> {
  double x = 0, y = 0, z = 0;
  Coefficients() = default;
  Coefficients(const Vec3<Packet<N>>& v)
      : x(shared_by_lanes(v.x)), y(shared_by_lanes(v.y)), z(shared_by_lanes(v.z)) {}
};
template <int N>
constexpr Vec3<Packet<N>> operator*(const Axes<Packet<N>>& e, const Coefficients<Packet<N>>& v) {
  return e.x * Packet<N>(v.x) + e.y * Packet<N>(v.y) + e.z * Packet<N>(v.z);
}

template <int N>
struct SymmetricCoefficients<Packet<N>> {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  SymmetricCoefficients() = default;
  SymmetricCoefficients(const Sym3<Packet<N>>& a)
      : xx(shared_by_lanes(a.xx)),
        xy(shared_by_lanes(a.xy)),
        xz(shared_by_lanes(a.xz)),
        yy(shared_by_lanes(a.yy)),
        yz(shared_by_lanes(a.yz)),
        zz(shared_by_lanes(a.zz)) {}
};
template <int N>
constexpr Sym3<Packet<N>> turned(const Axes<Packet<N>>& e, const SymmetricCoefficients<Packet<N>>& a) {
  return turned(e, Sym3<Packet<N>>{a.xx, a.xy, a.xz, a.yy, a.yz, a.zz});
}

}  // namespace osculate
