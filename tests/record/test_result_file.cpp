// What a ResultFile promises in C++; what other readers see of it is tested from Python (test_readers.py and
// others).
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "record/result_file.hpp"
#include "support/catch.hpp"

namespace osculate::testing::result_file_tests {
using Catch::Matchers::Contains;
using std::filesystem::path;

namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

/// A directory of its own for each test case, removed at the end.
struct Scratch {
  path directory;
  Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "osculate-record-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no scratch directory");
    directory = name;
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(directory, ignored);
  }
  path operator/(const std::string& name) const { return directory / name; }
};

std::string bytes(const path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void put(const path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

Layout small_layout() {
  Layout layout;
  layout.title = "test";
  layout.axes = {
      {"time", {}, "s", "instants"}, {"joint", {"a", "b"}, "", "joints"}, {"step", {}, "s", "steps"}};
  layout.variables = {{"trajectory/position", {"time", "joint"}, "", "positions"},
                      {"solver/order", {"step"}, "1", "order", Kind::small},
                      {"solver/evaluations", {"step"}, "1", "evaluations", Kind::integer},
                      {"maybe", {"time"}, "1", "not always there", Kind::real, true}};
  layout.texts = {{"provenance/experiment", "a: 1\n", "experiment"}};
  layout.lists = {{"position_unit", "joint", {"rad", "m"}, "units"}};
  return layout;
}

void append_rows(ResultFile& file, int first, int last) {
  for (int row = first; row < last; ++row) {
    file.append("time", std::vector<double>{row * 0.5, row * 2.0, row + 0.25, row % 2 ? 1.0 : nan_value});
    file.append("step", std::vector<double>{row * 0.25, double(row % 5), double(row) * 1e12});
  }
}

void finish(ResultFile& file) {
  Ending ending;
  ending.rows = {{"claim", "(1)", "", 1e-15, 1e-12, 0.5, 1, 0, 9}};
  ending.scalars = {{"timing/simulation", 1.0, "s", "wall"}};
  ending.axes = {{"growth/bin_end", {}, "s", "end of the bin", {0.5, 1.0}},
                 {"mode", {"slow", "fast", "stray"}, "", "modes"}};
  ending.tables = {{"growth/error", {"growth/bin_end", "joint"}, "rad", "error", {1, 2, 3, nan_value}},
                   {"damping", {"mode"}, "1/s", "damping", {1, 2, 3}}};
  ending.lists = {{"mode_kind", "mode", {"real", "pair", "real"}, "kind"}};
  file.finish("complete", "pass", ending);
}

void write_finished(const path& where, const Layout& layout = small_layout()) {
  ResultFile file(where, layout, false);
  append_rows(file, 0, 700);
  finish(file);
}

/// Files in a directory, to show that nothing temporary is left.
std::size_t files_in(const path& directory) {
  const auto begin = std::filesystem::directory_iterator(directory);
  return static_cast<std::size_t>(std::distance(begin, std::filesystem::directory_iterator()));
}

}  // namespace

TEST_CASE("an existing file is kept unless forced") {
  const Scratch scratch;
  put(scratch / "a.h5", "precious");
  CHECK_THROWS_WITH(
      ResultFile(scratch / "a.h5", small_layout(), false),
      Contains((scratch / "a.h5").string()) && Contains("exists already") && Contains("--force"));
  CHECK(bytes(scratch / "a.h5") == "precious");
  {
    ResultFile file(scratch / "a.h5", small_layout(), true);
    CHECK(bytes(scratch / "a.h5") != "precious");
    finish(file);
  }
  CHECK(files_in(scratch.directory) == 1);
}

TEST_CASE("a failed creation keeps the existing file and leaves nothing else") {
  const Scratch scratch;
  put(scratch / "a.h5", "precious");
  Layout layout = small_layout();
  layout.texts.push_back(layout.texts[0]);  // the same path twice
  CHECK_THROWS_AS(ResultFile(scratch / "a.h5", layout, true), FileError);
  CHECK(bytes(scratch / "a.h5") == "precious");
  CHECK(files_in(scratch.directory) == 1);
}

TEST_CASE("places that cannot be written are named with the reason") {
  const Scratch scratch;
  const auto create = [&](const path& where) { ResultFile(where, small_layout(), false); };
  CHECK_THROWS_WITH(
      create(scratch / "none/a.h5"),
      Contains("no such directory: " + (scratch / "none").string()) && Contains("choose another"));
  CHECK_THROWS_WITH(create(scratch.directory), Contains("is a directory"));
  put(scratch / "plain", "");
  CHECK_THROWS_WITH(create(scratch / "plain/a.h5"), Contains("no such directory"));

  std::filesystem::create_directory(scratch / "locked");
  std::filesystem::permissions(scratch.directory, std::filesystem::perms(0755));
  std::filesystem::permissions(scratch / "locked", std::filesystem::perms(0555));
  const bool root = geteuid() == 0;
  if (root) REQUIRE(seteuid(65534) == 0);  // root may write anywhere
  CHECK_THROWS_WITH(create(scratch / "locked/a.h5"),
                    Contains("locked/a.h5: cannot create: Permission denied"));
  if (root) REQUIRE(seteuid(0) == 0);
  CHECK_THROWS_AS(create(scratch / "none/a.h5"), FileError);
}

TEST_CASE("a row is the axis value and every variable in the order of the layout") {
  const Scratch scratch;
  ResultFile file(scratch / "a.h5", small_layout(), false);
  CHECK(file.row_size("time") == 4);
  CHECK(file.row_size("step") == 3);
  CHECK_THROWS_AS(file.row_size("joint"), std::invalid_argument);
  CHECK_THROWS_AS(file.append("nothing", std::vector<double>{1}), std::invalid_argument);
  CHECK_THROWS_WITH(file.append("time", std::vector<double>{1, 2}), Contains("2 values, not 4"));
}

TEST_CASE("a value that its variable cannot hold is refused, and its row with it") {
  const Scratch scratch;
  write_finished(scratch / "plain.h5");
  ResultFile file(scratch / "a.h5", small_layout(), false);
  const auto append = [&](const std::string& axis, const std::vector<double>& row) {
    file.append(axis, row);
  };
  append_rows(file, 0, 300);
  CHECK_THROWS_WITH(append("time", {nan_value, 0, 0, 0}), Contains("time: NaN"));
  CHECK_THROWS_WITH(append("time", {0, 0, nan_value, 0}), Contains("trajectory/position: NaN"));
  CHECK_THROWS_AS(append("time", {0, 0, nan_value, 0}), std::invalid_argument);
  CHECK_THROWS_WITH(append("step", {0, 128, 0}), Contains("solver/order: 128"));
  CHECK_THROWS_WITH(append("step", {0, 0.5, 0}), Contains("solver/order: 0.5"));
  CHECK_THROWS_WITH(append("step", {0, 0, nan_value}), Contains("solver/evaluations: NaN"));
  CHECK_THROWS_WITH(append("step", {0, 0, 0x1p63}), Contains("solver/evaluations"));
  append_rows(file, 300, 700);
  finish(file);
  CHECK(bytes(scratch / "a.h5") == bytes(scratch / "plain.h5"));
}

TEST_CASE("the same rows make the same bytes") {
  const Scratch scratch;
  write_finished(scratch / "a.h5");
  write_finished(scratch / "b.h5");
  CHECK(bytes(scratch / "a.h5").size() > 700 * 2 * sizeof(double) / 8);
  CHECK(bytes(scratch / "a.h5") == bytes(scratch / "b.h5"));
  Layout other = small_layout();
  other.texts[0].value = "a: 2\n";
  write_finished(scratch / "c.h5", other);
  CHECK(bytes(scratch / "a.h5") != bytes(scratch / "c.h5"));
}

TEST_CASE("a layout that makes no sense is refused before a file appears") {
  const Scratch scratch;
  const auto refused = [&](const char* text, auto change) {
    Layout layout = small_layout();
    change(layout);
    CHECK_THROWS_AS(ResultFile(scratch / "a.h5", layout, false), std::invalid_argument);
    CHECK_THROWS_WITH(ResultFile(scratch / "a.h5", layout, false), Contains(text));
  };
  refused("unknown axis 'x'", [](Layout& l) { l.variables[0].axes[1] = "x"; });
  refused("has no axis", [](Layout& l) { l.variables[0].axes.clear(); });
  refused("not unlimited", [](Layout& l) { l.variables[0].axes = {"joint"}; });
  refused("only the first", [](Layout& l) { l.variables[0].axes = {"time", "step"}; });
  refused("one axis twice", [](Layout& l) { l.variables[0].axes = {"time", "joint", "joint"}; });
  refused("given twice", [](Layout& l) { l.axes.push_back(l.axes[0]); });
  refused("cannot be missing", [](Layout& l) { l.variables[1].may_be_missing = true; });
  refused("one string for each element", [](Layout& l) { l.lists[0].values.pop_back(); });
  refused("labels and coordinates", [](Layout& l) { l.axes[1].coordinates = {1, 2}; });
  refused("not finite", [](Layout& l) { l.axes.push_back({"f", {}, "Hz", "frequency", {1, nan_value}}); });
  refused("not in the root group", [](Layout& l) { l.axes.push_back({"a/b", {}, "s", "instants"}); });
  CHECK(files_in(scratch.directory) == 0);
}

TEST_CASE("an ending that makes no sense is refused and the file can still be finished") {
  const Scratch scratch;
  write_finished(scratch / "plain.h5");
  ResultFile file(scratch / "a.h5", small_layout(), false);
  append_rows(file, 0, 700);
  const auto refused = [&](const char* text, const Ending& ending) {
    CHECK_THROWS_AS(file.finish("complete", "pass", ending), std::invalid_argument);
    CHECK_THROWS_WITH(file.finish("complete", "pass", ending), Contains(text));
  };
  const auto table = [](const std::vector<std::string>& axes, std::size_t values) {
    return Ending{.tables = {{"t", axes, "", "table", std::vector<double>(values)}}};
  };
  refused("t: has no axis", table({}, 1));
  refused("t: 'bin' is not a fixed axis", table({"bin"}, 2));
  refused("t: 'time' is not a fixed axis", table({"time"}, 700));
  refused("t: one axis twice", table({"joint", "joint"}, 4));
  refused("t: has 3 values, not 2", table({"joint"}, 3));
  refused("'joint' given twice", {.axes = {{"joint", {"a"}, "", "joints"}}});
  refused("neither labels nor coordinates", {.axes = {{"bin", {}, "s", "bins"}}});
  refused("labels and coordinates", {.axes = {{"bin", {"a"}, "s", "bins", {1}}}});
  refused("one string for each element", {.lists = {{"kind", "joint", {"a"}, "kinds"}}});
  finish(file);
  CHECK(bytes(scratch / "a.h5") == bytes(scratch / "plain.h5"));
}

TEST_CASE("a file without a growing axis") {
  const Scratch scratch;
  Layout layout;
  layout.title = "sweep";
  layout.axes = {{"variant", {"a", "b"}, "", "variants"}};
  {
    ResultFile file(scratch / "a.h5", layout, false);
    CHECK_THROWS_AS(file.append("variant", std::vector<double>{1}), std::invalid_argument);
    file.finish("complete", "pass", {.tables = {{"error", {"variant"}, "m", "error", {1, 2}}}});
  }
  { const ResultFile dropped(scratch / "b.h5", layout, false); }
  CHECK(recover(scratch / "b.h5") == scratch / "b.recovered.h5");
  CHECK_THROWS_WITH(recover(scratch / "a.h5"), Contains("status complete"));
}

TEST_CASE("chunks of nothing but missing values or zeros take no room") {
  const Scratch scratch;
  const auto write = [&](const path& where, double order, double maybe) {
    ResultFile file(where, small_layout(), false);
    for (int row = 0; row < 2560; ++row) {
      file.append("time", std::vector<double>{row * 0.5, row * 2.0, row + 0.25, maybe});
      file.append("step", std::vector<double>{row * 0.25, order, 1});
    }
    finish(file);
    return std::filesystem::file_size(where);
  };
  const auto empty = write(scratch / "empty.h5", 0, nan_value), full = write(scratch / "full.h5", 1, 1);
  CHECK(empty < full);
  {
    ResultFile file(scratch / "run.h5", small_layout(), false);
    for (int row = 0; row < 300; ++row) file.append("time", std::vector<double>{row * 0.5, 0, 0, nan_value});
  }
  recover(scratch / "run.h5");
  CHECK_THAT(bytes(scratch / "run.recovered.h5"), Contains("time: 256 rows kept of 256"));
}

TEST_CASE("a finished file takes nothing more") {
  const Scratch scratch;
  ResultFile file(scratch / "a.h5", small_layout(), false);
  append_rows(file, 0, 3);
  finish(file);
  const std::string before = bytes(scratch / "a.h5");
  CHECK_THROWS_AS(append_rows(file, 3, 4), std::logic_error);
  CHECK_THROWS_AS(finish(file), std::logic_error);
  CHECK(bytes(scratch / "a.h5") == before);
  CHECK(files_in(scratch.directory) == 1);
}

TEST_CASE("without room for a copy the end is written in place") {
  const Scratch scratch;
  write_finished(scratch / "plain.h5");
  ResultFile file(scratch / "a.h5", small_layout(), false);
  append_rows(file, 0, 700);
  std::filesystem::create_directories(scratch / "a.h5.tmp/in the way");
  finish(file);
  CHECK(bytes(scratch / "a.h5") == bytes(scratch / "plain.h5"));
}

TEST_CASE("a file that someone else has replaced is left alone") {
  const Scratch scratch;
  ResultFile file(scratch / "a.h5", small_layout(), false);
  append_rows(file, 0, 700);
  put(scratch / "other", "of someone else");
  std::filesystem::rename(scratch / "other", scratch / "a.h5");
  CHECK_THROWS_WITH(finish(file), Contains("replaced or removed"));
  CHECK(bytes(scratch / "a.h5") == "of someone else");
}

TEST_CASE("an unfinished file is recovered once and for all") {
  const Scratch scratch;
  {
    ResultFile file(scratch / "run.h5", small_layout(), false);
    append_rows(file, 0, 700);
    const ResultFile moved = std::move(file);  // dropped without finish
  }
  const std::string left = bytes(scratch / "run.h5");
  CHECK(recover(scratch / "run.h5") == scratch / "run.recovered.h5");
  CHECK(recover(scratch / "run.h5", scratch / "again.h5") == scratch / "again.h5");
  CHECK(bytes(scratch / "run.h5") == left);
  CHECK(bytes(scratch / "again.h5") == bytes(scratch / "run.recovered.h5"));
  CHECK(files_in(scratch.directory) == 3);
  // 700 rows are two full chunks of 256 and a buffered rest; the rows of both axes are the same in number.
  CHECK_THAT(bytes(scratch / "again.h5"),
             Contains("time: 512 rows kept of 512") && Contains("step: 512 rows kept of 512"));

  CHECK_THROWS_WITH(recover(scratch / "again.h5"), Contains("is a finished file (status recovered)"));
  CHECK_THROWS_WITH(recover(scratch / "run.h5"),
                    Contains("run.recovered.h5: exists already") && Contains("--force"));
  CHECK(recover(scratch / "run.h5", {}, true) == scratch / "run.recovered.h5");
  CHECK_THROWS_WITH(recover(scratch / "run.h5", scratch / "run.h5", true), Contains("onto itself"));
  CHECK_THROWS_WITH(recover(scratch / "run.h5", scratch / "none/a.h5"), Contains("no such directory"));
  CHECK(bytes(scratch / "run.h5") == left);
}

TEST_CASE("recover refuses what is not an unfinished result file") {
  const Scratch scratch;
  write_finished(scratch / "done.h5");
  CHECK_THROWS_WITH(recover(scratch / "done.h5"), Contains("is a finished file (status complete)"));
  CHECK_THROWS_WITH(recover(scratch / "none.h5"), Contains("none.h5: no such file"));
  CHECK_THROWS_WITH(recover(scratch.directory), Contains("is a directory"));
  put(scratch / "garbage.h5", "garbage, and more of it");
  CHECK_THROWS_WITH(recover(scratch / "garbage.h5"), Contains("garbage.h5: is not an HDF5 file"));
  put(scratch / "cut.h5", bytes(scratch / "done.h5").substr(0, 3000));
  CHECK_THROWS_WITH(recover(scratch / "cut.h5"), Contains("cut.h5: cannot open: truncated file"));
  put(scratch / "early.h5.tmp", "");
  CHECK_THROWS_WITH(recover(scratch / "early.h5"),
                    Contains("early.h5.tmp") && Contains("before its first row"));
  CHECK_THROWS_WITH(recover(scratch / "early.h5.tmp"), Contains("temporary name"));
  CHECK_THROWS_AS(recover(scratch / "garbage.h5"), FileError);
  CHECK(files_in(scratch.directory) == 4);
}

TEST_CASE("the version of HDF5 is told") {
  CHECK_THAT(hdf5_version(), Catch::Matchers::Matches("[0-9]+\\.[0-9]+\\.[0-9]+"));
}

}  // namespace osculate::testing::result_file_tests
