// Central differences of 8th order, with the size of their truncation error by comparison with twice the
// step.
#pragma once

#include <array>

namespace osculate::test {

template <class V>
struct Difference {
  V value;       // with step h
  V truncation;  // value with step 2h minus value with step h: about 255 times the truncation error of
                 // `value`
};

/// First derivative at t, error h^8 f^(9) / 630; f's rounding is multiplied by at most 2.1 / h.
template <class F, class T>
auto first_difference(const F& f, T t, T h) {
  using V = decltype(f(t));
  const std::array<T, 4> weight{T(4) / 5, -T(1) / 5, T(4) / 105, -T(1) / 280};
  const auto with = [&](T step) {
    V out = weight[0] / step * (f(t + step) - f(t - step));
    for (int i = 1; i < 4; ++i) out += weight[i] / step * (f(t + (i + 1) * step) - f(t - (i + 1) * step));
    return out;
  };
  const V fine = with(h), coarse = with(2 * h);
  return Difference<V>{fine, coarse - fine};
}

/// Second derivative at t, error h^8 f^(10) / 3150; f's rounding is multiplied by at most 6.6 / h^2.
template <class F, class T>
auto second_difference(const F& f, T t, T h) {
  using V = decltype(f(t));
  const std::array<T, 4> weight{T(8) / 5, -T(1) / 5, T(8) / 315, -T(1) / 560};
  const auto with = [&](T step) {
    V out = -T(205) / 72 / (step * step) * f(t);
    for (int i = 0; i < 4; ++i)
      out += weight[i] / (step * step) * (f(t + (i + 1) * step) + f(t - (i + 1) * step));
    return out;
  };
  const V fine = with(h), coarse = with(2 * h);
  return Difference<V>{fine, coarse - fine};
}

}  // namespace osculate::test
