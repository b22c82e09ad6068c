// Many states of one arm at once, and differences of the plant around one state: the sweeps over packets.
#pragma once

#include <algorithm>
#include <stdexcept>

#include "recursion/forward_dynamics.hpp"
#include "recursion/operational_space.hpp"
#include "scalar/packet.hpp"

namespace osculate {

/// What BasicEnsemble::evaluate finds, one row for each state. Inertial frame, about the tip point.
struct EnsembleTerms {
  MatrixX<double> Omega;    // states x 21: upper triangle of Omega(0), row by row
  MatrixX<double> c, g, F;  // states x 6
  MatrixX<double> T;        // states x velocities, N m or N, base to tip
};

/// Entry of row i, column j <= 5 of Omega(0) among the 21 columns of EnsembleTerms::Omega.
constexpr int compliance_column(int i, int j) {
  return i <= j ? 6 * i - i * (i - 1) / 2 + j - i : compliance_column(j, i);
}

/// One arm on a base at rest, for H over a Packet: that many states go through the sweeps together. Joint
/// arrays have one row for each state and one column for each coordinate, base to tip; columns lie in a row
/// in memory, so that a packet is one load. Any number of states; the last packet may be part empty. No
/// allocation where the outputs have their size already. One object for each thread.
template <class H>
class BasicEnsemble {
 public:
  using S = typename H::Scalar;
  static constexpr int lanes = S::size;
  using Array = MatrixX<double>;

  /// Prepares the constants of the chain for all lanes.
  explicit BasicEnsemble(const Chain<double>& chain)
      : chain_(cast<S>(chain)),
        space_(chain_),
        plant_(chain_),
        joints_(chain.links.size()),
        q_(size(chain.positions())),
        qd_(size(chain.velocities())),
        T_(qd_),
        qdd_(qd_) {}

  /// Number of position coordinates.
  int positions() const { return static_cast<int>(q_.size()); }
  /// Number of velocity coordinates.
  int velocities() const { return static_cast<int>(qd_.size()); }

  /// Omega(0), c, g, F and T = J* F of each state, with Omega F = u + Omega (c + g): all six task rows. u:
  /// states x 6, the wanted acceleration of the tip. A singular state gives numbers that are not finite or
  /// not sensible, in its own row only. Throws std::invalid_argument for arrays of other shapes.
  void evaluate(const Array& q, const Array& qd, const Array& u, EnsembleTerms& out) {
    const Eigen::Index states = q.rows();
    check(q, states, positions());
    check(qd, states, velocities());
    check(u, states, 6);
    out.Omega.resize(states, 21);
    for (Array* terms : {&out.c, &out.g, &out.F}) terms->resize(states, 6);
    out.T.resize(states, velocities());
    for (Eigen::Index first = 0; first < states; first += lanes) {
      place(space_, q, first);
      load(qd, first, qd_);
      const Vec<Motion, S> right_of_g = space_.sweep_with_gravity(qd_);
      Vec<Force, S> F;
      inlined<S>([&] { F = task_terms(right_of_g, u, first, out); });
      space_.torques(F, T_);
      for (int i = 0; i < velocities(); ++i) put(T_[at(i)], out.T, first, i);
    }
  }

  /// Joint accelerations for joint torques T, nothing touching the tip. All arrays states x coordinates.
  void accelerations(const Array& q, const Array& qd, const Array& T, Array& qdd) {
    const Eigen::Index states = q.rows();
    check(q, states, positions());
    check(qd, states, velocities());
    check(T, states, velocities());
    qdd.resize(states, velocities());
    for (Eigen::Index first = 0; first < states; first += lanes) {
      place(plant_, q, first);
      load(qd, first, qd_);
      load(T, first, T_);
      plant_.accelerations(qd_, T_, {}, qdd_);
      for (int i = 0; i < velocities(); ++i) put(qdd_[at(i)], qdd, first, i);
    }
  }

 private:
  /// Puts Omega, c, g and F, which it returns.
  Vec<Force, S> task_terms(const Vec<Motion, S>& right_of_g, const Array& u, Eigen::Index first,
                           EnsembleTerms& out) const {
    const Compliance<S>& Omega = space_.Omega();
    const TaskFactor<S> factor(Omega, rows_);
    const Vec<Motion, S> right = space_.right_side();
    const Vec<Force, S> bias = factor.solve(right);  // c + g
    const Vec<Force, S> g = factor.solve(right_of_g);
    Vec<Motion, S> wanted;
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) set_component(wanted, i, packet(u, first, i));
    const Vec<Force, S> F = factor.solve(right + wanted);
    const Vec<Force, S> c = bias - g;
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
      put(component(g, i), out.g, first, i);
      put(component(c, i), out.c, first, i);
      put(component(F, i), out.F, first, i);
#pragma GCC unroll 6
      for (int j = i; j < 6; ++j) put(component(Omega, i, j), out.Omega, first, compliance_column(i, j));
    }
    return F;
  }

  static std::size_t size(int n) { return static_cast<std::size_t>(n); }
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  static void check(const Array& x, Eigen::Index states, int coordinates) {
    if (x.rows() != states || x.cols() != coordinates)
      throw std::invalid_argument(
          "an ensemble wants one row for each state and one column for each coordinate");
  }
  /// Lanes of the states from `first` on; those past the last repeat it.
  static S packet(const Array& x, Eigen::Index first, int column) {
    if (first + lanes <= x.rows()) return packet_at<lanes>(&x(first, column));
    S out;
    for (int i = 0; i < lanes; ++i) out.set(i, x(std::min(first + i, x.rows() - 1), column));
    return out;
  }
  static void put(const S& value, Array& x, Eigen::Index first, int column) {
    if (first + lanes <= x.rows()) return store(value, &x(first, column));
    for (int i = 0; first + i < x.rows(); ++i) x(first + i, column) = value[i];
  }
  static void load(const Array& x, Eigen::Index first, std::vector<S>& to) {
    for (int i = 0; i < static_cast<int>(to.size()); ++i) to[at(i)] = packet(x, first, i);
  }
  template <class Placed>
  void place(Placed& arm, const Array& q, Eigen::Index first) {
    load(q, first, q_);
    if constexpr (has_one_axis<H>) {
      arm.place(q_);
    } else {
      set_positions<S>(chain_, q_, joints_);
      arm.place(joints_);
    }
  }

  Chain<S> chain_;
  BasicOperationalSpace<H> space_;
  BasicForwardDynamics<H> plant_;
  TaskRows rows_ = all_rows();
  std::vector<JointPosition<S>> joints_;
  std::vector<S> q_, qd_, T_, qdd_;
};
/// For arms whose joints all have one axis. Others: BasicEnsemble<Joint<Packet<N>>>.
template <int N = native_lanes>
using Ensemble = BasicEnsemble<Hinge<Packet<N>>>;

/// d(qdd)/d(q), d(qdd)/d(qd) and d(qdd)/d(T) of the plant, n x n each: row i for the acceleration of joint i.
struct PlantSlopes {
  MatrixX<double> q, qd, T;
};

/// Central differences at one state of a chain without quaternions: 6 n states in packets. `step`: change of
/// each position, rad or m. What is left out is step^2/6 of the third derivative; rounding adds about
/// (relative rounding of qdd) |qdd| / step. Rates and torques change by 1: qdd is a quadratic in rates and
/// linear in torques, so that nothing is left out. Throws std::invalid_argument for joints with quaternions.
template <class H>
PlantSlopes plant_slopes(BasicEnsemble<H>& plant, const VectorX<double>& q, const VectorX<double>& qd,
                         const VectorX<double>& T, double step = 6e-6) {
  const Eigen::Index n = plant.velocities();
  if (plant.positions() != n)
    throw std::invalid_argument("differences are taken of joints without quaternions");
  const auto spread = [&](const VectorX<double>& x) {
    return MatrixX<double>(x.transpose().replicate(6 * n, 1));
  };
  // Rows 2 n b + i and 2 n b + n + i: argument i of block b (q, qd, T) raised and lowered.
  MatrixX<double> arguments[] = {spread(q), spread(qd), spread(T)}, qdd;
  const double steps[] = {step, 1, 1};
  for (int b = 0; b < 3; ++b)
    for (Eigen::Index i = 0; i < n; ++i) {
      arguments[b](2 * n * b + i, i) += steps[b];
      arguments[b](2 * n * b + n + i, i) -= steps[b];
    }
  plant.accelerations(arguments[0], arguments[1], arguments[2], qdd);
  PlantSlopes out;
  MatrixX<double>* slopes[] = {&out.q, &out.qd, &out.T};
  for (int b = 0; b < 3; ++b) {
    slopes[b]->resize(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      // The change that the argument really made, after its rounding.
      const double change = arguments[b](2 * n * b + i, i) - arguments[b](2 * n * b + n + i, i);
      slopes[b]->col(i) = (qdd.row(2 * n * b + i) - qdd.row(2 * n * b + n + i)).transpose() / change;
    }
  }
  return out;
}

}  // namespace osculate
