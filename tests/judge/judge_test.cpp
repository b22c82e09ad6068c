#include "judge/judge.hpp"

#include <filesystem>
#include <fstream>

#include "judge/explanation.hpp"
#include "judge/wrong_law.hpp"
#include "support/catch.hpp"

using namespace osculate;
using Eigen::Index;

namespace {

JudgeOptions options_for(const JudgedArm& arm) {
  JudgeOptions out = judge_options(arm);
  out.samples = 200;
  return out;
}

/// Half the length of the confusion matrix's logs: ./dev judge has them all.
Judgement judged(const JudgedArm& arm, const Mistakes& made, LogChoice choice = {.seconds = 1}) {
  return judge(arm.chain, simulate(arm, made, choice), options_for(arm));
}

/// Joint 1 alone turns to and fro; the torque is that of a law with mistakes, u the tip's true acceleration.
Log one_joint_moves(const JudgedArm& arm, const Mistakes& made) {
  const Index N = 1000, n = static_cast<Index>(arm.q.size());
  Log log;
  log.source = "one joint";
  log.q.resize(N, n), log.qd.setZero(N, n), log.tau.resize(N, n);
  log.u = MatrixX<double>(N, 6);
  log.u_order = RowOrder::angular_first;
  for (Index k = 0; k < N; ++k) {
    const double t = 0.001 * static_cast<double>(k);
    std::vector<double> q = arm.q;
    q[0] += 0.5 * std::sin(6 * t);
    log.t.push_back(t);
    log.q.row(k) = Eigen::Map<VectorX<double>>(q.data(), n);
    log.qd(k, 0) = 3 * std::cos(6 * t);
    const VectorX<double> qd = log.qd.row(k);
    const auto tip = dense::state(arm.chain, positions(arm.chain, std::span<const double>(q)), qd, {}).tip;
    VectorX<double> qdd = VectorX<double>::Zero(n);
    qdd[0] = -18 * std::sin(6 * t);
    const Vector6 u = tip.J * qdd + tip.Jdot_qd;
    log.u->row(k) = u;
    Vector6 commanded;
    const TipReference reached{{tip.R, tip.p}, tip.tip_velocity, u};
    log.tau.row(k) = wrong_torque(arm, q, qd, reached, made, commanded);
  }
  return log;
}

}  // namespace

TEST_CASE("the right law is found right, with noise and without") {
  const JudgedArm arm = judged_arm("puma560");
  for (const double noise : {0.0, 1e-4, 1e-3}) {
    const Judgement found = judged(arm, {}, {.seconds = 1, .noise = noise});
    INFO(report(found, arm.name));
    CHECK(found.ruling == Ruling::right);
    CHECK(found.doubts.empty());
  }
}

TEST_CASE("a mistake is named with its size") {
  const JudgedArm arm = judged_arm("ur5e_like");
  for (const char* made :
       {"jdot_qd", "viscous", "armature", "uncoupled_lambda", "u_in_tip_frame", "swapped_rows"}) {
    // With u turned the loop is unstable: then the right law moves the arm.
    const bool stable = std::string(made) != "u_in_tip_frame" && std::string(made) != "swapped_rows";
    const Judgement found = judged(arm, {made}, {.seconds = 1, .in_charge = stable});
    INFO(made);
    CHECK(found.ruling == Ruling::wrong);
    CHECK(named(found) == Mistakes{made});
    REQUIRE(found.findings.size() == 1);
    CHECK(found.findings[0].explained > 0.99);
  }
  const Finding omitted = judged(arm, {"jdot_qd"}).findings.at(0);
  CHECK(std::abs(omitted.coefficients[0].value + 1) < 5 * omitted.coefficients[0].deviation + 1e-3);
  CHECK(omitted.sentence.find("omits J* Lambda Jdot qd (coefficient ") == 0);

  const Finding load = judged(arm, {"payload"}).findings.at(0);
  CHECK(load.term == "payload");
  CHECK(load.coefficients[0].value == Approx(-payload_of(arm)).epsilon(0.01));
  const Finding point = judged(arm, {"tip_point"}).findings.at(0);
  CHECK(point.term == "tip_point");
  for (int i = 0; i < 3; ++i)
    CHECK(point.coefficients[static_cast<std::size_t>(i)].value == Approx(wrong_tip[i]).margin(5e-4));
  const Finding late = judged(arm, {"delay"}).findings.at(0);
  CHECK(late.term == "delay");
  CHECK(late.coefficients[0].value == Approx(delay).margin(1e-4));
}

TEST_CASE("another gravity and a weak joint are named with their sizes, in a log that is right without") {
  const JudgedArm arm = judged_arm("puma560");
  CHECK(judged(arm, {}).ruling == Ruling::right);
  const Judgement pulled = judged(arm, {"gravity_vector"}), weak = judged(arm, {"torque_scale"});
  INFO(report(pulled, "gravity") << report(weak, "torques"));
  REQUIRE(named(pulled) == Mistakes{"gravity_vector"});
  for (int i = 0; i < 3; ++i) {
    const Coefficient& c = pulled.findings[0].coefficients[static_cast<std::size_t>(i)];
    CHECK(std::abs(c.value - wrong_gravity[i]) < 5 * c.deviation + 1e-3);
  }
  REQUIRE(named(weak) == Mistakes{"torque_scale"});
  for (std::size_t i = 0; i < 6; ++i) {
    const Coefficient& c = weak.findings[0].coefficients[i];
    CHECK(std::abs(c.value - (i == 1 ? weak_joint : 0)) < 5 * c.deviation + 1e-3);
  }
}

TEST_CASE("two mistakes are told apart, on a redundant arm too") {
  // ./dev judge tries all pairs of six terms on three arms.
  const std::vector<std::pair<const char*, Mistakes>> cases{{"puma560", {"jdot_qd", "coriolis"}},
                                                            {"puma560", {"gravity", "payload"}},
                                                            {"arm7", {"armature", "viscous"}}};
  for (const auto& [name, made] : cases) {
    INFO(name << ": " << *made.begin());
    CHECK(named(judged(judged_arm(name), made)) == made);
  }
  // What the null-space damping does is told, and is no mistake.
  const Judgement damped = judged(judged_arm("arm7"), {});
  CHECK(damped.ruling == Ruling::right);
  REQUIRE(damped.null_space.size() == 1);
  CHECK(damped.null_space[0].term == "damping");
  CHECK(damped.null_space[0].coefficients[0].value == Approx(5).epsilon(0.01));
}

TEST_CASE("from references in place of u: gains are found, and mistakes of the error") {
  const JudgedArm arm = judged_arm("puma560");
  const LogChoice choice{.seconds = 1, .with_reference = true};
  // The gains make the noise of q that of u: no mistake either.
  CHECK(judged(arm, {}, {.seconds = 1, .noise = 1e-3, .with_reference = true}).ruling == Ruling::right);
  const Judgement right = judged(arm, {}, choice);
  CHECK(right.ruling == Ruling::right);
  CHECK(right.conventions.at(0).find("e.. + D e. + K e = 0") != std::string::npos);
  REQUIRE(right.gains.size() == 4);
  for (const Coefficient& gain : right.gains) {
    const double truth = gain.name.starts_with("stiffness") ? stiffness : damping;
    INFO(gain.name << " " << gain.value << " +- " << gain.deviation);
    CHECK(gain.value == Approx(truth).epsilon(0.05));
  }
  JudgeOptions known = options_for(arm);
  known.gains = Gains{Vector6::Constant(stiffness), Vector6::Constant(damping)};
  const Log misread = simulate(arm, {"quaternion_reference"}, choice);
  CHECK(named(judge(arm.chain, misread, known)) == Mistakes{"quaternion_reference"});
  CHECK(named(judge(arm.chain, simulate(arm, {"feedforward"}, choice), known)) == Mistakes{"feedforward"});
}

TEST_CASE("damping of the angular velocity is as right as damping of the error's derivative") {
  JudgedArm arm = judged_arm("puma560");
  arm.error_law = ErrorLaw::angular_velocity;
  JudgeOptions known = options_for(arm);
  known.gains = Gains{Vector6::Constant(stiffness), Vector6::Constant(damping)};
  const Judgement found = judge(arm.chain, simulate(arm, {}, {.seconds = 1, .with_reference = true}), known);
  INFO(report(found, arm.name));
  CHECK(found.ruling == Ruling::right);
  CHECK(found.conventions.at(0).find("omega. = omega_ref. + D (omega_ref - omega)") != std::string::npos);
}

TEST_CASE("a gain that is found negative is a mistake") {
  const JudgedArm arm = judged_arm("puma560");
  // The loop would be unstable: the right law moves the arm, whose own log is judged right above.
  const Judgement found = judged(arm, {"gains"}, {.seconds = 1, .with_reference = true, .in_charge = false});
  INFO(report(found, arm.name));
  CHECK(found.ruling == Ruling::wrong);
  REQUIRE(named(found) == Mistakes{"gains"});
  CHECK(found.findings[0].coefficients.at(0).name == "damping, linear");
  CHECK(found.findings[0].coefficients[0].value == Approx(-damping).epsilon(0.05));
}

TEST_CASE("the order of u is recognised, or asked for") {
  const JudgedArm arm = judged_arm("puma560");
  Log log = simulate(arm, {"coriolis"}, {.seconds = 1});
  log.u_order.reset();
  const MatrixX<double> angular_first = *log.u;
  Judgement found = judge(arm.chain, log, options_for(arm));
  CHECK(named(found) == Mistakes{"coriolis"});
  REQUIRE(found.conventions.size() == 1);
  CHECK(found.conventions[0].find("angular rows first") != std::string::npos);

  log.u->leftCols(3) = angular_first.rightCols(3), log.u->rightCols(3) = angular_first.leftCols(3);
  found = judge(arm.chain, log, options_for(arm));
  CHECK(named(found) == Mistakes{"coriolis"});
  CHECK(found.conventions.at(0).find("linear rows first") != std::string::npos);

  log.u->setZero();  // nothing commanded: either order is as good
  CHECK_THROWS_WITH(judge(arm.chain, log, options_for(arm)), Catch::Contains("--u-order"));
}

TEST_CASE("where a log cannot tell two mistakes apart, it is said, with a motion that does") {
  const JudgedArm arm = judged_arm("puma560");
  // Joint 1 turns alone: Jdot qd is omega x v at the tip.
  const Judgement found = judge(arm.chain, one_joint_moves(arm, {"jdot_qd"}), options_for(arm));
  REQUIRE(!found.doubts.empty());
  Mistakes either = named(found);
  either.insert(found.doubts[0].terms.begin(), found.doubts[0].terms.end());
  CHECK(either == Mistakes{"jdot_qd", "spatial_acceleration"});
  INFO(found.doubts[0].sentence);
  CHECK(found.doubts[0].sentence.find("a log that decides: move") != std::string::npos);
  // And what the log does not show at all is said too.
  CHECK(judge(arm.chain, one_joint_moves(arm, {}), options_for(arm)).ruling == Ruling::right);
}

TEST_CASE("a torque that no candidate explains is called unexplained") {
  const JudgedArm arm = judged_arm("puma560");
  Log log = simulate(arm, {}, {.seconds = 1});
  for (Index k = 0; k < log.samples(); ++k)
    log.tau(k, 2) += 5 * std::sin(40 * log.t[static_cast<std::size_t>(k)]);
  CHECK(judge(arm.chain, log, options_for(arm)).ruling == Ruling::unexplained);
}

TEST_CASE("subsets of columns: dependent columns, sizes and deviations") {
  Regression r{MatrixX<double>(4, 3), VectorX<double>(4)};
  r.X << 1, 2, 0, 1, 2, 1, 1, 2, 0, 1, 2, 1;  // the second column is twice the first
  r.d << 3, 5, 3, 5;
  const Explanations all(r, {{0, 1}, {1, 1}, {2, 1}});
  const Fit whole = all.full();
  CHECK(whole.rss < 1e-20);
  CHECK(whole.beta[0] == Approx(3));
  CHECK(whole.beta[1] == 0);  // says nothing of its own
  CHECK(whole.beta[2] == Approx(2));
  CHECK(whole.deviation[0] == Approx(std::sqrt(0.5)));
  const auto found = all.search({}, 1e-3, 1e-6);
  REQUIRE(found.size() == 2);  // the first column or the second: nothing decides
  CHECK(found[0].groups.size() == 2);
}

TEST_CASE("logs that cannot be used are refused with place and remedy") {
  const JudgedArm arm = judged_arm("puma560");
  const auto file = std::filesystem::temp_directory_path() / "osculate_judge_test.csv";
  const std::vector<std::string> joints{"j1", "j2", "j3", "j4", "j5", "j6"};
  const auto reading = [&](const std::string& text) {
    std::ofstream(file) << text;
    return read_log(file, arm.chain, joints, 6);
  };
  const std::string header =
      "t,q1,q2,q3,q4,q5,q6,qd1,qd2,qd3,qd4,qd5,qd6,tau1,tau2,tau3,tau4,tau5,tau6,u_wx,u_wy,u_wz,u_vx,u_vy,u_"
      "vz\n";
  const std::string zeros = ",0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n";
  CHECK(reading(header + "0" + zeros + "0.1" + zeros).samples() == 2);
  CHECK_THROWS_WITH(reading(header + "0" + zeros + "0" + zeros), Catch::Contains("sample 2: t = 0.0"));
  CHECK_THROWS_WITH(reading(header + "0,1\n"), Catch::Contains("csv:2: has 2 fields under a header of 25"));
  CHECK_THROWS_WITH(reading("t,q1\n0,x\n"), Catch::Contains("csv:2: q1 = 'x': must be a number"));
  CHECK_THROWS_WITH(reading("t,q1\n0,1\n"),
                    Catch::Contains("has 1 columns of q, the arm from base to tip needs 6"));
  CHECK_THROWS_WITH(reading("q1\n0\n"), Catch::Contains("has no time"));
  std::filesystem::remove(file);
  CHECK_THROWS_WITH(
      reading(header.substr(0, header.find(",u_wx")) + "\n0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n"),
      Catch::Contains("Without either any torque could be right"));
  CHECK_THROWS_AS(judge(arm.chain, reading(header + "0" + zeros), {}), LogError);
  std::filesystem::remove(file);
}
