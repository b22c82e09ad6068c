// Distances in ulps, comparison of files, and rows that are flushed before their chunk is full.
#include "record/difference.hpp"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "record/restart_point.hpp"
#include "support/catch.hpp"

namespace osculate::testing::difference_tests {
using Catch::Matchers::Contains;
using std::filesystem::path;

namespace {

struct Scratch {
  path directory;
  Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "osculate-difference-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no scratch directory");
    directory = name;
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(directory, ignored);
  }
  path operator/(const std::string& name) const { return directory / name; }
};

Layout layout_with_restarts() {
  Layout layout;
  layout.title = "test";
  layout.axes = {
      {"time", {}, "s", "instants"}, {"joint", {"a", "b"}, "", "joints"}, {"step", {}, "1", "steps"}};
  layout.variables = {{"position", {"time", "joint"}, "", "positions"},
                      {"step_time", {"step"}, "s", "end of the step"},
                      {"first/a", {"time"}, "1", "in a group"},
                      {"second/a", {"time"}, "1", "in another group"},
                      {"first/b", {"time"}, "1", "in the group before that"},
                      {"order", {"step"}, "1", "order", Kind::small},
                      {"count", {"step"}, "1", "count", Kind::integer}};
  add_restart_points(layout);
  return layout;
}

void append(ResultFile& file, int first, int last) {
  for (int i = first; i < last; ++i) {
    file.append("time", std::vector<double>{i * 0.5, std::sin(i), std::cos(i), 1.5 * i, 2.5 * i, 3.5 * i});
    file.append("step", std::vector<double>{double(i), i * 0.5, double(i % 5), double(i / 40)});
  }
}

std::vector<double> memory_of(int i) { return {double(i), 0.1, std::numeric_limits<double>::quiet_NaN()}; }

void write(const path& where, const std::vector<int>& points, bool finish) {
  ResultFile file(where, layout_with_restarts(), false);
  int row = 0;
  for (const int until : points) {
    append(file, row, until);
    append_restart_point(until * 0.5, memory_of(until), file);
    row = until;
  }
  append(file, row, 700);
  if (finish) file.finish("complete", "pass");
}

}  // namespace

TEST_CASE("ulps count the doubles from one value to the other") {
  constexpr double inf = std::numeric_limits<double>::infinity(),
                   nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double tiny = std::numeric_limits<double>::denorm_min();
  constexpr auto incomparable = std::numeric_limits<std::uint64_t>::max();
  CHECK(ulps_between(1, 1) == 0);
  CHECK(ulps_between(0.0, -0.0) == 0);
  CHECK(ulps_between(nan, nan) == 0);
  CHECK(ulps_between(nan, -nan) == incomparable);
  CHECK(ulps_between(nan, 1) == incomparable);
  CHECK(ulps_between(tiny, -tiny) == 2);
  CHECK(ulps_between(std::numeric_limits<double>::max(), inf) == 1);
  CHECK(ulps_between(1, 2) == std::uint64_t{1} << 52);
  CHECK(ulps_between(-1, -2) == std::uint64_t{1} << 52);
  CHECK(ulps_between(-inf, inf) == 2 * (std::uint64_t{0x7ff} << 52));
  for (const double x : {1.0, -3.5, 1e-310, 1e300, -0x1p-1022})
    for (const double towards : {inf, -inf}) {
      double y = x;
      for (std::uint64_t i = 1; i <= 5; ++i) {
        y = std::nextafter(y, towards);
        CHECK(ulps_between(x, y) == i);
        CHECK(ulps_between(y, x) == i);
      }
    }
}

TEST_CASE("restart points change no row, and are read back with the rows before them") {
  const Scratch scratch;
  // at, just before and after the ends of chunks (of 256 rows), and twice in one chunk
  const std::vector<int> points{10, 200, 256, 257, 511, 512, 699};
  write(scratch / "points.h5", points, true);
  write(scratch / "one.h5", {699}, true);
  const Comparison found = compare(scratch / "points.h5", scratch / "one.h5");
  for (const DatasetDifference& difference : found.differences)
    CHECK_THAT(difference.path, Contains("restart"));
  CHECK(found.datasets == 16);

  for (const bool finish : {true, false}) {
    const path where = scratch / (finish ? "finished.h5" : "killed.h5");
    write(where, points, finish);
    const auto point = last_restart_point(where);
    REQUIRE(point);
    CHECK(point->time == 699 * 0.5);
    REQUIRE(point->memory.size() == 3);
    CHECK(point->memory[0] == 699);
    CHECK(std::isnan(point->memory[2]));
    CHECK(point->rows == std::map<std::string, std::size_t>{
                             {"restart_time", 7}, {"restart_value", 21}, {"step", 699}, {"time", 699}});

    const path again = scratch / (finish ? "again1.h5" : "again2.h5");
    ResultFile file(again, layout_with_restarts(), false);
    copy_until(*point, file);
    append(file, 699, 700);
    file.finish("complete", "pass");
    CHECK(compare(scratch / "points.h5", again).identical());
  }
}

TEST_CASE("a restart point counts if all of its rows are there") {
  const Scratch scratch;
  write(scratch / "none.h5", {}, false);
  CHECK_FALSE(last_restart_point(scratch / "none.h5"));
  Layout without = layout_with_restarts();
  std::erase_if(without.axes, [](const Axis& axis) { return axis.name.starts_with("restart"); });
  std::erase_if(without.variables, [](const Variable& v) { return v.path.starts_with("restart"); });
  ResultFile(scratch / "without.h5", without, false).finish("complete", "pass");
  CHECK_FALSE(last_restart_point(scratch / "without.h5"));

  ResultFile file(scratch / "ahead.h5", layout_with_restarts(), false);
  append(file, 0, 20);
  append_restart_point(10, memory_of(20), file);
  file.append("restart_time", std::vector<double>{20, 40, 40, 3});  // rows that were never written
  file.finish("interrupted", "fail");
  const auto point = last_restart_point(scratch / "ahead.h5");
  REQUIRE(point);
  CHECK(point->time == 10);
}

TEST_CASE("a file as a killed run leaves it is compared as far as it goes") {
  const Scratch scratch;
  write(scratch / "whole.h5", {300}, true);
  write(scratch / "killed.h5", {300}, false);
  CHECK(compare(scratch / "killed.h5", scratch / "whole.h5", Compared::first_rows).identical());
  const Comparison found = compare(scratch / "killed.h5", scratch / "whole.h5");
  REQUIRE(found.first);
  CHECK(found.first->axis == "time");
  CHECK(found.first->row == 512);
  CHECK(found.first->time == 256.0);
  CHECK(found.first->a == "missing");
}

}  // namespace osculate::testing::difference_tests
