#include "cli/experiments.hpp"

#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <set>

#include "cli/guarded.hpp"
#include "experiment/arms.hpp"
#include "experiment/sweep.hpp"

namespace osculate {

namespace {

bool shows_progress(const RunArguments& arguments) { return !arguments.quiet && isatty(STDERR_FILENO); }

void show_labelled_progress(const std::string& label, double t, double duration, double wall) {
  const double speed = wall > 0 ? t / wall : 0;
  const double left = speed > 0 ? (duration - t) / speed : 0;
  std::fprintf(stderr, "\r%s%.2f of %.2f s, %.1f times real time, %.0f s left \033[K", label.c_str(), t,
               duration, speed, left);
}

void end_progress(bool shown) {
  if (shown) std::fprintf(stderr, "\r\033[K");
}

}  // namespace

void show_progress(double t, double duration, double wall) { show_labelled_progress("", t, duration, wall); }

Exit run_one(const std::string& file, const RunArguments& arguments, bool record) {
  return guarded([&] {
    const Experiment experiment = read_experiment(file, arguments.sets);
    RunOptions options;
    if (record)
      options.output = arguments.output.empty() ? std::filesystem::path(experiment.name + ".h5")
                                                : std::filesystem::path(arguments.output);
    options.force = arguments.force;
    options.command = arguments.line;
    options.signal = arguments.signal;
    const bool progress = shows_progress(arguments);
    if (progress) options.progress = show_progress;
    const RunResult result = run(experiment, options);
    end_progress(progress);
    for (const auto& warning : result.warnings) std::cerr << "warning: " << warning << "\n";
    std::cout << report(experiment, result);
    if (record) std::cout << "recorded in " << options.output->string() << "\n";
    if (result.exit != Exit::ok && !result.message.empty())
      std::cerr << "osculate: " << result.message << "\n";
    return result.exit;
  });
}

Exit sweep_one(const std::string& file, const RunArguments& arguments) {
  return guarded([&] {
    SweepOptions options;
    if (!arguments.output.empty()) options.output = arguments.output;
    options.force = arguments.force;
    options.command = arguments.line;
    options.signal = arguments.signal;
    const bool progress = shows_progress(arguments);
    if (progress)
      options.progress = [](const std::string& label, double t, double duration, double wall) {
        show_labelled_progress(label + ": ", t, duration, wall);
      };
    const SweepResult result = sweep(file, arguments.sets, options);
    end_progress(progress);
    std::set<std::string> warned;  // variants mostly share their warnings
    for (const auto& run : result.runs)
      for (const auto& warning : run.warnings)
        if (warned.insert(warning).second) std::cerr << "warning: " << warning << "\n";
    std::cout << report(result);
    if (options.output) std::cout << "recorded in " << options.output->string() << "\n";
    if (result.exit == Exit::interrupted || result.exit == Exit::terminated)
      std::cerr << "osculate: interrupted: the table has the variants before that\n";
    return result.exit;
  });
}

Exit check_one(const std::string& file, const RunArguments& arguments) {
  return guarded([&] {
    const Experiment experiment = read_experiment(file, arguments.sets);
    check(experiment);
    std::cout << file << ": fine\n";
    return Exit::ok;
  });
}

}  // namespace osculate
