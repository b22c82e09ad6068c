// `osculate replay`, `diff` and `resume`: what becomes of result files later.
#pragma once

#include <csignal>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>

#include "experiment/run.hpp"

namespace osculate {

struct AgainOptions {
  std::filesystem::path file;                                            // result file to begin with
  std::filesystem::path output;                                          // empty: see each command
  bool force = false;                                                    // overwrite
  bool run_controller = false;                                           // one of the user's own, too
  std::string command;                                                   // for the provenance
  const volatile std::sig_atomic_t* signal = nullptr;                    // non-zero: stop
  std::function<void(double t, double duration, double wall)> progress;  // or none
};

/// Runs the experiment of a result file again and compares the results bit for bit. Without an output nothing
/// is kept. Of a run that was stopped, the rows that it recorded are compared.
Exit replay(const AgainOptions& options, std::ostream& out, std::ostream& messages);

/// Compares two result files bit for bit.
Exit diff(const std::filesystem::path& a, const std::filesystem::path& b, std::ostream& out);

/// Goes on with a stopped run from its last restart point, into a new file: FILE.resumed.h5 if no output is
/// given.
Exit resume(const AgainOptions& options, std::ostream& out, std::ostream& messages);

}  // namespace osculate
