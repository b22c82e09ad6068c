// A small program that the Python tests start, kill and starve of disk space. Its numbers are a known
// function of the row.
//   writer run FILE ROWS PACE_US [LIMIT_BYTES]   ROWS rows, then finish (0: endless); every 50 rows it prints
//                                                the number of rows appended so far and pauses for PACE_US;
//                                                LIMIT_BYTES: no file may grow beyond it
//   writer recover IN OUT
// Exit codes as of the program: 4 for FileError, 2 for a wrong call.
#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <iostream>
#include <limits>
#include <thread>

#include "record/result_file.hpp"

namespace {

using namespace osculate;

Layout layout() {
  Layout result;
  result.title = "rows of known numbers";
  result.axes = {
      {"time", {}, "s", "recorded instants"},
      {"step", {}, "s", "end of every integrator step"},
      {"joint", {"shoulder", "elbow", "wrist \u03b8"}, "", "joints, base to tip"},
      {"spatial", {"wx", "wy", "wz", "vx", "vy", "vz"}, "", "spatial components"},
      {"spatial_column", {"wx", "wy", "wz", "vx", "vy", "vz"}, "", "spatial components of columns"},
      {"height", {}, "m", "heights of the probes", {0.125, 0.25}}};
  result.variables = {{"trajectory/joint_position", {"time", "joint"}, "", "joint coordinates"},
                      {"operational_space/Lambda",
                       {"time", "spatial", "spatial_column"},
                       "",
                       "operational inertia",
                       Kind::real,
                       true},
                      {"energy/total", {"time"}, "J", "kinetic and potential energy"},
                      {"temperature", {"step", "height"}, "K", "temperature at the probes"},
                      {"solver/order", {"step"}, "1", "order of the method", Kind::small},
                      {"solver/rhs_evaluations", {"step"}, "1", "right-hand sides so far", Kind::integer}};
  result.lists = {{"position_unit", "joint", {"rad", "rad", "m"}, "units of joint_position"}};
  result.texts = {{"provenance/experiment", "name: known\nrows: many\n", "experiment file"},
                  {"provenance/git_commit", "", "commit of the program"}};
  return result;
}

/// In [0, 1), exact in double, without a pattern that compresses away; the same in the Python tests.
double number(std::uint64_t row, std::uint64_t component) {
  return static_cast<double>((row * 2654435761ULL + component * 40503ULL) % 4294967296ULL) / 4294967296.0;
}

void append(ResultFile& file, std::uint64_t row) {
  std::vector<double> values{static_cast<double>(row) / 1024};
  for (std::uint64_t i = 1; i < file.row_size("time"); ++i) values.push_back(number(row, i));
  if (row % 10 == 7)
    for (std::size_t i = 0; i < 36; ++i) values[4 + i] = std::numeric_limits<double>::quiet_NaN();  // Lambda
  file.append("time", values);
  if (row % 3 != 0) return;
  const std::uint64_t step = row / 3;
  const double line[] = {static_cast<double>(step) / 512, number(step, 1), number(step, 2),
                         static_cast<double>(step % 13), static_cast<double>(step * 7)};
  file.append("step", line);
}

int run(const std::string& name, std::uint64_t rows, int pace_us) {
  ResultFile file(name, layout(), false);
  for (std::uint64_t row = 0; rows == 0 || row < rows; ++row) {
    append(file, row);
    if (row % 50 != 49) continue;
    std::cout << row + 1 << std::endl;
    if (pace_us > 0) std::this_thread::sleep_for(std::chrono::microseconds(pace_us));
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Ending ending;
  ending.rows = {{"energy balance", "(12)", "", 1e-12, 1e-10, 0.5, 1, 3, 100},
                 {"gravity-free rest", "(7)", "gravity is on", nan, nan, nan, -1, 0, 0}};
  ending.scalars = {{"timing/simulation", 0.25, "s", "wall time of the simulation"}};
  ending.axes = {{"response/frequency", {}, "Hz", "frequencies of the excitation", {0.5, 2, 8, 32}},
                 {"mode", {"slow", "fast"}, "", "modes of the loop"}};
  ending.tables = {
      {"response/gain",
       {"response/frequency", "joint"},
       "1",
       "gain",
       {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, nan}},
      {"coupling", {"spatial", "mode"}, "1", "coupling", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}}};
  ending.lists = {{"mode_kind", "mode", {"real", "pair"}, "kind of the mode"}};
  file.finish("complete", "pass", ending);
  return 0;
}

void limit_files(rlim_t bytes) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_FSIZE, &limit);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    if (words.size() >= 4 && words[0] == "run") {
      if (words.size() == 5) limit_files(std::stoul(words[4]));
      return run(words[1], std::stoul(words[2]), std::stoi(words[3]));
    }
    if (words.size() == 3 && words[0] == "recover") {
      std::cout << recover(words[1], words[2]).string() << "\n";
      return 0;
    }
  } catch (const FileError& error) {
    std::cerr << error.what() << "\n";
    return 4;
  }
  std::cerr << "writer run FILE ROWS PACE_US [LIMIT_BYTES] | writer recover IN OUT\n";
  return 2;
}
