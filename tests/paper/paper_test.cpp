// The paper's table: exact where it must be exact, wrong where the print is wrong, and able to fail.
#include <cmath>
#include <filesystem>
#include <limits>

#include "model/urdf.hpp"
#include "paper/bounds.hpp"
#include "paper/tables.hpp"
#include "support/catch.hpp"

using namespace osculate;

namespace {

ArmDescription shipped(const std::string& name, const std::string& tip) {
  ChainChoice choice;
  choice.tip = tip;
  return load_urdf(std::filesystem::path(OSCULATE_SOURCE_DIR) / "models" / (name + ".urdf"), choice);
}

}  // namespace

TEST_CASE("over exact fractions every identity and every recursion holds, and every printed error shows") {
  const paper::Proof proof = paper::prove(1, 6, 20, 2);
  CHECK(proof.arms == 6 * 20 + 2 * static_cast<int>(paper::mixed_kinds().size()));
  for (const auto& row : proof.statements) {
    INFO(row.about.equation << " " << row.about.statement);
    // Two statements ask for a full rank, or for as many task rows as coordinates.
    CHECK(row.judged >= 20);
    CHECK(row.nonzero == 0);
  }
  REQUIRE(proof.printed.size() == 4);
  for (const auto& row : proof.printed) {
    INFO(row.about.equation << " " << row.about.statement);
    // phi = phi* = 1 for one link: the text after (40) is right there.
    CHECK(row.nonzero >= proof.arms - 20);
  }
}

TEST_CASE("on the shipped arms every statement stays within its bound") {
  for (const auto& [name, tip] : {std::pair{"puma560", "tool0"},
                                  {"prismatic_arm", "tool0"},
                                  {"planar_2r", "tip"},
                                  {"mobile_arm", "tool0"},
                                  {"satellite_arm", "tool0"}}) {
    for (const auto& row : paper::check(shipped(name, tip).chain, 10, 500)) {
      INFO(name << ": " << row.about.equation << " " << row.about.statement);
      CHECK(row.worst <= row.bound);
    }
  }
}

TEST_CASE("a residual ten times its bound fails, and every bound is one of the measured constants") {
  const double eps = std::numeric_limits<double>::epsilon();
  for (std::size_t i = 0; i < paper::statements().size(); ++i) {
    const auto& bound = paper::paper_bounds[i];
    INFO(paper::statements()[i].equation << " " << paper::statements()[i].statement);
    CHECK(bound.constant <= 5 * std::max(bound.worst, 1.0));
    paper::Row row{paper::statements()[i], 10 * bound.constant * eps, bound.constant * eps, 1};
    CHECK(!row.pass());
  }
}

TEST_CASE("the measured constants are not loose: a sample comes within a factor 5 of most of them") {
  // Not of each: a worst case of many thousand states need not show in three hundred.
  const auto arm = shipped("puma560", "tool0");
  const auto rows = paper::check(arm.chain, 100, 1);
  int near = 0;
  for (const auto& row : rows)
    near += row.bound > 0 && row.worst * 20 >= row.bound;  // bound = 4 times the worst seen
  CHECK(near * 3 >= static_cast<int>(rows.size()));
}

TEST_CASE("a residual that is not a number is within no bound") {
  Chain<double> chain = shipped("planar_2r", "tip").chain;
  chain.links[0].mass = std::nan("");
  int failed = 0;
  for (const auto& row : paper::check(chain, 1)) failed += row.judged > 0 && !row.pass();
  CHECK(failed > 20);
}
