// osculate: the command line. Results to stdout, messages and the progress line to stderr.
#include "cli/program.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <set>

#include "cli/contained.hpp"
#include "cli/info.hpp"
#include "cli/paper.hpp"
#include "cli/replay.hpp"
#include "cli/terms.hpp"
#include "experiment/arms.hpp"
#include "experiment/provenance.hpp"
#include "experiment/run.hpp"
#include "experiment/schema.hpp"
#include "experiment/sweep.hpp"
#include "record/export.hpp"
#include "record/result_file.hpp"

using namespace osculate;

namespace {

volatile std::sig_atomic_t caught_signal = 0;
extern "C" void on_signal(int number) { caught_signal = number; }

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

/// The gravest of several exit codes: interruption, then 4 > 3 > 2 > 1 > 0.
Exit graver(Exit a, Exit b) { return static_cast<int>(a) > static_cast<int>(b) ? a : b; }

void show_labelled_progress(const std::string& label, double t, double duration, double wall) {
  const double speed = wall > 0 ? t / wall : 0;
  const double left = speed > 0 ? (duration - t) / speed : 0;
  std::fprintf(stderr, "\r%s%.2f of %.2f s, %.1f times real time, %.0f s left \033[K", label.c_str(), t,
               duration, speed, left);
}

void show_progress(double t, double duration, double wall) { show_labelled_progress("", t, duration, wall); }

void end_progress(bool shown) {
  if (shown) std::fprintf(stderr, "\r\033[K");
}

/// Runs `work`, turning every known failure into its message and exit code.
template <class Work>
Exit guarded(const Work& work) {
  const auto complain = [](const std::exception& error, Exit code) {
    std::cerr << "osculate: " << error.what() << "\n";
    return code;
  };
  try {
    return work();
  } catch (const FileError& error) {
    return complain(error, Exit::io_failure);
  } catch (const ConfigError& error) {
    return complain(error, Exit::bad_input);
  } catch (const ModelError& error) {
    return complain(error, Exit::bad_input);
  } catch (const ReferenceError& error) {
    return complain(error, Exit::bad_input);
  } catch (const IntegrationStopped& error) {
    return complain(error, Exit::stopped);
  } catch (const std::exception& error) { return complain(error, Exit::stopped); }
}

struct RunArguments {
  std::vector<std::string> experiments;
  std::string output;
  std::vector<std::string> sets;
  bool force = false, quiet = false;
};

Exit run_one(const std::string& file, const RunArguments& arguments, bool record,
             const std::string& command) {
  return guarded([&] {
    const Experiment experiment = read_experiment(file, arguments.sets);
    RunOptions options;
    if (record)
      options.output = arguments.output.empty() ? std::filesystem::path(experiment.name + ".h5")
                                                : std::filesystem::path(arguments.output);
    options.force = arguments.force;
    options.command = command;
    options.signal = &caught_signal;
    const bool progress = !arguments.quiet && isatty(STDERR_FILENO);
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

Exit sweep_one(const std::string& file, const RunArguments& arguments, const std::string& command) {
  return guarded([&] {
    SweepOptions options;
    if (!arguments.output.empty()) options.output = arguments.output;
    options.force = arguments.force;
    options.command = command;
    options.signal = &caught_signal;
    const bool progress = !arguments.quiet && isatty(STDERR_FILENO);
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

Exit check_one(const std::string& file, const std::vector<std::string>& sets) {
  return guarded([&] {
    const Experiment experiment = read_experiment(file, sets);
    check(experiment);
    std::cout << file << ": fine\n";
    return Exit::ok;
  });
}

}  // namespace

int osculate::program(int argc, char** argv) {
  std::string command;
  for (int i = 0; i < argc; ++i) command += (i ? " " : "") + std::string(argv[i]);

  CLI::App app{"Operational space control of serial arms: simulate it, and verify every step."};
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text());

  RunArguments arguments;
  const auto common = [&arguments](CLI::App* sub) {
    sub->add_option("--set", arguments.sets, "override a key: key.path=value")->allow_extra_args(false);
    sub->add_flag("--quiet", arguments.quiet, "no progress line");
  };
  CLI::App* run_command = app.add_subcommand("run", "run an experiment and record it");
  run_command->add_option("experiment", arguments.experiments, "EXPERIMENT.yaml")->required()->expected(1);
  run_command->add_option("-o,--output", arguments.output,
                          "result file; default: the experiment's name with .h5");
  run_command->add_flag("--force", arguments.force, "overwrite an existing result file");
  common(run_command);
  CLI::App* verify_command = app.add_subcommand("verify", "run experiments, record nothing but the verdict");
  verify_command->add_option("experiments", arguments.experiments, "EXPERIMENT.yaml ...")->required();
  common(verify_command);
  CLI::App* sweep_command = app.add_subcommand("sweep", "run each variant of an experiment, compare them");
  sweep_command->add_option("experiment", arguments.experiments, "EXPERIMENT.yaml with a section sweep")
      ->required()
      ->expected(1);
  sweep_command->add_option("-o,--output", arguments.output, "result file; default: none");
  sweep_command->add_flag("--force", arguments.force, "overwrite an existing result file");
  common(sweep_command);
  CLI::App* check_command = app.add_subcommand("check", "read and validate everything, run nothing");
  check_command->add_option("experiments", arguments.experiments, "EXPERIMENT.yaml ...")->required();
  common(check_command);

  TermsOptions term;
  std::string model, states, gravity, side_branches = "lump";
  const auto chain_options = [&](CLI::App* sub, bool tip_required) {
    sub->add_option("model", model, "MODEL.urdf")->required();
    sub->add_option("--base", term.choice.base, "base link; default: the root of the file");
    auto* tip = sub->add_option("--tip", term.choice.tip, "tip link");
    if (tip_required) tip->required();
    sub->add_option("--side-branches", side_branches, "lump or drop")->check(CLI::IsMember({"lump", "drop"}));
  };
  CLI::App* terms_command = app.add_subcommand("terms", "operational-space terms at given states, both ways");
  chain_options(terms_command, true);
  auto* q_option = terms_command->add_option("--q", term.q, "joint positions, base to tip, comma separated");
  terms_command->add_option("--qd", term.qd, "joint velocities; default 0");
  terms_command->add_option("--u", term.u, "commanded tip acceleration on the task rows; default 0");
  auto* states_option =
      terms_command->add_option("--states", states, "CSV of states: q, or q,qd, or q,qd,u in each line");
  terms_command->add_option("--rows", term.rows, "task rows, for instance vx,vy,vz; default all six");
  terms_command->add_option("--gravity", gravity, "free-fall acceleration X,Y,Z, base frame, m/s^2");
  terms_command->add_flag("--json", term.json, "one JSON object (an array with --states)");
  q_option->excludes(states_option);

  CLI::App* info_command = app.add_subcommand("info", "links, joints, masses, what was lumped, warnings");
  chain_options(info_command, false);

  PaperOptions paper_options;
  CLI::App* paper_command =
      app.add_subcommand("paper", "every equation of the paper, on an arm and over exact fractions");
  chain_options(paper_command, false);
  paper_command->add_option("--states", paper_options.states, "random states; default 100")
      ->check(CLI::Range(1, 1000000));
  paper_command->add_flag("--exact", paper_options.exact, "prove them over exact fractions too");
  paper_command->add_option("--arms", paper_options.arms, "--exact: arms of each size; default 20")
      ->check(CLI::Range(1, 10000));

  bool markdown = false;
  CLI::App* schema_command = app.add_subcommand(
      "schema", "the JSON Schema of experiment files, for editors that complete and check them");
  schema_command->add_flag("--markdown", markdown, "the tables of docs/experiment-file.md instead");

  std::string damaged, repaired;
  bool force_recover = false;
  CLI::App* recover_command = app.add_subcommand("recover", "make a complete file of what a killed run left");
  recover_command->add_option("file", damaged, "FILE.h5")->required();
  recover_command->add_option("-o,--output", repaired, "result; default: FILE.recovered.h5");
  recover_command->add_flag("--force", force_recover, "overwrite an existing file");

  AgainOptions again;
  const auto again_command = [&](const char* name, const char* about, const char* output) {
    CLI::App* sub = app.add_subcommand(name, about);
    sub->add_option("file", again.file, "FILE.h5")->required();
    sub->add_option("-o,--output", again.output, output);
    sub->add_flag("--force", again.force, "overwrite an existing file");
    sub->add_flag("--quiet", arguments.quiet, "no progress line");
    return sub;
  };
  CLI::App* replay_command = again_command(
      "replay", "run again from a result file alone, compare bit for bit", "keep the new result");
  CLI::App* resume_command = again_command("resume", "go on with a stopped run from its last restart point",
                                           "result; default: FILE.resumed.h5");
  std::string file_a, file_b;
  CLI::App* diff_command = app.add_subcommand("diff", "compare two result files bit for bit");
  diff_command->add_option("a", file_a, "A.h5")->required();
  diff_command->add_option("b", file_b, "B.h5")->required();

  std::string exported, csv;
  bool force_export = false;
  CLI::App* export_command = app.add_subcommand("export", "write a result file as tables of text");
  export_command->add_option("file", exported, "FILE.h5")->required();
  export_command->add_option("--csv", csv, "directory for comma-separated values")->required();
  export_command->add_flag("--force", force_export, "write into a directory that has files");

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    return app.exit(asked);  // help, version
  } catch (const CLI::ParseError& error) {
    app.exit(error);
    return static_cast<int>(Exit::bad_input);
  }

  // The others do not look at signals: they simply end.
  if (*run_command || *verify_command || *sweep_command || *replay_command || *resume_command)
    catch_signals();
  Exit worst = Exit::ok;
  if (*run_command || *verify_command) {
    for (const auto& file : arguments.experiments) {
      if (arguments.experiments.size() > 1) std::cout << file << "\n";
      worst = graver(worst, run_one(file, arguments, static_cast<bool>(*run_command), command));
      if (caught_signal != 0) break;
    }
  } else if (*sweep_command) {
    worst = sweep_one(arguments.experiments.front(), arguments, command);
  } else if (*check_command) {
    for (const auto& file : arguments.experiments) worst = graver(worst, check_one(file, arguments.sets));
  } else if (*terms_command || *info_command || *paper_command) {
    worst = guarded([&] {
      term.model = model;
      term.choice.side_branches = side_branches == "drop" ? SideBranches::drop : SideBranches::lump;
      if (!gravity.empty()) term.choice.gravity = parse_vector3(gravity, "--gravity");
      if (*info_command) return print_info(term.model, term.choice, std::cout);
      if (*paper_command) {
        paper_options.model = term.model;
        paper_options.choice = term.choice;
        return print_paper(paper_options, std::cout, std::cerr);
      }
      if (term.q.empty() && states.empty()) throw ConfigError("terms: give --q or --states");
      if (!states.empty()) term.states = states;
      return terms(term, std::cout, std::cerr);
    });
  } else if (*replay_command || *resume_command) {
    again.command = command;
    again.signal = &caught_signal;
    if (!arguments.quiet && isatty(STDERR_FILENO)) again.progress = show_progress;
    worst = guarded([&] {
      return *replay_command ? replay(again, std::cout, std::cerr) : resume(again, std::cout, std::cerr);
    });
  } else if (*diff_command) {
    worst = guarded([&] { return diff(file_a, file_b, std::cout); });
  } else if (*export_command) {
    worst = guarded([&] {
      const auto files = export_csv(exported, csv, force_export);
      std::cout << "exported into " << csv << ": " << files.size() << " files, described in columns.csv\n";
      return Exit::ok;
    });
  } else if (*schema_command) {
    std::cout << (markdown ? key_tables() : experiment_schema());
  } else if (*recover_command) {
    worst = contained(damaged, [&] {
      return guarded([&] {
        const auto made = recover(damaged, repaired, force_recover, still_alive);
        std::cout << "recovered into " << made.string() << "\n";
        return Exit::ok;
      });
    });
  }
  std::cout.flush();
  return static_cast<int>(std::cout ? worst : graver(worst, Exit::io_failure));
}
