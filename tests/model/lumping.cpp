// Lumping conserves mass, centre of mass and inertia; joint frames and axes come out as URDF defines them.
#include "model/lumping.hpp"

#include <cstdio>
#include <random>

#include "chain_kinematics.hpp"
#include "input/number_text.hpp"
#include "scalar/eps.hpp"
#include "urdf_text.hpp"

namespace osculate::testing::lumping_tests {
using namespace textbook;
using namespace urdf_text;

namespace {

/// A link of a random tree and the joint that carries it, as its numbers stand in the file.
struct RawLink {
  std::string name;
  int parent = -1;
  std::string type = "fixed";
  Vector3d xyz, rpy, axis;
  double mass;
  Vector3d com, com_rpy, principal;
};

class RandomTree {
 public:
  explicit RandomTree(unsigned seed) : generator_(seed) {
    const std::vector<std::string> chain = {"fixed", "revolute", "fixed",    "prismatic", "continuous",
                                            "fixed", "fixed",    "revolute", "revolute",  "fixed"};
    add("base", -1, "fixed");
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const int inboard = i == 0 ? 0 : last_on_chain;
      last_on_chain = add("c" + std::to_string(i), inboard, chain[i]);
      on_chain.push_back(last_on_chain);
    }
    const std::vector<std::string> side = {"fixed",    "fixed",  "revolute", "fixed", "prismatic",
                                           "floating", "planar", "fixed",    "fixed", "revolute"};
    for (std::size_t i = 0; i < side.size(); ++i)
      add("s" + std::to_string(i), static_cast<int>(generator_() % links.size()), side[i]);
  }

  std::string text() const {
    std::string all;
    for (std::size_t i = 0; i < links.size(); ++i) {
      const auto& l = links[i];
      all += a_link(l.name, "<inertial><origin xyz=\"" + triple(l.com) + "\" rpy=\"" + triple(l.com_rpy) +
                                "\"/><mass value=\"" + number(l.mass) + "\"/><inertia ixx=\"" +
                                number(l.principal[0]) + "\" iyy=\"" + number(l.principal[1]) + "\" izz=\"" +
                                number(l.principal[2]) + "\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>");
      if (l.parent >= 0)
        all += a_joint("j" + std::to_string(i), links[l.parent].name, l.name, l.type,
                       "<origin xyz=\"" + triple(l.xyz) + "\" rpy=\"" + triple(l.rpy) + "\"/><axis xyz=\"" +
                           triple(l.axis) + "\"/>" + limit);
    }
    return robot(all);
  }

  std::vector<RawLink> links;
  std::vector<int> on_chain;  // base to tip, without the base
  int last_on_chain = 0;

 private:
  Vector3d vector() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(generator_); }
  int add(const std::string& name, int parent, const std::string& type) {
    const Vector3d spread(uniform(0.01, 1), uniform(0.01, 1), uniform(0.01, 1));
    links.push_back({name, parent, type, vector(), 3 * vector(), vector(), uniform(0.1, 2), vector(),
                     3 * vector(),
                     Vector3d(spread[1] + spread[2], spread[2] + spread[0], spread[0] + spread[1])});
    return static_cast<int>(links.size()) - 1;
  }
  std::mt19937 generator_;
};

/// Mass, first moment and inertia about the origin of the base, base axes; `scale` sums the size of what was
/// added.
struct Moments {
  double mass = 0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  double first_scale = 0, second_scale = 0;

  void add(double m, const Vector3d& com, const Matrix3d& I) {
    const Matrix3d own = m * (com.squaredNorm() * Matrix3d::Identity() - com * com.transpose());
    mass += m;
    first += m * com;
    second += I + own;
    first_scale += m * com.norm();
    second_scale += I.norm() + own.norm();
  }
};

/// The plain walk over the numbers of the file, chain joints at q and all others at zero.
Moments walk(const RandomTree& tree, const VectorXd& q, bool with_sides) {
  Moments sum;
  std::vector<Matrix4d> pose(tree.links.size(), Matrix4d::Identity());
  std::vector<bool> moving(tree.links.size(), false);
  int joint = 0;
  for (std::size_t i = 1; i < tree.links.size(); ++i) {
    const auto& l = tree.links[i];
    const bool on_chain = l.name[0] == 'c';
    pose[i] = pose[l.parent] * transform(from_rpy(l.rpy), l.xyz);
    moving[i] = moving[l.parent];
    if (on_chain && l.type != "fixed") {
      const double x = q[joint++];
      pose[i] = pose[i] * (l.type == "prismatic" ? transform(Matrix3d::Identity(), x * l.axis.normalized())
                                                 : transform(turn(x, l.axis.normalized()), Vector3d::Zero()));
      moving[i] = true;
    }
    if (!moving[i] || !(on_chain || with_sides)) continue;
    const Matrix3d R = pose[i].topLeftCorner<3, 3>();
    const Matrix3d R_inertial = R * from_rpy(l.com_rpy);
    sum.add(l.mass, R * l.com + pose[i].topRightCorner<3, 1>(),
            R_inertial * l.principal.asDiagonal() * R_inertial.transpose());
  }
  return sum;
}

Moments of_chain(const Chain<double>& chain, const VectorXd& q) {
  Moments sum;
  const auto T = poses(chain, q);
  for (int k = 0; k < chain.n(); ++k) {
    const auto& l = chain.links[k];
    const Matrix3d R = T[k].topLeftCorner<3, 3>();
    sum.add(l.mass, R * l.com + T[k].topRightCorner<3, 1>(), R * l.inertia * R.transpose());
  }
  return sum;
}

}  // namespace

TEST_CASE("lumping conserves mass, centre of mass and inertia of random trees, at zero and elsewhere") {
  // Each of at most 20 levels multiplies two transforms (error about 10 eps of the lengths involved), on both
  // sides.
  constexpr double tol = 400 * eps;
  double worst = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const RandomTree tree(seed);
    const auto side = seed % 4 == 0 ? SideBranches::drop : SideBranches::lump;
    const auto arm = load(tree.text(), tree.links[tree.last_on_chain].name, "base", side);
    REQUIRE(arm.chain.n() == 5);
    VectorXd q = VectorXd::Zero(5);
    if (seed % 2 == 0) q << 0.3, -0.4, 2.0, -1.1, 0.7;
    const auto raw = walk(tree, q, side == SideBranches::lump);
    const auto lumped = of_chain(arm.chain, q);
    INFO("seed " << seed);
    const double mass_error = std::abs(lumped.mass - raw.mass) / raw.mass;
    const double first_error = (lumped.first - raw.first).norm() / raw.first_scale;
    const double second_error = (lumped.second - raw.second).norm() / raw.second_scale;
    CHECK(mass_error <= tol);
    CHECK(first_error <= tol);
    CHECK(second_error <= tol);
    worst = std::max({worst, mass_error, first_error, second_error});

    double reported = 0;
    for (const auto& l : arm.lumped)
      if (l.why != LumpedLink::Why::to_base && l.why != LumpedLink::Why::dropped) reported += l.mass;
    double own = 0;
    for (const auto& j : arm.joints)
      for (const auto& l : tree.links) own += l.name == j.link ? l.mass : 0;
    CHECK(std::abs(own + reported - raw.mass) <= tol * raw.mass);
  }
  std::printf("lumping: worst relative error %.1f eps\n", worst / eps);
}

TEST_CASE("tip and joint frames of random trees are those of the file") {
  constexpr double tol = 50 * eps;  // as above, relative to 20 m, more than any of these trees is long
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const RandomTree tree(seed);
    const auto arm = load(tree.text(), tree.links[tree.last_on_chain].name);
    Matrix4d at = Matrix4d::Identity();
    const VectorXd zero = VectorXd::Zero(5);
    const auto T = poses(arm.chain, zero);
    int joint = 0;
    for (const int i : tree.on_chain) {
      const auto& l = tree.links[i];
      at = at * transform(from_rpy(l.rpy), l.xyz);
      if (l.type == "fixed") continue;
      INFO("seed " << seed << ", link " << l.name);
      CHECK(arm.joints[joint].link == l.name);
      CHECK((T[joint] - at).cwiseAbs().maxCoeff() <= tol * 20);
      CHECK((arm.chain.links[joint].axis - l.axis.normalized()).norm() <= 4 * eps);
      ++joint;
    }
    CHECK((T.back() - at).cwiseAbs().maxCoeff() <= tol * 20);
  }
}

TEST_CASE("every link that does not move by itself is reported once, with the reason") {
  const auto text =
      robot(a_link("root", ball) + a_link("base", ball) + a_link("stand", ball) + a_link("cable", ball) +
            a_link("one", ball) + a_link("plate", ball) + a_link("tool", ball) + a_link("finger", ball) +
            a_link("nail", ball) + a_link("sensor", ball) + a_joint("j0", "root", "base") +
            a_joint("fs", "base", "stand", "fixed") + a_joint("jc", "base", "cable") +
            a_joint("j1", "stand", "one") + a_joint("fp", "one", "plate", "fixed") +
            a_joint("ft", "plate", "tool", "fixed") + a_joint("jf", "tool", "finger", "prismatic") +
            a_joint("fn", "finger", "nail", "fixed") + a_joint("fq", "one", "sensor", "fixed"));
  using Why = LumpedLink::Why;
  struct Row {
    std::string link, into;
    Why why;
  };
  const auto check = [](const ArmDescription& arm, const std::vector<Row>& rows) {
    REQUIRE(arm.lumped.size() == rows.size());
    for (const auto& row : rows) {
      INFO(row.link);
      int found = 0;
      for (const auto& l : arm.lumped)
        if (l.link == row.link && l.into == row.into && l.why == row.why && l.mass == 1) ++found;
      CHECK(found == 1);
    }
  };
  const auto lumped = load(text, "tool", "base");
  check(lumped, {{"stand", "base", Why::to_base},
                 {"cable", "base", Why::to_base},
                 {"plate", "one", Why::fixed_on_chain},
                 {"tool", "one", Why::fixed_on_chain},
                 {"sensor", "one", Why::side_fixed},
                 {"finger", "one", Why::side_movable},
                 {"nail", "one", Why::side_movable}});
  CHECK(lumped.chain.links[0].mass == 6);
  CHECK(lumped.warnings ==
        std::vector<std::string>{"arm.urdf: joint 'jf' is not on the chain: frozen at zero, link "
                                 "'finger' (1 kg) is lumped into link 'one'."});
  const auto dropped = load(text, "tool", "base", SideBranches::drop);
  check(dropped, {{"stand", "base", Why::to_base},
                  {"cable", "base", Why::dropped},
                  {"plate", "one", Why::fixed_on_chain},
                  {"tool", "one", Why::fixed_on_chain},
                  {"sensor", "one", Why::dropped},
                  {"finger", "one", Why::dropped},
                  {"nail", "one", Why::dropped}});
  CHECK(dropped.chain.links[0].mass == 3);
  CHECK(dropped.warnings.empty());
  CHECK(load(text, "tool").chain.n() == 2);  // from the root
}

TEST_CASE("floating, planar and mimicking joints off the chain are frozen like others") {
  const auto arm =
      load(robot(a_link("base", "") + a_link("two") + a_link("a") + a_link("b") + a_link("c") +
                 a_joint("j", "base", "two") + a_joint("f", "two", "a", "floating", "") +
                 a_joint("p", "two", "b", "planar") +
                 a_joint("m", "two", "c", "revolute", "<mimic joint=\"j\" multiplier=\"2\"/>" + limit)));
  CHECK(arm.chain.links[0].mass == 4);
  CHECK(arm.warnings.size() == 3);
}

TEST_CASE("odd inertias of links that never move are nobody's concern") {
  const auto disc = inertial("1", 0.01, 0.01, 0.05);
  const auto arm = load(robot(a_link("base", disc) + a_link("stand", disc) + a_link("two") +
                              a_joint("f", "base", "stand", "fixed") + a_joint("j", "stand", "two")));
  CHECK(arm.warnings.empty());
  CHECK(arm.chain.links[0].mass == 1);
}

TEST_CASE("axes are normalised whatever their length, and only odd lengths are mentioned") {
  const auto axis_of = [](const std::string& xyz) {
    return load(two_links(ball, "<axis xyz=\"" + xyz + "\"/>" + limit));
  };
  CHECK(axis_of("0 0 -1").chain.links[1].axis == Vector3d(0, 0, -1));
  CHECK(axis_of("0 2 0").chain.links[1].axis == Vector3d(0, 1, 0));
  CHECK(axis_of("0 2 0").warnings.size() == 1);
  for (const auto* xyz : {"3e200 4e200 0", "3e-200 4e-200 0", "0.6 0.8 0"}) {
    INFO(xyz);
    CHECK((axis_of(xyz).chain.links[1].axis - Vector3d(0.6, 0.8, 0)).norm() <= 4 * eps);
  }
  CHECK(axis_of("0.6 0.8 0").warnings.empty());
  CHECK(load(two_links(ball, limit)).chain.links[1].axis == Vector3d(1, 0, 0));  // the default of URDF
}

TEST_CASE("two bodies as in a textbook") {
  // Point masses 1 and 3 kg, 4 m apart on x: centre at 3 m, moment 1*9 + 3*1 = 12 kg m^2 about y and z.
  const internal::RigidBody body =
      internal::lump({{1, {0, 0, 0}, Matrix3d::Zero()}, {3, {4, 0, 0}, Matrix3d::Zero()}});
  CHECK(body.mass == 4);
  CHECK(body.com == Vector3d(3, 0, 0));
  CHECK(body.inertia == Matrix3d(Vector3d(0, 12, 12).asDiagonal()));
}

TEST_CASE("numbers as text do not lose digits and rounded ones keep six") {
  CHECK(number_text(0.1) == "0.1");
  CHECK(number_text(1.0 / 3) == "0.3333333333333333");
  CHECK(internal::short_number(1.0 / 3) == "0.333333");
}

}  // namespace osculate::testing::lumping_tests
