// Every structured map against the plain matrix it stands for: exactly over fractions, to rounding over
// doubles.
#include <limits>

#include "model/random_arm.hpp"
#include "recursion/arm.hpp"
#include "support/catch.hpp"

using namespace osculate;
using osculate::Random;
using Q = Rational;

namespace {

// The stars of the paper are types: a forgotten or a superfluous one does not compile.
template <class A, class B>
concept Multipliable = requires(A a, B b) {
  a* b;
};
using D = double;
static_assert(Multipliable<Shift<D>, Vec<Force, D>> && !Multipliable<Shift<D>, Vec<Motion, D>>);
static_assert(Multipliable<Star<Shift<D>>, Vec<Motion, D>> && !Multipliable<Star<Shift<D>>, Vec<Force, D>>);
static_assert(Multipliable<Hinge<D>, Vec<Force, D>> && !Multipliable<Hinge<D>, Vec<Motion, D>>);
static_assert(Multipliable<Psi<Hinge<D>>, Vec<Force, D>> && !Multipliable<Psi<Hinge<D>>, Vec<Motion, D>>);
static_assert(Multipliable<Star<Psi<Hinge<D>>>, Vec<Motion, D>> &&
              !Multipliable<Star<Psi<Hinge<D>>>, Vec<Force, D>>);
static_assert(Multipliable<Inertia<D>, Vec<Motion, D>> && !Multipliable<Inertia<D>, Vec<Force, D>>);
static_assert(Multipliable<Compliance<D>, Vec<Force, D>> && !Multipliable<Compliance<D>, Vec<Motion, D>>);

template <Field S>
S number(Random& random) {
  if constexpr (std::is_same_v<S, double>)
    return random.uniform(-1, 1);
  else
    return random.fraction(9, 4);
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

/// A matrix as the tests see it, with the same sum of products over absolute values beside each entry.
template <Field S>
struct Plain {
  MatrixX<S> value;
  Eigen::MatrixXd size;

  Plain(const MatrixX<S>& v) : Plain(v, v.unaryExpr([](const S& x) { return std::abs(double(x)); })) {}
  Plain(const MatrixX<S>& v, const Eigen::MatrixXd& s) : value(v), size(s) {}
  Plain T() const { return {value.transpose(), size.transpose()}; }

  friend Plain operator+(const Plain& a, const Plain& b) { return {a.value + b.value, a.size + b.size}; }
  friend Plain operator-(const Plain& a, const Plain& b) { return {a.value - b.value, a.size + b.size}; }
  friend Plain operator-(const Plain& a) { return {-a.value, a.size}; }
  friend Plain operator*(const Plain& a, const Plain& b) {
    MatrixX<S> product = MatrixX<S>::Zero(a.value.rows(), b.value.cols());
    for (int i = 0; i < a.value.rows(); ++i)
      for (int j = 0; j < b.value.cols(); ++j)
        for (int k = 0; k < a.value.cols(); ++k) product(i, j) += a.value(i, k) * b.value(k, j);
    return {product, a.size * b.size};
  }
};

template <Field S>
Plain<S> plain(const S& s) {
  return MatrixX<S>(MatrixX<S>::Constant(1, 1, s));
}
template <Field S>
Plain<S> plain(const Vec3<S>& v) {
  return MatrixX<S>(Vector3<S>(v.x, v.y, v.z));
}
template <Field S>
Plain<S> plain(const Mat3<S>& a) {
  MatrixX<S> out(3, 3);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = entry(a, i, j);
  return out;
}
template <Field S>
Plain<S> plain(const Sym3<S>& a) {
  MatrixX<S> out(3, 3);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = entry(a, i, j);
  return out;
}
/// [a b; c d]
template <Field S>
Plain<S> blocks(const Plain<S>& a, const Plain<S>& b, const Plain<S>& c, const Plain<S>& d) {
  MatrixX<S> out(6, 6);
  out << a.value, b.value, c.value, d.value;
  return out;
}
template <class Space, Field S>
Plain<S> plain(const Vec<Space, S>& v) {
  MatrixX<S> out(6, 1);
  out << v.ang.x, v.ang.y, v.ang.z, v.lin.x, v.lin.y, v.lin.z;
  return out;
}
template <class To, Field S>
Plain<S> plain(const Symmetric<To, S>& a) {
  return blocks(plain(a.J), plain(a.B), plain(a.B).T(), plain(a.A));
}
template <Field S>
Plain<S> identity(int n) {
  return MatrixX<S>(MatrixX<S>::Identity(n, n));
}
/// a~ with a~ x = a x x
template <Field S>
Plain<S> skew(const Vec3<S>& a) {
  const S o(0);
  return plain(Mat3<S>{{o, -a.z, a.y}, {a.z, o, -a.x}, {-a.y, a.x, o}});
}
/// [1 l~; 0 1]
template <Field S>
Plain<S> plain(const Shift<S>& phi) {
  return blocks(identity<S>(3), skew(phi.l), plain(Mat3<S>{}), identity<S>(3));
}
/// [I m p~; -m p~ m 1]
template <Field S>
Plain<S> plain(const RigidInertia<S>& M) {
  return blocks(plain(M.I), skew(M.mp), -skew(M.mp), plain(Sym3<S>{M.m, S(0), S(0), M.m, S(0), M.m}));
}

void same(const Plain<Q>& a, const Plain<Q>& b) { CHECK(a.value == b.value); }
/// Every entry within 8 eps of the size of b, its sum of products over absolute values; worst seen 1.6 eps.
/// (Such an entry is a sum of up to 14 products in a row, 6 + 6 of a triple product and 2 of psi, which
/// bounds it by 14 eps a side.)
void same(const Plain<double>& a, const Plain<double>& b) {
  const auto allowed = 8 * std::numeric_limits<double>::epsilon() * b.size.array();
  INFO("got\n" << a.value << "\nplain\n" << b.value);
  CHECK(((a.value - b.value).array().abs() <= allowed).all());
}

/// A A^T + 1 as a structured map: positive definite, so that D = H P H* is safely positive.
template <class To, Field S>
Symmetric<To, S> definite(Random& random) {
  Symmetric<To, S> P{{S(1), S(0), S(0), S(1), S(0), S(1)}, {}, {S(1), S(0), S(0), S(1), S(0), S(1)}};
  for (int i = 0; i < 6; ++i) P = P + scaled_square(vec<To, S>(random), S(1));
  return P;
}

/// The joint of a one-link arm with a random axis, and H* as six numbers.
template <Field S>
struct PlainJoint {
  Hinge<S> H;
  Plain<S> column;

  PlainJoint(Random& random, JointType type) : column(plain(Vec<Motion, S>{})) {
    Chain<S> chain;
    Link<S> link;
    link.type = type;
    if constexpr (std::is_same_v<S, double>)
      link.axis = random.direction();
    else
      link.axis = random.exact_rotation().col(2);
    chain.links.push_back(link);
    const ArmBuilder<S> builder(chain);
    Arm<S> arm = builder.arm();
    builder.place({JointPosition<S>{}}, arm);
    H = arm[1].hinge;
    const Vec3<S> h = to_vec3(link.axis);
    column = plain(type == JointType::revolute ? Vec<Motion, S>{h, {}} : Vec<Motion, S>{{}, h});
  }
};

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
      check(random, PlainJoint<S>(random, type));
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
    const auto x = plain(a), y = plain(b), X = plain(A), Y = plain(B), Z = plain(s);
    same(plain(cross(a, b)), skew(a) * y);
    same(plain(dot(a, b)), x.T() * y);
    same(plain(A * b), X * y);
    same(plain(transpose(A)), X.T());
    same(plain(transposed_times(A, b)), X.T() * y);
    same(plain(A * B), X * Y);
    same(plain(cross(a, B)), skew(a) * Y);
    same(plain(cross(A, b)), X * skew(b));
    same(plain(outer(a, b)), x * y.T());
    same(plain(s * b), Z * y);
    same(plain(full(s)), Z);
    same(plain(upper(full(s))), Z);
    same(plain(square(a)), x * x.T());
    same(plain(twice_outer(a, b)), x * y.T() + y * x.T());
    same(plain(turned(A, s)), X * Z * X.T());
  });
}

TEMPLATE_TEST_CASE("phi moves forces, its star motions, and shifts form a group", "", double, Q) {
  using S = TestType;
  for_seeds([](Random& random) {
    const Shift<S> phi{vec3<S>(random)}, next{vec3<S>(random)};
    const Shift<S> both{phi.l + next.l}, back{-phi.l};
    const auto f = vec<Force, S>(random);
    const auto V = vec<Motion, S>(random);
    const auto X = plain(phi), N = plain(next);
    same(plain(phi * f), X * plain(f));
    same(plain(phi.T() * V), X.T() * plain(V));
    same(plain(both * f), N * X * plain(f));
    same(plain(both.T() * V), X.T() * N.T() * plain(V));
    same(plain(f), plain(back) * plain(phi * f));
    same(plain(back * (phi * f)), plain(back) * X * plain(f));
    same(plain(dot(phi * f, V)), plain(V).T() * X * plain(f));
    same(plain(dot(phi.T() * V, f)), plain(V).T() * X * plain(f));
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
    const auto X = plain(phi), v = plain(V), w = plain(W);
    same(plain(P + R), plain(P) + plain(R));
    same(plain(P - R), plain(P) - plain(R));
    same(plain(-P), -plain(P));
    same(plain(P * V), plain(P) * v);
    same(plain(Omega * f), plain(Omega) * plain(f));
    same(plain(carried(phi, P)), X * plain(P) * X.T());
    same(plain(carried(phi.T(), Omega)), X.T() * plain(Omega) * X);
    same(plain(phi.T() * Omega * phi), X.T() * plain(Omega) * X);
    same(plain(scaled_square(V, s)), v * plain(s) * v.T());
    same(plain(twice_outer(V, W)), v * w.T() + w * v.T());
  });
}

TEMPLATE_TEST_CASE("a rigid body is its 6 x 6 inertia", "", double, Q) {
  using S = TestType;
  for_seeds([](Random& random) {
    const RigidInertia<S> M{sym3<S>(random), vec3<S>(random), number<S>(random)};
    const auto P = symmetric<Force, S>(random);
    const auto V = vec<Motion, S>(random);
    same(plain(P + M), plain(P) + plain(M));
    same(plain(-M), -plain(M));
    same(plain(M * V), plain(M) * plain(V));
  });
}

TEMPLATE_TEST_CASE("a hinge is a row of six numbers", "", double, Q) {
  using S = TestType;
  for_joints<S>([](Random& random, const PlainJoint<S>& joint) {
    const auto& [H, h] = joint;
    const auto P = definite<Force, S>(random);
    const auto f = vec<Force, S>(random);
    const S rate = number<S>(random), torque = number<S>(random);
    same(plain(H.T() * rate), h * plain(rate));
    same(plain(H * f), h.T() * plain(f));
    const auto D = H * P * H.T() + HingeInertia<S>{S(3)};
    same(plain(D.d), h.T() * plain(P) * h + plain(S(3)));
    // Below, D is that of the map: its rounding was checked just now.
    const auto d = plain(S(1) / D.d);
    same(plain(inverse(D) * torque), d * plain(torque));
    same(plain(H.T() * inverse(D) * torque), h * d * plain(torque));
    same(plain(H.T() * inverse(D) * H), h * d * h.T());
  });
}

TEMPLATE_TEST_CASE("gains are columns of six numbers", "", double, Q) {
  using S = TestType;
  for_joints<S>([](Random& random, const PlainJoint<S>& joint) {
    const auto& [H, h] = joint;
    const auto P = definite<Force, S>(random);
    const Shift<S> phi{vec3<S>(random)};
    const auto V = vec<Motion, S>(random);
    const S torque = number<S>(random);
    const HingeInertia<S> D{S(4)}, J{S(5)};
    const auto G = P * H.T() * inverse(D);
    const auto K = phi * G;
    const auto g = plain(P) * h * plain(S(1) / S(4)), k = plain(phi) * g;
    same(plain(G * torque), g * plain(torque));
    same(plain(G.T() * V), g.T() * plain(V));
    same(plain(K * torque), k * plain(torque));
    same(plain(K.T() * V), k.T() * plain(V));
    same(plain(K * J * K.T()), k * plain(S(5)) * k.T());
  });
}

TEMPLATE_TEST_CASE("psi = phi (1 - G H) acts and moves inertias and compliances as a 6 x 6 matrix", "",
                   double, Q) {
  using S = TestType;
  for_joints<S>([](Random& random, const PlainJoint<S>& joint) {
    const auto& [H, h] = joint;
    const auto P = definite<Force, S>(random);
    const auto Omega = symmetric<Motion, S>(random);
    const Shift<S> phi{vec3<S>(random)};
    const auto f = vec<Force, S>(random);
    const auto V = vec<Motion, S>(random);
    const auto D = H * P * H.T();
    // Without armature H G = 1, with it H G = 1 - J/D, and with a D that has nothing to do with P anything.
    for (const auto& weight : {D, D + HingeInertia<S>{S(4)}, HingeInertia<S>{S(3)}}) {
      auto G = P * H.T() * inverse(weight);
      G.D = weight;
      const auto psi = phi * (one - G * H);
      const auto Y = plain(phi) * (identity<S>(6) - plain(G * S(1)) * h.T());
      same(plain(psi * f), Y * plain(f));
      same(plain(psi.T() * V), Y.T() * plain(V));
      same(plain(psi * P * phi.T()), Y * plain(P) * plain(phi).T());
      same(plain(psi.T() * Omega * psi), Y.T() * plain(Omega) * Y);
    }
  });
}

TEST_CASE("psi P phi* is the psi P psi* + K J K* of (37) with armature, exactly") {
  for_joints<Q>([](Random& random, const PlainJoint<Q>& joint) {
    const auto& [H, h] = joint;
    const auto P = definite<Force, Q>(random);
    const Shift<Q> phi{vec3<Q>(random)};
    for (const HingeInertia<Q>& J : {HingeInertia<Q>{Q(0)}, HingeInertia<Q>{Q(4)}}) {
      const auto D = H * P * H.T() + J;
      auto G = P * H.T() * inverse(D);
      G.D = D;
      const auto K = phi * G;
      const auto psi = phi * (one - G * H);
      const auto Y = plain(phi) * (identity<Q>(6) - plain(G * Q(1)) * h.T());
      same(plain(psi * P * phi.T()), Y * plain(P) * Y.T() + plain(K * J * K.T()));
    }
  });
}

TEST_CASE("without armature H G = 1, H (1 - G H) = 0 and psi G = 0, exactly") {
  for_joints<Q>([](Random& random, const PlainJoint<Q>& joint) {
    const auto& H = joint.H;
    const auto P = definite<Force, Q>(random);
    const Shift<Q> phi{vec3<Q>(random)};
    const auto G = P * H.T() * inverse(H * P * H.T());
    const auto psi = phi * (one - G * H);
    const auto f = vec<Force, Q>(random);
    CHECK(H * (G * Q(1)) == Q(1));
    CHECK(H * (f - G * (H * f)) == Q(0));
    CHECK(plain(psi * (G * Q(1))).value.isZero(0));
  });
}
