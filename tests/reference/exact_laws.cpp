// Laws of mechanics that the dense formulation must obey, on random arms over exact fractions: no tolerances.
// Kinematics is written here a second time, as products of 4 x 4 matrices, and differentiated by dual
// numbers.
#include "model/random_arm.hpp"
#include "reference/exact.hpp"
#include "support/catch.hpp"

namespace osculate::testing::exact_laws_tests {
using Q = Rational;
using D = Dual<Q>;
using Vector = VectorX<Q>;
using Matrix = MatrixX<Q>;

namespace {

template <Field N>
using Matrix4 = Eigen::Matrix<N, 4, 4>;

template <Field N>
Matrix4<N> homogeneous(const Matrix3<N>& R, const Vector3<N>& p) {
  Matrix4<N> out = Matrix4<N>::Identity();
  out.template topLeftCorner<3, 3>() = R;
  out.template topRightCorner<3, 1>() = p;
  return out;
}

/// Poses of all links and, last, of the tip in the base frame.
template <Field N>
std::vector<Matrix4<N>> poses(const Chain<Q>& chain, const std::vector<JointPosition<N>>& q) {
  const Chain<N> numbers = cast<N>(chain);
  std::vector<Matrix4<N>> out;
  Matrix4<N> A = Matrix4<N>::Identity();
  for (std::size_t i = 0; i < numbers.links.size(); ++i) {
    const Link<N>& link = numbers.links[i];
    A = A * homogeneous<N>(link.R_origin, link.p_origin);
    if (one_axis(link.type))
      A = A * homogeneous<N>(rotation<N>(link.axis, q[i].c, q[i].s), link.axis * q[i].d);
    else
      A = A * homogeneous<N>(q[i].R, q[i].p);
    out.push_back(A);
  }
  out.push_back(A * homogeneous<N>(numbers.R_tip, numbers.p_tip));
  return out;
}

/// Whether the last pivot of L D L^T is 0; one before it throws.
bool singular(const Matrix& A) { return dense::factor(A).D[A.rows() - 1] == Q(0); }

Vector3<Q> vee(const Matrix3<Q>& A) { return {A(2, 1), A(0, 2), A(1, 0)}; }

/// Kinetic energy from the motion of the bodies: sum of 1/2 m |r'|^2 + 1/2 w . I w, and the motors.
Q kinetic_energy_of_bodies(const ExactArm& arm, const Vector& qd) {
  const auto A = poses<D>(arm.chain, dense::moving(arm.chain, arm.positions, qd));
  Q twice(0);
  int first = 0;  // of the joint's rates
  for (std::size_t i = 0; i < arm.chain.links.size(); ++i) {
    const Link<Q>& link = arm.chain.links[i];
    const Matrix3<Q> R = values(A[i].topLeftCorner<3, 3>());
    const Matrix3<Q> Rd = derivatives(A[i].topLeftCorner<3, 3>());
    const Vector3<Q> pd = derivatives(A[i].topRightCorner<3, 1>());
    const Vector3<Q> v = pd + Rd * link.com;
    const Vector3<Q> w_link = vee(R.transpose() * Rd);
    const Q rate = qd[first];
    first += velocity_count(link.type);
    twice += link.mass * v.dot(v) + w_link.dot(link.inertia * w_link) + link.armature * rate * rate;
  }
  return twice / Q(2);
}

Vector unit(int n, int i) { return Vector::Unit(n, i); }

/// M and its derivative when the joints move at `rates`.
Eigen::Matrix<D, Eigen::Dynamic, Eigen::Dynamic> moving_M(const ExactArm& arm, const Vector& rates) {
  const VectorX<D> rest = VectorX<D>::Zero(arm.chain.velocities());
  return dense::joint_space<D>(cast<D>(arm.chain), dense::moving(arm.chain, arm.positions, rates), rest).M;
}

struct Case {
  ExactArm arm;
  int n;  // velocities
  dense::State<Q> x;
};

Case case_of(const ExactArm& arm) {
  return {arm, arm.chain.velocities(), dense::state(arm.chain, arm.positions, arm.qd)};
}

template <class Check>
void for_arms(int n_from, int n_to, unsigned seeds, Check check) {
  for (int n = n_from; n <= n_to; ++n)
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      INFO("n = " << n << ", seed = " << seed);
      check(case_of(exact_arm(seed, n)));
    }
}

/// Arms with joints of several axes; `rates`: only such whose qd is the derivative of q.
template <class Check>
void for_chains(bool rates, Check check) {
  using enum JointType;
  std::vector<std::vector<JointType>> chains = {
      {cylindrical, revolute}, {universal, planar}, {planar, prismatic, universal}};
  if (!rates) {
    chains.push_back({revolute, spherical, revolute});
    chains.push_back({prismatic, floating});
    chains.push_back({floating, universal, spherical});
  }
  unsigned seed = 1;
  for (const auto& types : chains) {
    const ExactArm arm = exact_arm_of(++seed, types);
    INFO("exact_arm_of(" << seed << "), " << letters(arm.chain));
    check(case_of(arm));
  }
}

}  // namespace

TEST_CASE("tip pose, J qd and Jdot qd are the pose and its first two derivatives") {
  const auto check = [](const Case& c) {
    using DD = Dual<D>;
    const auto moved = dense::moving(c.arm.chain, c.arm.positions, c.arm.qd);
    const VectorX<D> steady = c.arm.qd.cast<D>();
    const std::vector<JointPosition<DD>> twice = dense::moving<D>(cast<D>(c.arm.chain), moved, steady);
    // The 4 x 4 chain over DD: value, first derivative (twice) and second derivative along the motion.
    const auto A = poses<DD>(c.arm.chain, twice).back();
    const Matrix4<Q> T = values(values(A)), Td = derivatives(values(A)), Tdd = derivatives(derivatives(A));
    const Matrix3<Q> R = T.topLeftCorner<3, 3>();
    const Matrix3<Q> Rd = Td.topLeftCorner<3, 3>(), Rdd = Tdd.topLeftCorner<3, 3>();
    CHECK(c.x.tip.R == R);
    CHECK(c.x.tip.p == Vector3<Q>(T.topRightCorner<3, 1>()));
    dense::Vector6<Q> velocity, acceleration;
    // R' R^T = w~ and R'' R^T = w'~ + w~ w~, whose second term is symmetric.
    const Matrix3<Q> turning = Rdd * R.transpose();
    velocity << vee(Rd * R.transpose()), Vector3<Q>(Td.topRightCorner<3, 1>());
    acceleration << vee((turning - turning.transpose()) / Q(2)), Vector3<Q>(Tdd.topRightCorner<3, 1>());
    CHECK(c.x.tip.tip_velocity == velocity);
    CHECK(Vector(c.x.tip.J * c.arm.qd) == Vector(velocity));
    CHECK(c.x.tip.Jdot_qd == acceleration);
  };
  for_arms(1, 6, 3, check);
  for_chains(false, check);
}

TEST_CASE("M is the matrix of the kinetic energy") {
  const auto check = [](const Case& c) {
    CHECK(dense::kinetic_energy(c.x.joint, c.arm.qd) == kinetic_energy_of_bodies(c.arm, c.arm.qd));
    for (int i = 0; i < c.n; ++i)
      for (int j = 0; j <= i; ++j) {
        const Q both = kinetic_energy_of_bodies(c.arm, unit(c.n, i) + unit(c.n, j));
        const Q mixed = both - kinetic_energy_of_bodies(c.arm, unit(c.n, i)) -
                        kinetic_energy_of_bodies(c.arm, unit(c.n, j));
        CHECK(c.x.joint.M(i, j) == mixed);
        CHECK(c.x.joint.M(j, i) == mixed);
      }
  };
  for_arms(1, 6, 2, check);
  for_chains(false, check);
}

TEST_CASE("G is the gradient of the potential energy") {
  const auto check = [](const Case& c) {
    const auto A = poses<Q>(c.arm.chain, c.arm.positions);
    Q U(0);
    for (std::size_t i = 0; i < c.arm.chain.links.size(); ++i) {
      const Link<Q>& link = c.arm.chain.links[i];
      const Vector3<Q> r = A[i].topLeftCorner<3, 3>() * link.com + A[i].topRightCorner<3, 1>();
      U -= link.mass * c.arm.chain.gravity.dot(r);
    }
    CHECK(dense::potential_energy(c.arm.chain, c.arm.positions) == U);
    for (int k = 0; k < c.n; ++k) {
      const auto moved = dense::moving(c.arm.chain, c.arm.positions, unit(c.n, k));
      CHECK(dense::potential_energy(c.arm.chain, moved).derivative == c.x.joint.G[k]);
    }
  };
  for_arms(1, 6, 3, check);
  for_chains(false, check);
}

TEST_CASE("C of Newton-Euler is C of Lagrange") {
  // C_i = sum_jk (dM_ij/dq_k - 1/2 dM_jk/dq_i) qd_j qd_k
  const auto check = [](const Case& c) {
    std::vector<Matrix> dM;
    for (int k = 0; k < c.n; ++k) {
      const auto moved = moving_M(c.arm, unit(c.n, k));
      CHECK(Matrix(values(moved)) == c.x.joint.M);
      dM.push_back(derivatives(moved));
    }
    Vector C = Vector::Zero(c.n);
    for (int k = 0; k < c.n; ++k) {
      const std::size_t K = static_cast<std::size_t>(k);
      C += dM[K] * c.arm.qd * c.arm.qd[k];
      C[k] -= c.arm.qd.dot(dM[K] * c.arm.qd) / Q(2);
    }
    CHECK(c.x.joint.C == C);
  };
  for_arms(1, 6, 3, check);
  for_chains(true, check);
}

TEST_CASE("an arm without torque and gravity keeps its kinetic energy") {
  const auto check = [](const Case& c) {
    dense::JointSpace<Q> joint = c.x.joint;
    joint.G.setZero();
    const Vector qdd = dense::forward_dynamics(joint, c.x.tip.J, Vector(Vector::Zero(c.n)));
    const Matrix Mdot = derivatives(moving_M(c.arm, c.arm.qd));
    const Q by_acceleration = c.arm.qd.dot(joint.M * qdd);
    const Q by_position = c.arm.qd.dot(Mdot * c.arm.qd) / Q(2);
    CHECK(by_acceleration + by_position == Q(0));
    // The same as: Mdot - 2 C is skew, so C does the work that the change of M asks for.
    CHECK(c.arm.qd.dot(joint.C) == by_position);
  };
  for_arms(1, 6, 3, check);
  for_chains(false, check);
}

TEST_CASE("forward dynamics leaves no residual in the equation of motion") {
  const auto check = [](const Case& c) {
    osculate::Random random(7);
    Vector T(c.n);
    for (Q& t : T) t = random.fraction(9, 4);
    dense::Vector6<Q> F_ext;
    for (Q& f : F_ext) f = random.fraction(9, 4);
    const Vector qdd = dense::forward_dynamics(c.x.joint, c.x.tip.J, T, F_ext);
    CHECK(Vector(c.x.joint.M * qdd + c.x.joint.C + c.x.joint.G) == Vector(T + c.x.tip.J.transpose() * F_ext));
    // Power balance: what the torques and the outer force do is the change of kinetic and potential energy.
    const Matrix Mdot = derivatives(moving_M(c.arm, c.arm.qd));
    const auto moved = dense::moving(c.arm.chain, c.arm.positions, c.arm.qd);
    const Q gained = c.arm.qd.dot(c.x.joint.M * qdd) + c.arm.qd.dot(Mdot * c.arm.qd) / Q(2) +
                     dense::potential_energy(c.arm.chain, moved).derivative;
    CHECK(gained == c.arm.qd.dot(T) + c.x.tip.tip_velocity.dot(F_ext));
  };
  for_arms(1, 6, 3, check);
  for_chains(false, check);
}

TEST_CASE("six links: Lambda, c and g satisfy their definitions, and the law (2) for any tip force") {
  for_arms(6, 6, 6, [](const Case& c) {
    const auto task = dense::mobility(c.x.tip, c.x.joint);
    if (singular(task.Omega)) FAIL("this seed gives a singular arm; choose another");
    const auto terms = dense::task_terms(task);
    const Matrix J = c.x.tip.J;
    CHECK(task.Omega == Matrix(task.Omega.transpose()));
    CHECK(Matrix(terms.Lambda * task.Omega) == Matrix(Matrix::Identity(6, 6)));
    // n = 6 and J regular: Lambda = J^-T M J^-1, c = J^-T C - Lambda Jdot qd, g = J^-T G, free of M^-1.
    CHECK(Matrix(J.transpose() * terms.Lambda * J) == c.x.joint.M);
    CHECK(Vector(J.transpose() * (terms.c + terms.Lambda * c.x.tip.Jdot_qd)) == c.x.joint.C);
    CHECK(Vector(J.transpose() * terms.g) == c.x.joint.G);

    osculate::Random random(11);
    Vector F(6), u(6);
    for (Q& f : F) f = random.fraction(9, 4);
    for (Q& a : u) a = random.fraction(9, 4);
    const Vector qdd = dense::forward_dynamics(c.x.joint, c.x.tip.J, Vector(J.transpose() * F));
    CHECK(Vector(terms.Lambda * (J * qdd + c.x.tip.Jdot_qd) + terms.c + terms.g) == F);  // (2)
    const auto command = dense::task_force(task, terms, u);
    const Vector closed = dense::forward_dynamics(c.x.joint, c.x.tip.J, command.T);
    CHECK(Vector(J * closed + c.x.tip.Jdot_qd) == u);  // (5)
  });
}

TEST_CASE("fewer rows: the restricted task obeys its own law, in any order of rows") {
  const std::vector<std::vector<int>> choices = {{3, 4, 5}, {5, 3}, {1}, {0, 4, 2}};
  for_arms(3, 7, 2, [&](const Case& c) {
    const auto whole = dense::mobility(c.x.tip, c.x.joint);
    for (const auto& rows : choices) {
      const auto task = dense::mobility(c.x.tip, c.x.joint, rows);
      const int m = static_cast<int>(rows.size());
      REQUIRE(task.Omega.rows() == m);
      CHECK(task.Omega == Matrix(whole.Omega(rows, rows)));
      CHECK(task.J_Minv_C == Vector(whole.J_Minv_C(rows)));
      CHECK(task.J_Minv_G == Vector(whole.J_Minv_G(rows)));
      if (singular(task.Omega)) FAIL("this seed gives a singular task; choose another");
      const auto terms = dense::task_terms(task);
      const Vector u = Vector::LinSpaced(m, Q(1), Q(m)) / Q(2);
      const auto command = dense::task_force(task, terms, u);
      CHECK(command.F == Vector(terms.Lambda * u + terms.c + terms.g));
      const Vector qdd = dense::forward_dynamics(c.x.joint, c.x.tip.J, command.T);
      CHECK(Vector(task.J * qdd + task.Jdot_qd) == u);
    }
  });
}

}  // namespace osculate::testing::exact_laws_tests
