// The sweeps run over other joint types than Hinge: here a cylindrical joint, which turns and slides about
// one axis. The same motion is that of a revolute and a prismatic joint on that axis with a massless link
// between them, so over exact fractions both arms must say the same.
#include <vector>

#include "recursion/operational_space.hpp"
#include "spatial/plain.hpp"
#include "support/catch.hpp"
#include "support/random_arm.hpp"

using namespace osculate;
using osculate::testing::exact_arm;
using osculate::testing::ExactArm;
using osculate::testing::plain;
using osculate::testing::Random;
using osculate::testing::Vector6;
using Q = Rational;

// A joint with two axes: what the sweeps ask of a joint type, and no more.
namespace cylindrical {

struct Pair {  // angle first, then displacement; or torque, then force
  Q turn, slide;
  friend Pair operator+(const Pair& a, const Pair& b) { return {a.turn + b.turn, a.slide + b.slide}; }
  friend Pair operator-(const Pair& a, const Pair& b) { return {a.turn - b.turn, a.slide - b.slide}; }
  friend bool operator==(const Pair&, const Pair&) = default;
};

struct Block {  // D, J or an inverse: [tt ts; ts ss]
  Q tt, ts, ss;
  friend Block operator+(const Block& a, const Block& b) { return {a.tt + b.tt, a.ts + b.ts, a.ss + b.ss}; }
  friend Pair operator*(const Block& D, const Pair& t) {
    return {D.tt * t.turn + D.ts * t.slide, D.ts * t.turn + D.ss * t.slide};
  }
  friend Block inverse(const Block& D) {
    const Q det = D.tt * D.ss - D.ts * D.ts;
    return {D.ss / det, -D.ts / det, D.tt / det};
  }
};

template <class Space>
struct Columns {  // 6 x 2
  Vec<Space, Q> turn, slide;
  friend Vec<Space, Q> operator*(const Columns& A, const Pair& t) {
    return A.turn * t.turn + A.slide * t.slide;
  }
  friend Columns operator*(const Columns& A, const Block& D) {
    return {A * Pair{D.tt, D.ts}, A * Pair{D.ts, D.ss}};
  }
  Pair transposed_times(const Vec<typename Space::Dual, Q>& v) const { return {dot(turn, v), dot(slide, v)}; }
};
/// A B^T + B A^T and A D A^T
template <class Space>
Symmetric<Space, Q> twice_outer(const Columns<Space>& A, const Columns<Space>& B) {
  return twice_outer(A.turn, B.turn) + twice_outer(A.slide, B.slide);
}
template <class Space>
Symmetric<Space, Q> weighted_square(const Columns<Space>& A, const Block& D) {
  return scaled_square(A.turn, D.tt) + scaled_square(A.slide, D.ss) + twice_outer(A.turn, A.slide * D.ts);
}

struct Gain {
  Columns<Force> c;
  Star<Gain> T() const { return {*this}; }
};
struct Psi;
struct Joint {
  using Scalar = Q;
  using Coordinate = Pair;
  using JointInertia = Block;
  using Gain = cylindrical::Gain;
  using Psi = cylindrical::Psi;
  Columns<Motion> axes;  // H*
  Star<Joint> T() const { return {*this}; }
};
struct Psi {
  Shift<Q> phi;
  Gain G;
  Joint H;
  Star<Psi> T() const { return {*this}; }
};

Vec<Motion, Q> operator*(const Star<Joint>& H, const Pair& rate) { return H.map.axes * rate; }
Pair operator*(const Joint& H, const Vec<Force, Q>& f) { return H.axes.transposed_times(f); }

struct InertiaTimesJoint {  // P H*
  Columns<Force> c;
};
InertiaTimesJoint operator*(const Inertia<Q>& P, const Star<Joint>& H) {
  return {{P * H.map.axes.turn, P * H.map.axes.slide}};
}
struct JointTimesInertia {  // H P
  Columns<Force> c;
};
JointTimesInertia operator*(const Joint& H, const Inertia<Q>& P) { return {(P * H.T()).c}; }
Block operator*(const JointTimesInertia& HP, const Star<Joint>& H) {
  const auto& [turn, slide] = H.map.axes;
  return {dot(HP.c.turn, turn), dot(HP.c.turn, slide), dot(HP.c.slide, slide)};
}

Gain operator*(const InertiaTimesJoint& PH, const Block& Dinv) { return {PH.c * Dinv}; }
Gain operator*(const Shift<Q>& phi, const Gain& G) { return {{phi * G.c.turn, phi * G.c.slide}}; }
Vec<Force, Q> operator*(const Gain& G, const Pair& torque) { return G.c * torque; }
Pair operator*(const Star<Gain>& G, const Vec<Motion, Q>& V) { return G.map.c.transposed_times(V); }
struct GainTimesInertia {
  Gain K;
  Block J;
};
GainTimesInertia operator*(const Gain& K, const Block& J) { return {K, J}; }
Inertia<Q> operator*(const GainTimesInertia& KJ, const Star<Gain>& K) {
  return weighted_square(K.map.c, KJ.J);
}

struct JointCompliance {  // H* D^-1
  Joint H;
  Block Dinv;
};
JointCompliance operator*(const Star<Joint>& H, const Block& Dinv) { return {H.map, Dinv}; }
Vec<Motion, Q> operator*(const JointCompliance& HD, const Pair& t) { return HD.H.axes * (HD.Dinv * t); }
Compliance<Q> operator*(const JointCompliance& HD, const Joint& H) {
  return weighted_square(H.axes, HD.Dinv);
}

struct Strip {  // G H, then 1 - G H
  Gain G;
  Joint H;
};
Strip operator*(const Gain& G, const Joint& H) { return {G, H}; }
Strip operator-(One, const Strip& GH) { return GH; }
Psi operator*(const Shift<Q>& phi, const Strip& strip) { return {phi, strip.G, strip.H}; }
Vec<Force, Q> operator*(const Psi& psi, const Vec<Force, Q>& f) {
  return psi.phi * (f - psi.G * (psi.H * f));
}
Vec<Motion, Q> operator*(const Star<Psi>& psi, const Vec<Motion, Q>& V) {
  const auto& [phi, G, H] = psi.map;
  const Vec<Motion, Q> moved = phi.T() * V;
  return moved - H.T() * (G.T() * moved);
}
struct PsiInertia {
  Psi psi;
  Inertia<Q> P;
};
PsiInertia operator*(const Psi& psi, const Inertia<Q>& P) { return {psi, P}; }
Inertia<Q> operator*(const PsiInertia& left, const Star<Psi>& right) {
  const auto& [phi, G, H] = right.map;
  return carried(phi,
                 left.P - twice_outer(G.c, (left.P * H.T()).c) + weighted_square(G.c, H * left.P * H.T()));
}
struct PsiCompliance {
  Psi psi;
  Compliance<Q> Omega;
};
PsiCompliance operator*(const Star<Psi>& psi, const Compliance<Q>& Omega) { return {psi.map, Omega}; }
Compliance<Q> operator*(const PsiCompliance& left, const Psi& right) {
  const auto& [phi, G, H] = right;
  const Compliance<Q> X = carried(phi.T(), left.Omega);
  const Columns<Motion> y{X * G.c.turn, X * G.c.slide};
  const Block GXG{dot(y.turn, G.c.turn), dot(y.turn, G.c.slide), dot(y.slide, G.c.slide)};
  return X - twice_outer(H.axes, y) + weighted_square(H.axes, GXG);
}

}  // namespace cylindrical

namespace {

using cylindrical::Pair;

/// An arm of cylindrical joints over `of`, which has a revolute and a prismatic joint for each (R inboard).
BasicArm<cylindrical::Joint> joined(const Arm<Q>& of) {
  BasicArm<cylindrical::Joint> arm;
  arm.link.resize(static_cast<std::size_t>(of.n() / 2 + 1));
  arm[0].phi = of[0].phi;
  for (int k = 1; k <= of.n() / 2; ++k) {
    const auto &slide = of[2 * k - 1], &turn = of[2 * k];
    arm[k].phi.l = turn.phi.l + slide.phi.l;
    arm[k].hinge.axes = {turn.hinge.T() * Q(1), slide.hinge.T() * Q(1)};
    arm[k].M = slide.M;
    arm[k].J = {turn.J.d, Q(0), slide.J.d};
  }
  return arm;
}

/// Base to tip: R and P numbers in turn, as pairs.
std::vector<Pair> pairs(const std::vector<Q>& v) {
  std::vector<Pair> out;
  for (std::size_t i = 0; i < v.size(); i += 2) out.push_back({v[i], v[i + 1]});
  return out;
}

/// exact_arm with 2 n joints, changed so that each P joint sits on the axis and point of the R joint before
/// it.
ExactArm pairwise_arm(unsigned seed, int joints) {
  ExactArm arm = exact_arm(seed, 2 * joints);
  Random random(seed);
  for (std::size_t i = 0; i < arm.chain.links.size(); i += 2) {
    Link<Q>&turn = arm.chain.links[i], &slide = arm.chain.links[i + 1];
    turn.type = JointType::revolute;
    turn.mass = Q(0);
    turn.com.setZero();
    turn.inertia.setZero();
    slide.type = JointType::prismatic;
    slide.axis = turn.axis;
    slide.R_origin = Matrix3<Q>::Identity();
    slide.p_origin.setZero();
    arm.positions[i] = {Q(5, 13), Q(12, 13), Q(0)};
    arm.positions[i + 1] = {Q(1), Q(0), random.fraction(3, 4)};
  }
  return arm;
}

}  // namespace

TEST_CASE("cylindrical joints through the same sweeps equal revolute and prismatic joints on one axis") {
  for (int joints = 1; joints <= 4; ++joints)
    for (unsigned seed = 1; seed <= 5; ++seed) {
      INFO("pairwise_arm(" << seed << ", " << joints << ")");
      const int n = 2 * joints;
      const ExactArm arm = pairwise_arm(seed, joints);
      const ArmBuilder<Q> builder(arm.chain);
      const Vec<Motion, Q> a_g = builder.a_g();
      Arm<Q> hinges;
      builder.place(arm.positions, hinges);
      const BasicArm<cylindrical::Joint> cylinders = joined(hinges);
      Passes<Hinge<Q>> x(n);
      Passes<cylindrical::Joint> y(joints);

      Random random(seed);
      std::vector<Q> T0(static_cast<std::size_t>(n));
      for (Q& t : T0) t = random.fraction(9, 2);
      const std::vector<Q> qd(arm.qd.data(), arm.qd.data() + n);
      const auto T0_pairs = pairs(T0), qd_pairs = pairs(qd);
      for (int k = 1; k <= n; ++k) x[k].T0 = T0[static_cast<std::size_t>(n - k)];
      for (int k = 1; k <= joints; ++k) y[k].T0 = T0_pairs[static_cast<std::size_t>(joints - k)];
      const Vec<Force, Q> F_ext{{Q(1), Q(-2), Q(3)}, {Q(5), Q(1, 2), Q(-4)}};

      sweep_velocities(hinges, TipFirst<Q>{qd.data(), n}, a_g, x);
      sweep_articulated(hinges, F_ext, x);
      sweep_compliance(hinges, a_g, x);
      sweep_gravity(hinges, a_g, x);
      sweep_torques(hinges, F_ext, x);
      sweep_accelerations(hinges, a_g, x);

      sweep_velocities(cylinders, TipFirst<Pair>{qd_pairs.data(), joints}, a_g, y);
      sweep_articulated(cylinders, F_ext, y);
      sweep_compliance(cylinders, a_g, y);
      sweep_gravity(cylinders, a_g, y);
      sweep_torques(cylinders, F_ext, y);
      sweep_accelerations(cylinders, a_g, y);

      CHECK(plain(y[0].V) == plain(x[0].V));
      CHECK(plain(y[0].a) == plain(x[0].a));
      CHECK(plain(y[0].Omega) == plain(x[0].Omega));  // (60)
      CHECK(plain(y[0].eta) == plain(x[0].eta));      // (68): right side of c + g, with T0 and F_ext
      CHECK(plain(y[0].eta_g) == plain(x[0].eta_g));  // (74)
      CHECK(plain(y[0].alpha) == plain(x[0].alpha));  // (8)
      for (int k = 1; k <= joints; ++k) {
        INFO("joint k = " << k);
        const auto &turn = x[2 * k], &slide = x[2 * k - 1];
        CHECK(plain(y[k].P) == plain(slide.P));           // (37)
        CHECK(y[k].T == Pair{turn.T, slide.T});           // (39)
        CHECK(y[k].thdd == Pair{turn.thdd, slide.thdd});  // (51)
      }
      if (joints >= 3) {
        // The whole controller, on six independent rows.
        const TaskFactor<Q> left(x[0].Omega, all_rows()), right(y[0].Omega, all_rows());
        const auto F = left.solve(restricted(x[0].eta, all_rows()));
        CHECK(right.solve(restricted(y[0].eta, all_rows())) == F);
        sweep_torques(hinges, wrench(F, all_rows()), x);
        sweep_torques(cylinders, wrench(F, all_rows()), y);
        for (int k = 1; k <= joints; ++k) CHECK(y[k].T == Pair{x[2 * k].T, x[2 * k - 1].T});
      }
    }
}
