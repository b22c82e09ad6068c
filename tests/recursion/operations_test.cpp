// What the recursions cost, counted: exactly linear in n, the same in every state, no square root; and
// docs/operations.md says what is counted now.
#include "benchmarks/operations.hpp"

#include <fstream>
#include <iterator>

#include "support/catch.hpp"

using namespace osculate;
using namespace osculate::operations;

namespace {

/// The recursions with the joints they are counted on; resolved acceleration needs a square Jacobian.
struct Recursions {
  Counting counting;
  JointType type;
  int last;
};
const Recursions all_recursions[] = {
    {sweep_costs, JointType::revolute, longest},  {sweep_costs, JointType::prismatic, longest},
    {whole_costs, JointType::revolute, longest},  {whole_costs, JointType::prismatic, longest},
    {joint_costs, JointType::revolute, longest},  {joint_costs, JointType::prismatic, longest},
    {joint_costs, JointType::spherical, longest}, {resolved_costs, JointType::revolute, 6},
};

const Series& named(const std::vector<Series>& list, const std::string& name) {
  for (const Series& series : list)
    if (series.name == name) return series;
  throw std::runtime_error("nothing counted is called " + name);
}

std::string page() {
  std::ifstream file(OSCULATE_SOURCE_DIR "/docs/operations.md");
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

TEST_CASE("Every recursion is linear in n exactly, from one link on, and takes no square root") {
  for (const auto& [counting, type, last] : all_recursions)
    for (const Series& series : series_of(counting, type, 1, last)) {
      INFO(series.name);
      CHECK(linear_law(series.costs).has_value());
      CHECK(sum(series.costs[0]) > 0);
      for (const Tally& cost : series.costs) CHECK(cost.roots == 0);
    }
}

TEST_CASE("The law finds what is not linear") {
  const Tally one{1, 0, 0, 0, 0}, two{2, 0, 0, 0, 0}, four{4, 0, 0, 0, 0};
  CHECK(!linear_law({one, two, four}));
  for (const auto dense_cost : {dense_torque_cost, dense_plant_cost}) {
    std::vector<Tally> costs;
    for (int n = 1; n <= 16; ++n) {
      costs.push_back(dense_cost(homogeneous(JointType::revolute, n, 1)).tally);
      CHECK(costs.back().roots == 0);
    }
    CHECK(!linear_law(costs));
    CHECK(cubic_law(costs).third_difference > 0);
  }
}

TEST_CASE("No operation depends on the state or on the armature") {
  for (const auto& [counting, type, last] : all_recursions) {
    const std::vector<Series> here = series_of(counting, type, 1, last);
    const std::vector<Series> elsewhere = series_of(counting, type, 2, last);
    const std::vector<Series> without_motors = series_of(counting, type, 1, last, false);
    for (std::size_t i = 0; i < here.size(); ++i) {
      INFO(here[i].name);
      CHECK(here[i].costs == elsewhere[i].costs);
      CHECK(here[i].costs == without_motors[i].costs);
    }
  }
}

TEST_CASE("Sweeps along the arm: four, three, three, two; four for resolved acceleration") {
  const std::vector<Series> whole = series_of(whole_costs, JointType::revolute);
  const std::vector<Series> resolved = series_of(resolved_costs, JointType::revolute, 1, 6);
  const std::pair<const Series&, long> expected[] = {
      {named(whole, "controller torque"), 4}, {named(whole, "controller torque in link frames"), 4},
      {named(whole, "- old velocities"), 3},  {named(whole, "- old force"), 3},
      {named(whole, "- both old"), 2},        {resolved[0], 4},
  };
  for (const auto& [series, sweeps] : expected) {
    INFO(series.name);
    for (const long counted : series.sweeps) CHECK(counted == sweeps);
  }
}

TEST_CASE("Sampled forms save sweeps, not operations") {
  const std::vector<Series> whole = series_of(whole_costs, JointType::revolute);
  const Series& exact = named(whole, "controller torque in link frames");
  for (const char* name : {"- old velocities", "- old force", "- both old"})
    CHECK(named(whole, name).costs == exact.costs);
}

TEST_CASE("The controller torque costs the sum of its parts") {
  const std::vector<Series> part = series_of(sweep_costs, JointType::revolute);
  const Series whole = series_of(whole_costs, JointType::revolute)[0];
  for (std::size_t i = 0; i < whole.costs.size(); ++i) {
    Tally rest = whole.costs[i];
    for (const char* name : {"forward kinematics", "sweep 1, velocities", "sweep 2, articulated inertia",
                             "sweep 3, compliance", "6 x 6 factor and one solve", "sweep 4, torques"})
      rest = rest - named(part, name).costs[i];
    CHECK(rest == Tally{0, static_cast<std::int64_t>(i) + 1, 0, 0, 0});  // T0, one addition for each joint
  }
}

TEST_CASE("docs/operations.md has the rows that are counted now") {
  const std::string text = page();
  const Tables now = tables();
  const auto check = [&](const std::vector<std::string>& rows) {
    CHECK(!rows.empty());
    for (const std::string& row : rows) {
      INFO("run ./dev operations; missing: " << row);
      CHECK(text.find(row + "\n") != std::string::npos);
    }
  };
  for (const auto& rows : {now.turning, now.sliding, now.many_axes, now.forward_dynamics}) check(rows);
  // The dense side costs what Eigen's products execute: another Eigen may differ.
  const std::string eigen = "Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." +
                            std::to_string(EIGEN_MAJOR_VERSION) + "." + std::to_string(EIGEN_MINOR_VERSION);
  if (text.find(eigen) != std::string::npos)
    for (const auto& rows : {now.dense, now.order}) check(rows);
  else
    WARN("the page was not made with " << eigen << ": its dense rows are not compared");
}
