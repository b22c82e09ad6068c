#include "cli/replay.hpp"

#include <unistd.h>

#include <cstdio>
#include <ostream>

#include "experiment/embedded.hpp"
#include "experiment/sweep.hpp"
#include "record/difference.hpp"

namespace osculate {

namespace {

using std::filesystem::path;

/// A new empty directory for files that nobody wants to keep. TMPDIR says where.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::error_code error;
    std::string pattern = (std::filesystem::temp_directory_path(error) / "osculate-XXXXXX").string();
    if (error || !mkdtemp(pattern.data()))
      throw FileError(pattern +
                      ": cannot make a temporary directory; set TMPDIR, or choose an output with -o");
    path_ = pattern;
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  const path& where() const { return path_; }

 private:
  path path_;
};

void print_build(const ResultTexts& a, const ResultTexts& b, std::ostream& out) {
  const auto differences = build_differences(a, b);
  if (!differences.empty()) out << "build or processor differ: the last digits may too\n";
  for (const std::string& line : differences) out << "  " << line << "\n";
}

/// Throws where the law of a result file is one of a user's own and nobody has said that it may run: the file
/// can come from anywhere.
void require_allowed(const Experiment& experiment, const AgainOptions& options) {
  const UserLawOptions& law = experiment.controller.user;
  if (experiment.controller.law != Law::user || options.run_controller) return;
  std::string name = law.plugin;
  for (const auto& word : law.process) name += (name.empty() ? "" : " ") + word;
  throw ConfigError(options.file.string() + ": its run had a controller of its own, '" + name +
                    "', which would run with your rights: give --run-controller if you trust it.");
}

/// Throws where a file of the controller is missing.
void print_controller(const ResultTexts& texts, const path& file, const Experiment& experiment,
                      std::ostream& out) {
  for (const std::string& change : controller_changes(texts, file, experiment))
    out << "the controller has changed: " << change << "\n";
}

/// Identical or not, in words and as an exit code.
Exit tell(const Comparison& comparison, const path& a, const path& b, std::ostream& out) {
  out << report(comparison, a.string(), b.string());
  return comparison.identical() ? Exit::ok : Exit::claim_failed;
}

bool stopped_by_signal(Exit exit) { return exit == Exit::interrupted || exit == Exit::terminated; }

/// The exit code of the run, not of the comparison.
Exit run_again(const ResultTexts& texts, const AgainOptions& options, const path& output, bool force,
               std::ostream& out) {
  if (is_sweep(texts)) {
    SweepOptions sweeping;
    sweeping.output = output;
    sweeping.force = force;
    sweeping.command = options.command;
    sweeping.signal = options.signal;
    if (options.progress)
      sweeping.progress = [&](const std::string&, double t, double duration, double wall) {
        options.progress(t, duration, wall);
      };
    const auto read = [&](const std::vector<std::string>& overrides) {
      Experiment variant = embedded_experiment(texts, options.file, overrides);
      require_allowed(variant, options);
      return variant;
    };
    return sweep({options.file.string(), read}, {}, sweeping).exit;
  }
  RunOptions running;
  running.output = output;
  running.force = force;
  running.command = options.command;
  running.signal = options.signal;
  running.progress = options.progress;
  const Experiment experiment = embedded_experiment(texts, options.file);
  require_allowed(experiment, options);
  print_controller(texts, options.file, experiment, out);
  return run(experiment, running).exit;
}

void end_progress(const AgainOptions& options, std::ostream& messages) {
  if (options.progress) messages << "\r\033[K";
}

}  // namespace

Exit replay(const AgainOptions& options, std::ostream& out, std::ostream& messages) {
  const ResultTexts texts = read_texts(options.file);
  const bool keep = !options.output.empty();
  std::optional<TemporaryDirectory> temporary;
  if (!keep) temporary.emplace();
  const path output = keep ? options.output : temporary->where() / "replay.h5";
  const Exit exit = run_again(texts, options, output, options.force, out);
  end_progress(options, messages);
  if (stopped_by_signal(exit)) {
    messages << "osculate: interrupted: nothing was compared\n";
    return exit;
  }
  print_build(texts, read_texts(output), out);
  const bool whole = texts.status == "complete" || texts.status == "failed";
  if (!whole)
    out << "the run of " << options.file.string() << " was stopped (status " << texts.status
        << "): the rows that it recorded are compared\n";
  const Comparison found = compare(options.file, output, whole ? Compared::everything : Compared::first_rows);
  return tell(found, options.file, keep ? output : path("the replay"), out);
}

Exit diff(const path& a, const path& b, std::ostream& out) {
  const ResultTexts of_a = read_texts(a), of_b = read_texts(b);
  print_build(of_a, of_b, out);
  for (const char* text : {"experiment", "model", "waypoints"}) {
    const std::string where = std::string("provenance/") + text;
    if (of_a.has(where) != of_b.has(where) || (of_a.has(where) && of_a.at(where) != of_b.at(where)))
      out << "the files embed different texts: /" << where << "\n";
  }
  return tell(compare(a, b), a, b, out);
}

Exit resume(const AgainOptions& options, std::ostream& out, std::ostream& messages) {
  const ResultTexts texts = read_texts(options.file);
  if (is_sweep(texts))
    throw ConfigError(options.file.string() +
                      ": is the table of a sweep, whose runs are not in it; sweep again.");
  if (texts.status == "complete")
    throw ConfigError(options.file.string() + ": its run is complete: there is nothing to resume.");
  path output = options.output;
  if (output.empty()) {
    output = options.file;
    if (output.extension() == ".h5") output.replace_extension();
    output += ".resumed.h5";
  }
  std::error_code ignored;
  if (std::filesystem::equivalent(options.file, output, ignored))
    throw FileError(output.string() + ": a run cannot be resumed into its own file; choose another output");
  const Experiment experiment = embedded_experiment(texts, options.file);
  if (experiment.controller.law == Law::user && experiment.controller.sampling)
    throw ConfigError(options.file.string() +
                      ": its sampled law is one of your own, and what that remembers is not in the file: run "
                      "the experiment again.");
  require_allowed(experiment, options);
  print_controller(texts, options.file, experiment, out);

  RunOptions running;
  running.output = output;
  running.force = options.force;
  running.command = options.command;
  running.signal = options.signal;
  running.progress = options.progress;
  running.from = last_restart_point(options.file);
  if (running.from)
    out << "resumed from the restart point at t = " << running.from->time << " s\n";
  else
    out << "no restart point was reached: run again from the start\n";
  const RunResult result = run(experiment, running);
  end_progress(options, messages);
  print_build(texts, read_texts(output), out);
  for (const auto& warning : result.warnings) messages << "warning: " << warning << "\n";
  out << report(experiment, result) << "recorded in " << output.string() << "\n";
  if (result.exit != Exit::ok && !result.message.empty()) messages << "osculate: " << result.message << "\n";
  return result.exit;
}

}  // namespace osculate
