// Two arms small enough for pencil and paper, compared exactly. Both move in the x-y plane, gravity is (0,
// -g, 0).
#include "reference/exact.hpp"
#include "support/catch.hpp"

namespace osculate::testing::closed_form_tests {
using Q = Rational;
using Vector = VectorX<Q>;
using Matrix = MatrixX<Q>;

namespace {

const Q g(981, 100);

Link<Q> link(JointType type, Vector3<Q> p_origin, Q mass, Vector3<Q> com, Q inertia_z) {
  Link<Q> out;
  out.type = type;
  out.p_origin = p_origin;
  out.mass = mass;
  out.com = com;
  out.inertia = Vector3<Q>(Q(1, 5), Q(1, 7), inertia_z).asDiagonal();  // x and y never count in the plane
  return out;
}

template <class... Numbers>
Vector vector(Numbers... x) {
  Vector out(sizeof...(x));
  int i = 0;
  ((out[i++] = Q(x)), ...);
  return out;
}

}  // namespace

TEST_CASE("planar two-link arm") {
  const Q l1(1, 2), l2(2, 5), r1(1, 5), r2(1, 4), m1(3), m2(2), I1(1, 10), I2(1, 20), A1(1, 3), A2(1, 6);
  Chain<Q> chain;
  chain.links = {link(JointType::revolute, {Q(0), Q(0), Q(0)}, m1, {r1, Q(0), Q(0)}, I1),
                 link(JointType::revolute, {l1, Q(0), Q(0)}, m2, {r2, Q(0), Q(0)}, I2)};
  chain.links[0].armature = A1;
  chain.links[1].armature = A2;
  chain.p_tip = {l2, Q(0), Q(0)};
  chain.gravity = {Q(0), -g, Q(0)};
  const Q c1(3, 5), s1(4, 5), c2(5, 13), s2(-12, 13);
  const Q c12 = c1 * c2 - s1 * s2, s12 = s1 * c2 + c1 * s2;
  const Q w1(3, 2), w2(-7, 3), w = w1 + w2;
  const auto x = dense::state<Q>(chain, {{c1, s1, Q(0)}, {c2, s2, Q(0)}}, vector(w1, w2));

  // Centres of mass r1 (c1, s1) and l1 (c1, s1) + r2 (c12, s12), turning at w1 and w = w1 + w2:
  //   2 T = (m1 r1^2 + I1) w1^2 + m2 (l1^2 w1^2 + r2^2 w^2 + 2 l1 r2 c2 w1 w) + I2 w^2 + A1 w1^2 + A2 w2^2
  const Q a = m1 * r1 * r1 + I1 + m2 * l1 * l1, b = m2 * r2 * r2 + I2, e = m2 * l1 * r2;
  Matrix M(2, 2);
  M << a + b + 2 * e * c2 + A1, b + e * c2, b + e * c2, b + A2;
  CHECK(x.joint.M == M);
  CHECK(2 * dense::kinetic_energy(x.joint, vector(w1, w2)) ==
        a * w1 * w1 + b * w * w + 2 * e * c2 * w1 * w + A1 * w1 * w1 + A2 * w2 * w2);

  // Lagrange: d/dt (dT/dw_i) - dT/dq_i at zero acceleration. Only c2 depends on q, c2' = -s2 w2:
  //   row 1: (2 e w1 + e w2) c2' = -e s2 w2 (2 w1 + w2);   row 2: e w1 c2' + e s2 w1 w = e s2 w1^2
  CHECK(x.joint.C == vector(-e * s2 * w2 * (2 * w1 + w2), e * s2 * w1 * w1));

  // U = g (m1 r1 s1 + m2 (l1 s1 + r2 s12))
  CHECK(x.joint.G == vector(g * ((m1 * r1 + m2 * l1) * c1 + m2 * r2 * c12), g * m2 * r2 * c12));
  CHECK(dense::potential_energy(chain, dense::Positions<Q>{{c1, s1, Q(0)}, {c2, s2, Q(0)}}) ==
        g * (m1 * r1 * s1 + m2 * (l1 * s1 + r2 * s12)));

  // Tip (l1 c1 + l2 c12, l1 s1 + l2 s12), rows wx wy wz vx vy vz.
  const Q px = l1 * c1 + l2 * c12, py = l1 * s1 + l2 * s12;
  Matrix J = Matrix::Zero(6, 2);
  J.row(2) << Q(1), Q(1);
  J.row(3) << -py, -l2 * s12;
  J.row(4) << px, l2 * c12;
  CHECK(x.tip.p == Vector3<Q>(px, py, Q(0)));
  CHECK(x.tip.R.col(0) == Vector3<Q>(c12, s12, Q(0)));
  CHECK(Matrix(x.tip.J) == J);
  CHECK(Vector(x.tip.tip_velocity) == Vector(J * vector(w1, w2)));
  // Centripetal acceleration of both links: -l1 w1^2 (c1, s1) - l2 w^2 (c12, s12)
  CHECK(Vector(x.tip.Jdot_qd) ==
        vector(0, 0, 0, -l1 * w1 * w1 * c1 - l2 * w * w * c12, -l1 * w1 * w1 * s1 - l2 * w * w * s12, 0));

  // Rows vx, vy: J is square and regular, so Lambda = J^-T M J^-1 = adj(J)^T M adj(J) / det^2, det = l1 l2
  // s2.
  const auto task = dense::mobility(x.tip, x.joint, {3, 4});
  const auto terms = dense::task_terms(task);
  Matrix adjugate(2, 2);
  adjugate << J(4, 1), -J(3, 1), -J(4, 0), J(3, 0);
  const Q det = l1 * l2 * s2;
  CHECK(terms.Lambda == Matrix(adjugate.transpose() * M * adjugate / (det * det)));
  const Matrix J_inverse_transposed = adjugate.transpose() / det;
  CHECK(terms.g == Vector(J_inverse_transposed * x.joint.G));
  CHECK(terms.c ==
        Vector(J_inverse_transposed * x.joint.C - terms.Lambda * vector(x.tip.Jdot_qd[3], x.tip.Jdot_qd[4])));
}

TEST_CASE("polar arm: a slide on a turntable") {
  const Q m1(2), m2(3), r1(1, 5), r2(1, 8), I1(1, 9), I2(1, 30), A2(1, 2), l(1, 4);
  Chain<Q> chain;
  chain.links = {link(JointType::revolute, {Q(0), Q(0), Q(0)}, m1, {r1, Q(0), Q(0)}, I1),
                 link(JointType::prismatic, {Q(0), Q(0), Q(0)}, m2, {r2, Q(0), Q(0)}, I2)};
  chain.links[1].axis = {Q(1), Q(0), Q(0)};
  chain.links[1].armature = A2;
  chain.p_tip = {l, Q(0), Q(0)};
  chain.gravity = {Q(0), -g, Q(0)};
  const Q c(8, 17), s(15, 17), d(3, 7), w(5, 4), v(-2, 3);
  const auto x = dense::state<Q>(chain, {{c, s, Q(0)}, {Q(1), Q(0), d}}, vector(w, v));

  // 2 T = (m1 r1^2 + I1 + I2) w^2 + m2 ((d + r2)^2 w^2 + v^2) + A2 v^2,  U = g s (m1 r1 + m2 (d + r2))
  const Q R = d + r2;
  Matrix M(2, 2);
  M << m1 * r1 * r1 + I1 + I2 + m2 * R * R, Q(0), Q(0), m2 + A2;
  CHECK(x.joint.M == M);
  CHECK(x.joint.C == vector(2 * m2 * R * w * v, -m2 * R * w * w));
  CHECK(x.joint.G == vector(g * c * (m1 * r1 + m2 * R), g * s * m2));

  // Tip at (d + l)(c, s): acceleration 2 w v (-s, c) - (d + l) w^2 (c, s) for constant rates.
  const Q L = d + l;
  Matrix J = Matrix::Zero(6, 2);
  J(2, 0) = Q(1);
  J.row(3) << -L * s, c;
  J.row(4) << L * c, s;
  CHECK(Matrix(x.tip.J) == J);
  CHECK(Vector(x.tip.Jdot_qd) ==
        vector(0, 0, 0, -2 * w * v * s - L * w * w * c, 2 * w * v * c - L * w * w * s, 0));

  // Along the slide the tip feels m2 + A2, across it the turntable's moment of inertia over L^2.
  const auto terms = dense::task_terms(dense::mobility(x.tip, x.joint, {3, 4}));
  const Q along = m2 + A2, across = M(0, 0) / (L * L);
  Matrix Lambda(2, 2);
  Lambda << c * c * along + s * s * across, c * s * (along - across), c * s * (along - across),
      s * s * along + c * c * across;
  CHECK(terms.Lambda == Lambda);

  // A force on the tip is felt as work: T_2 = force along the slide, T_1 = L times the force across it.
  dense::Vector6<Q> F_ext = dense::Vector6<Q>::Zero();
  F_ext[3] = Q(4);
  F_ext[4] = Q(-9);
  const Vector T = x.joint.C + x.joint.G - vector(L * (-4 * s - 9 * c), 4 * c - 9 * s);
  CHECK(dense::forward_dynamics(x.joint, x.tip.J, T, F_ext) == vector(0, 0));
}

}  // namespace osculate::testing::closed_form_tests
