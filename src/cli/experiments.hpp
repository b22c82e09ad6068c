// `osculate run`, `verify`, `sweep` and `check`: one experiment each, with its messages and exit code.
#pragma once

#include <csignal>
#include <string>
#include <vector>

#include "experiment/run.hpp"

namespace osculate {

struct RunArguments {
  std::vector<std::string> experiments;
  std::string output;
  std::vector<std::string> sets;
  bool force = false, quiet = false;
  std::string line;                                    // the command line, for the provenance
  const volatile std::sig_atomic_t* signal = nullptr;  // non-zero: stop
};

/// The progress line on stderr: simulated and wall time in s.
void show_progress(double t, double duration, double wall);

/// `record`: into the output, else nothing but the verdict.
Exit run_one(const std::string& file, const RunArguments& arguments, bool record);
Exit sweep_one(const std::string& file, const RunArguments& arguments);
Exit check_one(const std::string& file, const RunArguments& arguments);

}  // namespace osculate
