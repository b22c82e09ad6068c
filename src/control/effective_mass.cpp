#include "control/effective_mass.hpp"

#include <limits>

#include "control/spectrum.hpp"

namespace osculate {

namespace {

/// Eigenvalues and axes of A^-1.
Ellipsoid inverse(const Sym3<double>& A) {
  const Spectrum s = spectrum({{{entry(A, 0, 0), entry(A, 0, 1), entry(A, 0, 2)},
                                {entry(A, 1, 0), entry(A, 1, 1), entry(A, 1, 2)},
                                {entry(A, 2, 0), entry(A, 2, 1), entry(A, 2, 2)}}},
                              3);
  const double floor = immobile * (entry(A, 0, 0) + entry(A, 1, 1) + entry(A, 2, 2));
  Ellipsoid out;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(2 - i);  // the most mobile axis has the least mass
    out.principal[i] = s.values[k] > floor ? 1 / s.values[k] : std::numeric_limits<double>::infinity();
    out.axes.col(i) = Vector3<double>(s.vectors[k][0], s.vectors[k][1], s.vectors[k][2]);
  }
  return out;
}

}  // namespace

Ellipsoid effective_mass(const Compliance<double>& Omega) { return inverse(Omega.A); }
Ellipsoid effective_inertia(const Compliance<double>& Omega) { return inverse(Omega.J); }

}  // namespace osculate
