// N doubles that go through the sweeps together: N states of one arm for little more than the time of one.
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <ostream>

#include "scalar/field.hpp"
#include "scalar/inlined.hpp"
#include "scalar/lanes.hpp"
#include "scalar/sine_cosine.hpp"

namespace osculate {

/// N numbers, one for each lane; every operation is done lane by lane. N = 2, 4 or 8: native_lanes is what
/// one register holds, more lanes are several registers. No comparisons: lanes have no common truth value.
/// Lanes do not mix: each gives what it would give alone.
template <int N>
struct Packet {
  static_assert(N == 2 || N == 4 || N == 8);
  using Numbers = typename LanesOf<N>::Numbers;
  static constexpr int size = N;

  Numbers lanes;  // not set by default, as a double is not

  Packet() = default;
  // Written out: GCC copies the struct in halves where it writes the copy itself, and reading it back whole
  // then waits for both.
  OSCULATE_INLINE constexpr Packet(const Packet& x) : lanes(x.lanes) {}
  OSCULATE_INLINE constexpr Packet& operator=(const Packet& x) { return lanes = x.lanes, *this; }
  /// The same number in every lane.
  OSCULATE_INLINE constexpr Packet(double x) : lanes(Numbers{} + x) {}
  template <std::integral I>
  OSCULATE_INLINE constexpr Packet(I n) : Packet(static_cast<double>(n)) {}

  /// Lane i, 0 <= i < N.
  double operator[](int i) const { return lanes[i]; }
  void set(int i, double x) { lanes[i] = x; }
  /// For choices that every lane must make alike.
  friend double first_lane(const Packet& x) { return x.lanes[0]; }

  OSCULATE_INLINE constexpr Packet& operator+=(const Packet& y) { return lanes += y.lanes, *this; }
  OSCULATE_INLINE constexpr Packet& operator-=(const Packet& y) { return lanes -= y.lanes, *this; }
  OSCULATE_INLINE constexpr Packet& operator*=(const Packet& y) { return lanes *= y.lanes, *this; }
  OSCULATE_INLINE constexpr Packet& operator/=(const Packet& y) { return lanes /= y.lanes, *this; }

  OSCULATE_INLINE friend constexpr Packet operator-(const Packet& x) {
    Packet out;
    out.lanes = -x.lanes;
    return out;
  }
  OSCULATE_INLINE friend constexpr Packet operator+(const Packet& x, const Packet& y) {
    Packet out;
    out.lanes = x.lanes + y.lanes;
    return out;
  }
  OSCULATE_INLINE friend constexpr Packet operator-(const Packet& x, const Packet& y) {
    Packet out;
    out.lanes = x.lanes - y.lanes;
    return out;
  }
  OSCULATE_INLINE friend constexpr Packet operator*(const Packet& x, const Packet& y) {
    Packet out;
    out.lanes = x.lanes * y.lanes;
    return out;
  }
  OSCULATE_INLINE friend constexpr Packet operator/(const Packet& x, const Packet& y) {
    Packet out;
    out.lanes = x.lanes / y.lanes;
    return out;
  }

  friend std::ostream& operator<<(std::ostream& out, const Packet& x) {
    for (int i = 0; i < N; ++i) out << (i == 0 ? "[" : " ") << x[i];
    return out << "]";
  }
};

template <int N>
inline constexpr bool in_register<Packet<N>> = true;

/// N numbers in a row in memory, and back.
template <int N>
OSCULATE_INLINE Packet<N> packet_at(const double* from) {
  Packet<N> out;
  std::memcpy(&out.lanes, from, sizeof out.lanes);
  return out;
}
template <int N>
OSCULATE_INLINE void store(const Packet<N>& x, double* to) {
  std::memcpy(to, &x.lanes, sizeof x.lanes);
}

/// Sines and cosines of `count` packets of angles, rad: in each lane the bits that the scalar sine_cosine
/// gives. The arrays must not overlap.
template <int N>
void sine_cosine(const Packet<N>* angle, Packet<N>* sine, Packet<N>* cosine, std::size_t count) {
  static_assert(sizeof(Packet<N>) == N * sizeof(double));
  sine_cosine_detail::of_array<(N < native_lanes ? N : native_lanes)>(
      reinterpret_cast<const double*>(angle), reinterpret_cast<double*>(sine),
      reinterpret_cast<double*>(cosine), count * N);
}
/// One at a time, for joints with a rotation that is no plain turn.
template <int N>
Packet<N> sin(const Packet<N>& angle) {
  Packet<N> sine, cosine;
  return sine_cosine(&angle, &sine, &cosine, 1), sine;
}
template <int N>
Packet<N> cos(const Packet<N>& angle) {
  Packet<N> sine, cosine;
  return sine_cosine(&angle, &sine, &cosine, 1), cosine;
}

}  // namespace osculate

namespace Eigen {
template <int N>
struct NumTraits<osculate::Packet<N>> : GenericNumTraits<osculate::Packet<N>> {
  using Real = osculate::Packet<N>;
  using NonInteger = osculate::Packet<N>;
  using Nested = osculate::Packet<N>;
  using Literal = osculate::Packet<N>;
  enum {
    IsInteger = 0,
    IsSigned = 1,
    IsComplex = 0,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 4,
    MulCost = 4
  };
};
}  // namespace Eigen
