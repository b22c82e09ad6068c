#include "experiment/sweep.hpp"

#include <algorithm>
#include <cmath>

#include "experiment/provenance.hpp"

namespace osculate {

namespace {

/// Says which variant an error is about.
template <class Work>
auto of_variant(const std::string& name, const Work& work) {
  const auto named = [&name](const std::exception& error) {
    return std::string(error.what()) + " (Variant " + name + " of sweep.)";
  };
  try {
    return work();
  } catch (const ConfigError& error) { throw ConfigError(named(error)); } catch (const ModelError& error) {
    throw ModelError(named(error));
  } catch (const ReferenceError& error) { throw ReferenceError(named(error)); }
}

bool interrupted(Exit exit) { return exit == Exit::interrupted || exit == Exit::terminated; }

/// The numbers of a run that was not interrupted.
void take(SweepRun& run, const Experiment& experiment, const RunResult& result) {
  run.exit_code = static_cast<int>(result.exit);
  run.end_time = result.end_time;
  run.steps = static_cast<double>(result.steps);
  run.rhs_evaluations = static_cast<double>(result.rhs_evaluations);
  run.wall_time = result.times.simulation + result.times.shadow + result.times.checking;
  const auto& rows = experiment.controller.rows;
  const bool angular = std::any_of(rows.begin(), rows.end(), [](int row) { return row < 3; });
  const bool linear = std::any_of(rows.begin(), rows.end(), [](int row) { return row >= 3; });
  const DepartureResult& departure = result.measured.departure;
  const bool seen = !std::isnan(departure.position.time);  // at least the start was
  if (seen && linear) {
    run.position = departure.position.value;
    run.position_rms = departure.position_rms;
    run.linear_missed = departure.linear_acceleration.value;
  }
  if (seen && angular) {
    run.orientation = departure.orientation.value;
    run.orientation_rms = departure.orientation_rms;
    run.angular_missed = departure.angular_acceleration.value;
  }
  for (std::size_t i = 0; i < departure.torque.size(); ++i) {
    if (departure.torque[i].value <= run.torque) continue;  // never while that is NaN
    run.torque = departure.torque[i].value;
    run.torque_joint = static_cast<double>(i + 1);
  }
  if (result.analytic) {
    run.analytic_position = result.worst_position;
    run.analytic_orientation = result.worst_orientation;
  }
  if (result.error.known) {
    run.error_position = result.error.position;
    run.error_orientation = result.error.orientation;
  }
}

/// Runs one variant. Its failure is a result too: the others still run.
Exit run_variant(SweepRun& run, const Experiment& experiment, const RunOptions& options) {
  const auto refused = [&run](Exit exit, const std::exception& error) {
    run.status = "refused";
    run.message = error.what();
    run.exit_code = static_cast<int>(exit);
    return exit;
  };
  try {
    const RunResult result = osculate::run(experiment, options);
    run.status = result.status;
    run.message = result.message;
    run.warnings = result.warnings;
    if (interrupted(result.exit)) return result.exit;
    run.verdict = result.verdict;
    take(run, experiment, result);
    return result.exit;
  } catch (const ConfigError& error) {
    return refused(Exit::bad_input, error);
  } catch (const ModelError& error) {
    return refused(Exit::bad_input, error);
  } catch (const ReferenceError& error) {
    return refused(Exit::bad_input, error);
  } catch (const std::exception& error) { return refused(Exit::stopped, error); }
}

}  // namespace

SweepResult sweep(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                  const SweepOptions& options) {
  const auto read = [&file](const std::vector<std::string>& changes) {
    return read_experiment(file, changes);
  };
  return sweep({file.string(), read}, overrides, options);
}

SweepResult sweep(const SweepSource& source, const std::vector<std::string>& overrides,
                  const SweepOptions& options) {
  const Experiment base = source.read(overrides);
  if (base.sweep.variants.empty())
    throw ConfigError(
        source.name +
        ": has no section sweep: say what to change, for instance 'sweep: {key: "
        "controller.sampling.period, values: [0.001, 0.002, 0.004]}', in the file or with --set.");
  SweepResult result;
  result.name = base.name;
  result.key = base.sweep.key;
  std::vector<Experiment> experiments;
  for (const auto& variant : base.sweep.variants) {
    of_variant(variant.name, [&] {
      experiments.push_back(source.read(overrides_of(variant, overrides)));
      check(experiments.back());
    });
    SweepRun& run = result.runs.emplace_back();
    run.name = variant.name;
    run.value = variant.value;
    for (const auto& change : variant.overrides) run.changes += change + "\n";
  }

  std::optional<ResultFile> recorded;
  if (options.output) {
    NamedFiles files;
    add_files(base, files);
    for (const Experiment& experiment : experiments) add_files(experiment, files);
    auto texts = provenance(base, files.at(base.model.urdf.string()), options.command);
    texts.push_back({"provenance/directory", base.directory.string(), "where relative paths start"});
    recorded.emplace(*options.output, sweep_layout(result, std::move(texts), files), options.force);
  }
  RunOptions each;
  each.command = options.command;
  each.signal = options.signal;
  for (std::size_t i = 0; i < experiments.size() && !interrupted(result.exit); ++i) {
    if (options.signal && *options.signal != 0) {
      result.exit = *options.signal == SIGTERM ? Exit::terminated : Exit::interrupted;
      break;
    }
    SweepRun& run = result.runs[i];
    if (options.progress) {
      const std::string label =
          std::to_string(i + 1) + "/" + std::to_string(experiments.size()) + " " + run.name;
      each.progress = [&options, label](double t, double duration, double wall) {
        options.progress(label, t, duration, wall);
      };
    }
    result.exit = std::max(result.exit, run_variant(run, experiments[i], each));
  }
  if (recorded) recorded->finish(sweep_status(result), sweep_verdict(result), sweep_ending(result));
  return result;
}

}  // namespace osculate
