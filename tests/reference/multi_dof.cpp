// Joints with several axes and a moving base, over exact fractions, against what they can be built from:
// one-axis joints with massless links between them, a floating joint that carries the base, and the closed
// form of a free rigid body.
#include "model/random_arm.hpp"
#include "reference/exact.hpp"
#include "support/catch.hpp"

namespace osculate::testing::multi_dof_tests {
using Q = Rational;
using Vector = VectorX<Q>;
using Matrix = MatrixX<Q>;
using Vector6 = dense::Vector6<Q>;
using enum JointType;

namespace {

struct Turn {
  Q c, s;
  JointPosition<Q> position() const { return {c, s}; }
  Matrix3<Q> about(const Vector3<Q>& axis) const { return rotation<Q>(axis, c, s); }
};

/// A state of one joint with several axes, and its one-axis stand-ins in the same state, inboard first. Their
/// coordinates come in the order of the joint's own.
struct Joint {
  struct Part {
    JointType type;
    Vector3<Q> axis;
    JointPosition<Q> position;
  };
  JointPosition<Q> position;
  std::vector<Part> parts;
};

/// The joint of `link`, whose axes it takes.
Joint joint_of(const Link<Q>& link) {
  const Turn first{Q(3, 5), Q(-4, 5)}, second{Q(5, 13), Q(12, 13)};
  const Q x(2, 7), y(-1, 3);
  const Vector3<Q> side = link.axis.cross(link.axis2);
  Joint out;
  const auto slide = [](const Q& d) { return JointPosition<Q>{Q(1), Q(0), d}; };
  switch (link.type) {
    case cylindrical:
      out.position.R = first.about(link.axis);
      out.position.p = x * link.axis;
      out.parts = {{revolute, link.axis, first.position()}, {prismatic, link.axis, slide(x)}};
      break;
    case universal:
      out.position.R = first.about(link.axis) * second.about(link.axis2);
      out.parts = {{revolute, link.axis, first.position()}, {revolute, link.axis2, second.position()}};
      break;
    case planar:
      out.position.R = first.about(link.axis);
      out.position.p = x * link.axis2 + y * side;
      out.parts = {{prismatic, link.axis2, slide(x)},
                   {prismatic, side, slide(y)},
                   {revolute, link.axis, first.position()}};
      break;
    default:
      FAIL("no one-axis joints stand for this type");
  }
  return out;
}

/// A link that weighs nothing, in front of which nothing is.
Link<Q> massless(JointType type, const Vector3<Q>& axis) {
  Link<Q> out;
  out.type = type;
  out.axis = axis;
  return out;
}

/// The arm with its joint of several axes replaced by one-axis joints with massless links between.
ExactArm taken_apart(const ExactArm& arm) {
  ExactArm out;
  out.chain = arm.chain;
  out.chain.links.clear();
  out.qd = arm.qd;
  for (std::size_t i = 0; i < arm.chain.links.size(); ++i) {
    const Link<Q>& link = arm.chain.links[i];
    if (one_axis(link.type)) {
      out.chain.links.push_back(link);
      out.positions.push_back(arm.positions[i]);
      continue;
    }
    const Joint joint = joint_of(link);
    for (std::size_t j = 0; j < joint.parts.size(); ++j) {
      const auto& part = joint.parts[j];
      Link<Q> next = massless(part.type, part.axis);
      if (j + 1 == joint.parts.size()) {
        next = link;
        next.type = part.type;
        next.axis = part.axis;
        next.R_origin.setIdentity();
        next.p_origin.setZero();
      }
      if (j == 0) {
        next.R_origin = link.R_origin;
        next.p_origin = link.p_origin;
      }
      out.chain.links.push_back(next);
      out.positions.push_back(part.position);
    }
  }
  return out;
}

void check_equal(const dense::State<Q>& x, const dense::State<Q>& y) {
  CHECK(x.tip.R == y.tip.R);
  CHECK(x.tip.p == y.tip.p);
  CHECK(x.tip.J == y.tip.J);
  CHECK(x.tip.tip_velocity == y.tip.tip_velocity);
  CHECK(x.tip.Jdot_qd == y.tip.Jdot_qd);
  CHECK(x.joint.M == y.joint.M);
  CHECK(x.joint.C == y.joint.C);
  CHECK(x.joint.G == y.joint.G);
}

BaseMotion<Q> exact_base(Random& random) {
  BaseMotion<Q> base;
  base.R = random.exact_rotation();
  base.p = random.fraction3(4, 2);
  for (Q& x : base.velocity) x = random.fraction(3, 2);
  for (Q& x : base.acceleration) x = random.fraction(5, 2);
  return base;
}

}  // namespace

TEST_CASE("a joint of two or three axes is that many one-axis joints with massless links between") {
  for (const JointType type : {cylindrical, universal, planar})
    for (unsigned seed = 1; seed <= 4; ++seed) {
      ExactArm arm = exact_arm_of(seed, {revolute, type, prismatic, revolute});
      arm.positions[1] = joint_of(arm.chain.links[1]).position;
      INFO(letters(arm.chain) << ", seed = " << seed);
      const ExactArm parts = taken_apart(arm);
      REQUIRE(parts.chain.n() == arm.chain.velocities());
      check_equal(dense::state(arm.chain, arm.positions, arm.qd),
                  dense::state(parts.chain, parts.positions, parts.qd));
      Random random(seed);
      const BaseMotion<Q> base = exact_base(random);
      check_equal(dense::state(arm.chain, arm.positions, arm.qd, base),
                  dense::state(parts.chain, parts.positions, parts.qd, base));
    }
}

TEST_CASE("rates of a joint's position are those of its coordinates") {
  // Coordinates as dual numbers, put through the model's own formula for the quaternion.
  using D = Dual<Q>;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    Link<Q> link;
    link.type = floating;
    Vector rates(6);
    for (Q& r : rates) r = random.fraction(5, 3);
    const Vector3<Q> w = rates.head(3), v = rates.tail(3);
    const Q e0(random.integer(1, 4)), e1 = random.fraction(3, 1), e2 = random.fraction(3, 1),
                                      e3 = random.fraction(3, 1);
    // de/dt = 1/2 e (0, w): Hamilton's product, w in link axes. Its length is kept, so any length will do.
    const D a(e0, -(e1 * w[0] + e2 * w[1] + e3 * w[2]) / Q(2)),
        b(e1, (e0 * w[0] + e2 * w[2] - e3 * w[1]) / Q(2)), c(e2, (e0 * w[1] + e3 * w[0] - e1 * w[2]) / Q(2)),
        d(e3, (e0 * w[2] + e1 * w[1] - e2 * w[0]) / Q(2));
    const Matrix3<D> R = rotation_of_quaternion<D>(a, b, c, d);
    JointPosition<Q> at;
    at.R = values(R);
    at.p = random.fraction3(4, 3);
    const JointPosition<D> moved = dense::moving(link, at, rates.data());
    CHECK(Matrix3<Q>(values(moved.R)) == at.R);
    CHECK(Matrix3<Q>(derivatives(moved.R)) == Matrix3<Q>(derivatives(R)));
    CHECK(Vector3<Q>(derivatives(moved.p)) == v);
    link.type = spherical;
    const JointPosition<D> turned = dense::moving(link, at, rates.data());
    CHECK(Matrix3<Q>(derivatives(turned.R)) == Matrix3<Q>(derivatives(R)));
    CHECK(Vector3<Q>(derivatives(turned.p)) == Vector3<Q>(Q(0), Q(0), Q(0)));
  }
}

TEST_CASE("one free body: Lambda, c and g are those of the body moved to the tip") {
  // Errata of the paper, c.2: c(0) = (w x I w; m w x (w x p)), g(0) = (m p x g e; m g e), p from the tip to
  // the centre of mass, I about the tip.
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const ExactArm arm = exact_arm_of(seed, {floating});
    const Link<Q>& link = arm.chain.links[0];
    const auto x = dense::state(arm.chain, arm.positions, arm.qd);
    const auto terms = dense::task_terms(dense::mobility(x.tip, x.joint));
    const Matrix3<Q> R = link.R_origin * arm.positions[0].R, one = Matrix3<Q>::Identity();
    const Vector3<Q> w = R * Vector3<Q>(arm.qd.head(3)), p = R * (link.com - arm.chain.p_tip);
    const Vector3<Q> up = -arm.chain.gravity;
    const Q m = link.mass;
    const Matrix3<Q> I = R * link.inertia * R.transpose() + m * (p.dot(p) * one - p * p.transpose());
    const Matrix3<Q> mp = m * dense::cross_matrix(p);
    Matrix Lambda(6, 6);
    Lambda << I, mp, -mp, m * one;
    CHECK(terms.Lambda == Lambda);
    const Vector3<Q> Iw = I * w;
    Vector c(6), g(6);
    c << w.cross(Iw), m * w.cross(w.cross(p));
    g << m * p.cross(up), m * up;
    CHECK(terms.c == c);
    CHECK(terms.g == g);
  }
}

TEST_CASE("the two passes of state() are the definitions link by link, exactly") {
  for (const std::vector<JointType>& types : {std::vector<JointType>{revolute, prismatic, revolute},
                                              {spherical, revolute},
                                              {universal, planar},
                                              {floating, cylindrical}})
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const ExactArm arm = exact_arm_of(seed, types);
      INFO(letters(arm.chain) << ", seed = " << seed);
      Random random(seed);
      const BaseMotion<Q> base = exact_base(random);
      const auto x = dense::state(arm.chain, arm.positions, arm.qd, base);
      const auto tip = dense::kinematics(arm.chain, arm.positions, arm.qd, base);
      const auto joint = dense::joint_space(arm.chain, arm.positions, arm.qd, base);
      CHECK(x.tip.R == tip.R);
      CHECK(x.tip.p == tip.p);
      CHECK(x.tip.J == tip.J);
      CHECK(x.tip.tip_velocity == tip.tip_velocity);
      CHECK(x.tip.Jdot_qd == tip.Jdot_qd);
      CHECK(x.joint.M == joint.M);
      CHECK(x.joint.C == joint.C);
      CHECK(x.joint.G == joint.G);
    }
}

TEST_CASE("a body on a ball joint obeys Euler's equation about the joint") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const ExactArm arm = exact_arm_of(seed, {spherical});
    const Link<Q>& link = arm.chain.links[0];
    const auto x = dense::joint_space(arm.chain, arm.positions, arm.qd);
    // In link axes: I w' + w x I w = moment of the weight, I about the joint.
    const Vector3<Q> w = arm.qd, p = link.com;
    const Matrix3<Q> I = link.inertia + link.mass * (p.dot(p) * Matrix3<Q>::Identity() - p * p.transpose());
    const Matrix3<Q> R = link.R_origin * arm.positions[0].R;
    const Vector3<Q> Iw = I * w, weight = link.mass * (R.transpose() * arm.chain.gravity);
    CHECK(x.M == Matrix(I));
    CHECK(x.C == Vector(w.cross(Iw)));
    CHECK(x.G == Vector(-p.cross(weight)));
  }
}

TEST_CASE("an arm on a moving base is a longer arm whose first joint moves the base") {
  for (const std::vector<JointType>& types :
       {std::vector<JointType>{revolute, prismatic, revolute}, {spherical, revolute}, {universal, planar}})
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const ExactArm arm = exact_arm_of(seed, types);
      INFO(letters(arm.chain) << ", seed = " << seed);
      Random random(seed);
      const BaseMotion<Q> base = exact_base(random);
      const int m = arm.chain.velocities();

      // The base becomes a massless link on a floating joint; its rates are in link axes (angular) and in the
      // inertial frame (linear), and so is their derivative: d/dt R w = R w'.
      ExactArm longer = arm;
      longer.chain.links.insert(longer.chain.links.begin(), massless(floating, Vector3<Q>::UnitZ()));
      JointPosition<Q> place;
      place.R = base.R;
      place.p = base.p;
      longer.positions.insert(longer.positions.begin(), place);
      longer.qd.resize(6 + m);
      longer.qd << base.R.transpose() * base.velocity.head(3), base.velocity.tail(3), arm.qd;
      Vector given(6);  // accelerations of the first joint
      given << base.R.transpose() * base.acceleration.head(3), base.acceleration.tail(3);

      const auto x = dense::state(arm.chain, arm.positions, arm.qd, base);
      const auto y = dense::state(longer.chain, longer.positions, longer.qd);
      CHECK(x.tip.R == y.tip.R);
      CHECK(x.tip.p == y.tip.p);
      CHECK(x.tip.tip_velocity == y.tip.tip_velocity);
      CHECK(Matrix(x.tip.J) == Matrix(y.tip.J.rightCols(m)));
      CHECK(Vector(x.tip.Jdot_qd) == Vector(y.tip.Jdot_qd + y.tip.J.leftCols(6) * given));
      CHECK(x.joint.M == Matrix(y.joint.M.bottomRightCorner(m, m)));
      CHECK(x.joint.C == Vector(y.joint.C.tail(m) + y.joint.M.bottomLeftCorner(m, 6) * given));
      CHECK(x.joint.G == Vector(y.joint.G.tail(m)));
    }
}

TEST_CASE("a base at rest elsewhere is a base at rest with all vectors turned") {
  const ExactArm arm = exact_arm_of(2, {revolute, cylindrical, spherical});
  Random random(9);
  BaseMotion<Q> base;
  base.R = random.exact_rotation();
  base.p = random.fraction3(4, 2);
  ExactArm turned = arm;
  turned.chain.gravity = base.R.transpose() * arm.chain.gravity;
  const auto x = dense::state(arm.chain, arm.positions, arm.qd, base);
  const auto y = dense::state(turned.chain, turned.positions, turned.qd);
  CHECK(x.joint.M == y.joint.M);
  CHECK(x.joint.C == y.joint.C);
  CHECK(x.joint.G == y.joint.G);
  CHECK(x.tip.p == Vector3<Q>(base.p + base.R * y.tip.p));
  CHECK(Vector3<Q>(x.tip.Jdot_qd.tail(3)) == Vector3<Q>(base.R * y.tip.Jdot_qd.tail(3)));
}

}  // namespace osculate::testing::multi_dof_tests
