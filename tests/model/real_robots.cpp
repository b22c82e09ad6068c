// Robot descriptions from elsewhere, where they are at hand: none of them is part of the project.
#include <cmath>
#include <filesystem>

#include "urdf_text.hpp"

namespace osculate::testing::real_robots_tests {

TEST_CASE("real robot descriptions load with the known number of joints and mass") {
  const std::filesystem::path folder = std::string(OSCULATE_SOURCE_DIR) + "/../shared/robots";
  if (!std::filesystem::exists(folder)) {
    WARN("no folder of real robot descriptions here: nothing was tried");
    return;
  }
  struct Row {
    std::string file, base, tip;
    int n;
    double mass, side_fixed, side_movable;  // kg, to a gram
  };
  const std::vector<Row> rows = {
      {"ur5e.urdf", "base_link", "tool0", 6, 16.994, 0, 0},
      {"panda.urdf", "panda_link0", "panda_hand_tcp", 7, 16.792, 0, 0.03},
      {"iiwa14.urdf", "base", "iiwa_link_ee", 7, 25.61, 0, 0},
      {"jaco2_7dof.urdf", "world", "j2s7s300_end_effector", 7, 5.029, 0, 0.06},
      {"irb120.urdf", "base_link", "tool0", 6, 11.931, 0, 0},
      {"tx90.urdf", "base_link", "tool0", 6, 42.563, 0, 0},
      {"sia10d.urdf", "world", "link_t", 7, 32.886, 0, 0},
      {"kr5_arc.urdf", "base_link", "tool0", 6, 17.257, 0, 0},
      {"baxter.urdf", "torso", "left_hand", 7, 19.711, 0.001, 0},
      {"qarm.urdf", "world", "END-EFFECTOR", 4, 1.863, 0, 0},
  };
  for (const auto& row : rows) {
    INFO(row.file);
    ChainChoice choice;
    choice.base = row.base;
    choice.tip = row.tip;
    const auto arm = load_urdf(folder / row.file, choice);
    CHECK(arm.chain.n() == row.n);
    double total = 0, side_fixed = 0, side_movable = 0;
    for (const auto& l : arm.chain.links) total += l.mass;
    for (const auto& l : arm.lumped) {
      side_fixed += l.why == LumpedLink::Why::side_fixed ? l.mass : 0;
      side_movable += l.why == LumpedLink::Why::side_movable ? l.mass : 0;
    }
    constexpr double half_gram = 0.5e-3 * (1 + 1e-9);
    CHECK(std::abs(side_fixed - row.side_fixed) <= half_gram);
    CHECK(std::abs(side_movable - row.side_movable) <= half_gram);
    CHECK(std::abs(total - side_fixed - side_movable - row.mass) <= half_gram);

    choice.side_branches = SideBranches::drop;
    double dropped = 0;
    for (const auto& l : load_urdf(folder / row.file, choice).chain.links) dropped += l.mass;
    CHECK(std::abs(dropped - row.mass) <= half_gram);
    CHECK(list_urdf(folder / row.file).size() > 2u * static_cast<unsigned>(row.n));
  }
}

}  // namespace osculate::testing::real_robots_tests
