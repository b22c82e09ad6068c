#include "benchmarks/agreement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace osculate::bench {

namespace {

template <class List>
double difference(const List& a, const List& b) {
  double worst = 0, scale = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i])) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, std::abs(a[i] - b[i]));
    scale = std::max(scale, std::abs(b[i]));
  }
  return worst / scale;
}

}  // namespace

Agreement compare(const Route& route, const Route& reference, const std::vector<State>& states) {
  const std::size_t n = states.front().q.size();
  Answer a{std::vector<double>(n), {}, std::vector<double>(n)}, b = a;
  Agreement out;
  const auto keep = [](double& worst, double now) { worst = std::max(worst, now); };
  for (State state : states) {
    route.run(state, a);
    reference.run(state, b);
    if (route.call == Call::forward_dynamics) {
      keep(out.qdd, difference(a.qdd, b.qdd));
      continue;
    }
    std::array<double, 36> Omega_a, Omega_b;
    route.read_Omega(Omega_a.data());
    reference.read_Omega(Omega_b.data());
    keep(out.Omega, difference(Omega_a, Omega_b));
    keep(out.F, difference(a.F, b.F));
    keep(out.T, difference(a.T, b.T));
    state.u = {};
    route.run(state, a);
    reference.run(state, b);
    keep(out.F, difference(a.F, b.F));
  }
  return out;
}

}  // namespace osculate::bench
