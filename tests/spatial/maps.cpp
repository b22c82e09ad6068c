// Every structured map against the 6 x 6 matrix it stands for: exactly over fractions, to rounding over doubles.
#include <limits>

#include "recursion/arm.hpp"
#include "spatial/plain.hpp"
#include "support/catch.hpp"
#include "support/random_arm.hpp"

using namespace osculate;
using osculate::testing::as;
using osculate::testing::Matrix6;
using osculate::testing::plain;
using osculate::testing::Random;
using osculate::testing::skew;
using osculate::testing::Vector6;
using Q = Rational;

namespace {

// The stars of the paper are types: a forgotten or a superfluous one does not compile.
template <class A, class B>
concept Multipliable = requires(A a, B b) { a* b; };
using D = double;
static_assert(Multipliable<Shift<D>, Vec<Force, D>> && !Multipliable<Shift<D>, Vec<Motion, D>>);
static_assert(Multipliable<Star<Shift<D>>, Vec<Motion, D>> && !Multipliable<Star<Shift<D>>, Vec<Force, D>>);
static_assert(Multipliable<Hinge<D>, Vec<Force, D>> && !Multipliable<Hinge<D>, Vec<Motion, D>>);
static_assert(Multipliable<Psi<D>, Vec<Force, D>> && !Multipliable<Psi<D>, Vec<Motion, D>>);
static_assert(Multipliable<Star<Psi<D>>, Vec<Motion, D>> && !Multipliable<Star<Psi<D>>, Vec<Force, D>>);
static_assert(Multipliable<Inertia<D>, Vec<Motion, D>> && !Multipliable<Inertia<D>, Vec<Force, D>>);
static_assert(Multipliable<Compliance<D>, Vec<Force, D>> && !Multipliable<Compliance<D>, Vec<Motion, D>>);

template <Field S>
S number(Random& random) {
  if constexpr (std::is_same_v<S, double>)
    return random.uniform(-1, 1);
  else
    return random.fraction(9, 4);
}
template <Field S, int rows, int columns>
Eigen::Matrix<S, rows, columns> numbers(Random& random) {
  Eigen::Matrix<S, rows, columns> out;
  for (int j = 0; j < columns; ++j)
    for (int i = 0; i < rows; ++i) out(i, j) = number<S>(random);
  return out;
}
template <Field S>
Vec3<S> vec3(Random& random) {
  return {number<S>(random), number<S>(random), number<S>(random)};
}
template <Field S>
Mat3<S> mat3(Random& random) {
  return {vec3<S>(random), vec3<S>(random), vec3<S>(random)};
}
template <Field S>
Sym3<S> sym3(Random& random) {
  return upper(mat3<S>(random));
}
template <class Space, Field S>
Vec<Space, S> vec(Random& random) {
  return {vec3<S>(random), vec3<S>(random)};
}
template <class To, Field S>
Symmetric<To, S> symmetric(Random& random) {
  return {sym3<S>(random), mat3<S>(random), sym3<S>(random)};
}

/// A A^T + 1 as a structured map: positive definite, so that D = H P H* is safely positive.
template <class To, Field S>
Symmetric<To, S> definite(Random& random) {
  const Matrix6<S> A = numbers<S, 6, 6>(random);
  const Matrix6<S> P = A * A.transpose() + Matrix6<S>::Identity();
  const auto block = [&P](int r, int c) {
    return Mat3<S>{{P(r, c), P(r, c + 1), P(r, c + 2)},
                   {P(r + 1, c), P(r + 1, c + 1), P(r + 1, c + 2)},
                   {P(r + 2, c), P(r + 2, c + 1), P(r + 2, c + 2)}};
  };
  return {upper(block(0, 0)), block(0, 3), upper(block(3, 3))};
}

/// [1 l~; 0 1]
template <Field S>
Matrix6<S> plain_shift(const Vec3<S>& l) {
  Matrix6<S> out = Matrix6<S>::Identity();
  out.template topRightCorner<3, 3>() = skew(plain(l));
  return out;
}
/// [I m p~; -m p~ m 1]
template <Field S>
Matrix6<S> plain_body(const RigidInertia<S>& M) {
  Matrix6<S> out;
  out << plain(M.I), skew(plain(M.mp)), -skew(plain(M.mp)), M.m * Matrix3<S>::Identity();
  return out;
}

/// The joint of a one-link arm with a random axis, and H* as six numbers.
template <Field S>
struct Joint {
  Hinge<S> H;
  Vector6<S> column;

  Joint(Random& random, JointType type) {
    Chain<S> chain;
    Link<S> link;
    link.type = type;
    if constexpr (std::is_same_v<S, double>)
      link.axis = random.direction();
    else
      link.axis = random.exact_rotation().col(2);
    chain.links.push_back(link);
    Arm<S> arm;
    ArmBuilder<S>(chain).place({JointPosition<S>{}}, arm);
    H = arm[1].hinge;
    column = Vector6<S>::Zero();
    (type == JointType::revolute ? column.template head<3>() : column.template tail<3>()) = link.axis;
  }
};

template <class A>
Eigen::MatrixXd absolute(const A& a) {
  return a.template cast<double>().cwiseAbs();
}

void check_same(const MatrixX<Q>& a, const MatrixX<Q>& b, const Eigen::MatrixXd&) { CHECK(a == b); }
void check_same(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Eigen::MatrixXd& size) {
  const double factor = ((a - b).array().abs() / size.array().max(1e-300)).maxCoeff<Eigen::PropagateNaN>();
  INFO("got\n" << a << "\nplain\n" << b);
  static double worst=0; if(factor>worst){worst=factor; std::cerr<<worst/2.22e-16<<"\n";}
  CHECK(factor <= 24 * std::numeric_limits<double>::epsilon());
}
/// Equal over fractions. Over doubles every entry within 24 eps of `size`, the same product of absolute values: an entry
/// sums at most 14 products in a row (6 + 6 of a triple product, 2 of psi), on either side; seen: 5 eps.
template <class A, class B>
void same(const A& a, const B& b, const Eigen::MatrixXd& size) {
  check_same(MatrixX<typename A::Scalar>(a), MatrixX<typename A::Scalar>(b), size);
}

template <class Check>
void for_seeds(Check check) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    INFO("seed " << seed);
    Random random(seed);
    check(random);
  }
}
/// The same for a joint that turns and one that slides.
template <Field S, class Check>
void for_joints(Check check) {
  for_seeds([&](Random& random) {
    for (const JointType type : {JointType::revolute, JointType::prismatic}) {
      INFO((type == JointType::revolute ? "revolute" : "prismatic"));
      check(random, Joint<S>(random, type));
    }
  });
}

}  // namespace

TEMPLATE_TEST_CASE("three-vectors and 3 x 3 matrices are what they are called", "", double, Q) {
  using S = TestType;
  for_seeds([](Random& random) {
    const auto a = vec3<S>(random), b = vec3<S>(random);
    const auto A = mat3<S>(random), B = mat3<S>(random);
    const auto s = sym3<S>(random);
    const auto x = plain(a), y = plain(b);
    const auto X = plain(A), Y = plain(B);
    const auto Z = plain(s);
    same(plain(cross(a, b)), (skew(x) * y).eval(), absolute(skew(x)) * absolute(y));
    same(plain(A * b), (X * y).eval(), absolute(X) * absolute(y));
    same(plain(transposed_times(A, b)), (X.transpose() * y).eval(), absolute(X).transpose() * absolute(y));
    same(plain(A * B), (X * Y).eval(), absolute(X) * absolute(Y));
    same(plain(cross(a, B)), (skew(x) * Y).eval(), absolute(skew(x)) * absolute(Y));
    same(plain(cross(A, b)), (X * skew(y)).eval(), absolute(X) * absolute(skew(y)));
    same(plain(s * b), (Z * y).eval(), absolute(Z) * absolute(y));
    same(plain(full(s)), Z, absolute(Z));
    same(plain(outer(a, b)), (x * y.transpose()).eval(), absolute(x) * absolute(y).transpose());
    same(plain(square(a)), (x * x.transpose()).eval(), absolute(x) * absolute(x).transpose());
    same(plain(twice_outer(a, b)), (x * y.transpose() + y * x.transpose()).eval(),
         2 * absolute(x) * absolute(y).transpose() + 2 * absolute(y) * absolute(x).transpose());
    same(plain(turned(A, s)), (X * Z * X.transpose()).eval(),
         absolute(X) * absolute(Z) * absolute(X).transpose());
  });
}

TEMPLATE_TEST_CASE("phi moves forces, its star motions, and shifts form a group", "", double, Q) {
  using S = TestType;
  for_seeds([](Random& random) {
    const Shift<S> phi{vec3<S>(random)}, next{vec3<S>(random)}, both{phi.l + next.l}, back{-phi.l};
    const auto f = vec<Force, S>(random);
    const auto V = vec<Motion, S>(random);
    const Matrix6<S> X = plain_shift(phi.l), N = plain_shift(next.l);
    same(plain(phi * f), (X * plain(f)).eval(), absolute(X) * absolute(plain(f)));
    same(plain(phi.T() * V), (X.transpose() * plain(V)).eval(),
         absolute(X).transpose() * absolute(plain(V)));
    const Eigen::MatrixXd size = absolute(N) * absolute(X);
    same(plain(next * (phi * f)), plain(both * f), size * absolute(plain(f)));
    same(plain(phi.T() * (next.T() * V)), plain(both.T() * V), size.transpose() * absolute(plain(V)));
    same(plain(back * (phi * f)), plain(f), absolute(X) * absolute(X) * absolute(plain(f)));
    const Eigen::Matrix<S, 1, 1> power(dot(phi * f, V)), same_power(dot(f, phi.T() * V));
    same(power, same_power, absolute(plain(V)).transpose() * absolute(X) * absolute(plain(f)));
  });
}

TEMPLATE_TEST_CASE("symmetric maps act, add and move as 6 x 6 matrices", "", double, Q) {
  using S = TestType;
  for_seeds([](Random& random) {
    const Shift<S> phi{vec3<S>(random)};
    const auto P = symmetric<Force, S>(random), R = symmetric<Force, S>(random);
    const auto Omega = symmetric<Motion, S>(random);
    const auto V = vec<Motion, S>(random), W = vec<Motion, S>(random);
    const auto f = vec<Force, S>(random);
    const S s = number<S>(random);
    const Matrix6<S> X = plain_shift(phi.l), p = plain(P), o = plain(Omega);
    const Vector6<S> v = plain(V), w = plain(W);
    const Eigen::MatrixXd x = absolute(X);
    same(plain(P + R), (p + plain(R)).eval(), absolute(p) + absolute(plain(R)));
    same(plain(P - R), (p - plain(R)).eval(), absolute(p) + absolute(plain(R)));
    same(plain(-P), (-p).eval(), absolute(p));
    same(plain(P * V), (p * v).eval(), absolute(p) * absolute(v));
    same(plain(Omega * f), (o * plain(f)).eval(), absolute(o) * absolute(plain(f)));
    same(plain(carried(phi, P)), (X * p * X.transpose()).eval(), x * absolute(p) * x.transpose());
    same(plain(carried(phi.T(), Omega)), (X.transpose() * o * X).eval(), x.transpose() * absolute(o) * x);
    same(plain(phi.T() * Omega * phi), (X.transpose() * o * X).eval(), x.transpose() * absolute(o) * x);
    same(plain(scaled_square(V, s)), (v * v.transpose() * s).eval(),
         absolute(v) * absolute(v).transpose());
    same(plain(twice_outer(V, W)), (v * w.transpose() + w * v.transpose()).eval(),
         absolute(v) * absolute(w).transpose() + absolute(w) * absolute(v).transpose());
  });
}

TEMPLATE_TEST_CASE("a rigid body is its 6 x 6 inertia", "", double, Q) {
  using S = TestType;
  for_seeds([](Random& random) {
    const RigidInertia<S> M{sym3<S>(random), vec3<S>(random), number<S>(random)};
    const auto P = symmetric<Force, S>(random);
    const auto V = vec<Motion, S>(random);
    const Matrix6<S> m = plain_body(M);
    same(plain(P + M), (plain(P) + m).eval(), absolute(plain(P)) + absolute(m));
    same(plain_body(-M), (-m).eval(), absolute(m));
    same(plain(M * V), (m * plain(V)).eval(), absolute(m) * absolute(plain(V)));
  });
}

TEMPLATE_TEST_CASE("a hinge is a row of six numbers", "", double, Q) {
  using S = TestType;
  for_joints<S>([](Random& random, const Joint<S>& joint) {
    const auto& [H, h] = joint;
    const auto P = definite<Force, S>(random);
    const auto f = vec<Force, S>(random);
    const S rate = number<S>(random), torque = number<S>(random), armature = S(3);
    const auto size = absolute(h);
    using One = Eigen::Matrix<S, 1, 1>;
    same(plain(H.T() * rate), (h * rate).eval(), size);
    same(One(H * f), (h.transpose() * plain(f)).eval(), size.transpose() * absolute(plain(f)));
    const auto D = H * P * H.T() + JointInertia<S>{armature};
    const One d = h.transpose() * plain(P) * h + One(armature);
    const Eigen::MatrixXd d_size = size.transpose() * absolute(plain(P)) * size + Eigen::MatrixXd(One(armature).template cast<double>());
    same(One(D.d), d, d_size);
    // Below, D comes from the map itself: its rounding was checked just now.
    const S inverse_d = S(1) / D.d;
    same(One(inverse(D) * torque), One(inverse_d * torque), absolute(One(inverse_d)));
    same(plain(H.T() * inverse(D) * torque), (h * inverse_d * torque).eval(), size * absolute(One(inverse_d)));
    same(plain(H.T() * inverse(D) * H), (h * inverse_d * h.transpose()).eval(),
         size * absolute(One(inverse_d)) * size.transpose());
  });
}

TEMPLATE_TEST_CASE("gains are columns of six numbers", "", double, Q) {
  using S = TestType;
  for_joints<S>([](Random& random, const Joint<S>& joint) {
    const auto& [H, h] = joint;
    const auto P = definite<Force, S>(random);
    const Shift<S> phi{vec3<S>(random)};
    const auto V = vec<Motion, S>(random);
    const S torque = number<S>(random);
    const JointInertia<S> D{S(2)}, J{S(5)};
    const auto G = P * H.T() * inverse(D);
    const auto K = phi * G;
    const Vector6<S> g = plain(P) * h / S(2), k = plain_shift(phi.l) * g;
    const Eigen::MatrixXd g_size = absolute(plain(P)) * absolute(h);
    const Eigen::MatrixXd k_size = absolute(plain_shift(phi.l)) * g_size;
    using One = Eigen::Matrix<S, 1, 1>;
    same(plain(G * torque), (g * torque).eval(), g_size * absolute(One(torque)));
    same(One(G.T() * V), (g.transpose() * plain(V)).eval(), g_size.transpose() * absolute(plain(V)));
    same(plain(K * torque), (k * torque).eval(), k_size * absolute(One(torque)));
    same(One(K.T() * V), (k.transpose() * plain(V)).eval(), k_size.transpose() * absolute(plain(V)));
    same(plain(K * J * K.T()), (k * S(5) * k.transpose()).eval(), 5 * k_size * k_size.transpose());
  });
}

TEMPLATE_TEST_CASE("psi = phi (1 - G H) acts and moves inertias and compliances as a 6 x 6 matrix", "", double, Q) {
  using S = TestType;
  for_joints<S>([](Random& random, const Joint<S>& joint) {
    const auto& [H, h] = joint;
    const auto P = definite<Force, S>(random), other = symmetric<Force, S>(random);
    const auto Omega = symmetric<Motion, S>(random);
    const Shift<S> phi{vec3<S>(random)};
    const auto f = vec<Force, S>(random);
    const auto V = vec<Motion, S>(random);
    const auto D = H * P * H.T();
    // Without armature H G = 1, with it H G = 1 - J/D, and with a D that has nothing to do with P anything.
    for (const auto& weight : {D, D + JointInertia<S>{S(4)}, JointInertia<S>{S(3)}}) {
      const auto G = P * H.T() * inverse(weight);
      const auto psi = phi * (one - G * H);
      const Vector6<S> g = plain(G * S(1));
      const Matrix6<S> Y = plain_shift(phi.l) * (Matrix6<S>::Identity() - g * h.transpose());
      const Eigen::MatrixXd y = absolute(plain_shift(phi.l)) *
                                (Eigen::MatrixXd::Identity(6, 6) + absolute(g) * absolute(h).transpose());
      same(plain(psi * f), (Y * plain(f)).eval(), y * absolute(plain(f)));
      same(plain(psi.T() * V), (Y.transpose() * plain(V)).eval(), y.transpose() * absolute(plain(V)));
      same(plain(psi * P * psi.T()), (Y * plain(P) * Y.transpose()).eval(),
           y * absolute(plain(P)) * y.transpose());
      same(plain(psi * other * psi.T()), (Y * plain(other) * Y.transpose()).eval(),
           y * absolute(plain(other)) * y.transpose());
      same(plain(psi.T() * Omega * psi), (Y.transpose() * plain(Omega) * Y).eval(),
           y.transpose() * absolute(plain(Omega)) * y);
    }
  });
}

TEST_CASE("without armature H G = 1, H (1 - G H) = 0 and psi G = 0, exactly") {
  for_joints<Q>([](Random& random, const Joint<Q>& joint) {
    const auto& H = joint.H;
    const auto P = definite<Force, Q>(random);
    const Shift<Q> phi{vec3<Q>(random)};
    const auto G = P * H.T() * inverse(H * P * H.T());
    const auto psi = phi * (one - G * H);
    const auto f = vec<Force, Q>(random);
    CHECK(H * (G * Q(1)) == Q(1));
    CHECK(H * (f - G * (H * f)) == Q(0));
    CHECK(plain(psi * (G * Q(1))) == Vector6<Q>::Zero());
  });
}
