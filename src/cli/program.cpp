// osculate: the command line. Results to stdout, messages and the progress line to stderr.
#include "cli/program.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <csignal>
#include <functional>
#include <iostream>
#include <memory>

#include "cli/contained.hpp"
#include "cli/experiments.hpp"
#include "cli/guarded.hpp"
#include "cli/info.hpp"
#include "cli/judge.hpp"
#include "cli/jury.hpp"
#include "cli/lists.hpp"
#include "cli/paper.hpp"
#include "cli/reference.hpp"
#include "cli/replay.hpp"
#include "cli/terms.hpp"
#include "experiment/provenance.hpp"
#include "experiment/schema.hpp"
#include "record/export.hpp"
#include "record/log_table.hpp"
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

// One entry for each command: what the parser asks for, and what is done.

struct Subcommand {
  CLI::App* parser;
  std::function<Exit()> act;
  bool ends_by_itself = false;  // at a signal it finishes its file; the others simply end
};

/// What every entry is made with.
struct Entry {
  CLI::App& app;
  std::string line;  // the command line, for the provenance
  std::vector<Subcommand> commands = {};

  CLI::App* parser(const char* name, const char* about) { return app.add_subcommand(name, about); }
  void add(CLI::App* parser, std::function<Exit()> act, bool ends_by_itself = false) {
    commands.push_back({parser, std::move(act), ends_by_itself});
  }
};

void add_force(CLI::App* sub, bool& force) { sub->add_flag("--force", force, "overwrite an existing file"); }

/// MODEL.urdf, --base, --tip, --gravity, --side-branches.
struct ModelArguments {
  std::string model;
  ChainChoice choice;

  /// `name`: a position, or an option that may be left out.
  void add_to(CLI::App* sub, bool tip_required, const std::string& name = "model") {
    sub->add_option(name, model, "MODEL.urdf")->required(name == "model");
    sub->add_option("--base", choice.base, "base link; default: the root of the file");
    sub->add_option("--tip", choice.tip, "tip link")->required(tip_required);
    sub->add_option("--side-branches", side_branches_, "lump or drop")
        ->check(CLI::IsMember({"lump", "drop"}));
  }
  void add_gravity_to(CLI::App* sub) {
    sub->add_option("--gravity", gravity_, "free-fall acceleration X,Y,Z, base frame, m/s^2");
  }
  /// What was asked for. Throws ConfigError.
  ChainChoice chosen() const {
    ChainChoice out = choice;
    out.side_branches = side_branches_ == "drop" ? SideBranches::drop : SideBranches::lump;
    if (!gravity_.empty()) out.gravity = parse_vector3(gravity_, "--gravity");
    return out;
  }

 private:
  std::string gravity_, side_branches_ = "lump";
};

/// --set, --quiet, and with an `output` what that is by default, -o and --force.
std::shared_ptr<RunArguments> run_arguments(const Entry& entry, CLI::App* sub, bool one,
                                            const char* output = nullptr) {
  auto arguments = std::make_shared<RunArguments>();
  arguments->line = entry.line;
  arguments->signal = &caught_signal;
  CLI::Option* files =
      sub->add_option("experiment", arguments->experiments, one ? "EXPERIMENT.yaml" : "EXPERIMENT.yaml ...")
          ->required();
  if (one) files->expected(1);
  if (output) {
    sub->add_option("-o,--output", arguments->output, output);
    add_force(sub, arguments->force);
  }
  sub->add_option("--set", arguments->sets, "override a key: key.path=value")->allow_extra_args(false);
  sub->add_flag("--quiet", arguments->quiet, "no progress line");
  return arguments;
}

/// Each experiment by itself; the gravest exit code of all.
template <class One>
Exit each(const std::vector<std::string>& files, bool heading, const One& one) {
  Exit worst = Exit::ok;
  for (const auto& file : files) {
    if (heading && files.size() > 1) std::cout << file << "\n";
    worst = graver(worst, one(file));
    if (caught_signal != 0) break;
  }
  return worst;
}

void add_run(Entry& entry) {
  CLI::App* sub = entry.parser("run", "run an experiment and record it");
  const auto arguments =
      run_arguments(entry, sub, true, "result file; default: the experiment's name with .h5");
  entry.add(
      sub, [=] { return run_one(arguments->experiments.front(), *arguments, true); }, true);
}

void add_verify(Entry& entry) {
  CLI::App* sub = entry.parser("verify", "run experiments, record nothing but the verdict");
  const auto arguments = run_arguments(entry, sub, false);
  entry.add(
      sub,
      [=] {
        return each(arguments->experiments, true,
                    [&](const std::string& file) { return run_one(file, *arguments, false); });
      },
      true);
}

void add_sweep(Entry& entry) {
  CLI::App* sub = entry.parser("sweep", "run each variant of an experiment, compare them");
  const auto arguments = run_arguments(entry, sub, true, "result file; default: none");
  entry.add(
      sub, [=] { return sweep_one(arguments->experiments.front(), *arguments); }, true);
}

void add_check(Entry& entry) {
  CLI::App* sub = entry.parser("check", "read and validate everything, run nothing");
  const auto arguments = run_arguments(entry, sub, false);
  entry.add(sub, [=] {
    return each(arguments->experiments, false,
                [&](const std::string& file) { return check_one(file, *arguments); });
  });
}

void add_terms(Entry& entry) {
  CLI::App* sub = entry.parser("terms", "operational-space terms at given states, both ways");
  const auto arm = std::make_shared<ModelArguments>();
  const auto options = std::make_shared<TermsOptions>();
  const auto states = std::make_shared<std::string>();
  arm->add_to(sub, true);
  auto* q = sub->add_option("--q", options->q, "joint positions, base to tip, comma separated");
  sub->add_option("--qd", options->qd, "joint velocities; default 0");
  sub->add_option("--u", options->u, "commanded tip acceleration on the task rows; default 0");
  auto* file = sub->add_option("--states", *states, "CSV of states: q, or q,qd, or q,qd,u in each line");
  sub->add_option("--rows", options->rows, "task rows, for instance vx,vy,vz; default all six");
  arm->add_gravity_to(sub);
  sub->add_flag("--json", options->json, "one JSON object (an array with --states)");
  q->excludes(file);
  entry.add(sub, [=] {
    options->model = arm->model;
    options->choice = arm->chosen();
    if (options->q.empty() && states->empty()) throw ConfigError("terms: give --q or --states");
    if (!states->empty()) options->states = *states;
    return terms(*options, std::cout, std::cerr);
  });
}

void add_info(Entry& entry) {
  CLI::App* sub = entry.parser("info", "links, joints, masses, what was lumped, warnings");
  const auto arm = std::make_shared<ModelArguments>();
  arm->add_to(sub, false);
  entry.add(sub, [=] { return print_info(arm->model, arm->chosen(), std::cout); });
}

void add_paper(Entry& entry) {
  CLI::App* sub = entry.parser("paper", "every equation of the paper, on an arm and over exact fractions");
  const auto arm = std::make_shared<ModelArguments>();
  const auto options = std::make_shared<PaperOptions>();
  arm->add_to(sub, false);
  sub->add_option("--states", options->states, "random states; default 100")->check(CLI::Range(1, 1000000));
  sub->add_flag("--exact", options->exact, "prove them over exact fractions too");
  sub->add_option("--arms", options->arms, "--exact: arms of each size; default 20")
      ->check(CLI::Range(1, 10000));
  entry.add(sub, [=] {
    options->model = arm->model;
    options->choice = arm->chosen();
    return print_paper(*options, std::cout, std::cerr);
  });
}

void add_judge(Entry& entry) {
  CLI::App* sub = entry.parser("judge", "which terms of the exact law a logged torque lacks");
  const auto arm = std::make_shared<ModelArguments>();
  const auto options = std::make_shared<JudgeArguments>();
  sub->add_option("log", options->log, "LOG.csv, LOG.h5, or a result file of osculate run")->required();
  arm->add_to(sub, false, "--model");
  arm->add_gravity_to(sub);
  sub->add_option("--armature", options->armature, "reflected motor inertia of each joint, base to tip");
  sub->add_option("--viscous", options->viscous, "viscous friction of each joint that the law compensates");
  sub->add_option("--rows", options->rows, "task rows, for instance vx,vy,vz; default all six");
  const auto choice = [&](const char* name, std::string& into, std::vector<std::string> values,
                          const char* about) {
    sub->add_option(name, into, about)->check(CLI::IsMember(std::move(values)));
  };
  choice("--u-order", options->u_order, {"angular", "linear"}, "which rows of u come first");
  choice("--quaternion", options->quaternion, {"wxyz", "xyzw"}, "order of the reference's quaternion");
  choice("--acceleration", options->acceleration, {"classical", "spatial"}, "what u is; default classical");
  sub->add_option("--stiffness", options->stiffness, "gains of pose tracking, 1/s^2: one number or six");
  sub->add_option("--damping", options->damping, "gains of pose tracking, 1/s: one number or six");
  sub->add_option("--samples", options->samples, "samples used for the fit; default 500")
      ->check(CLI::Range(50, 1000000));
  sub->add_flag("--json", options->json, "one JSON object");
  entry.add(sub, [=] {
    options->model = arm->model;
    options->choice = arm->chosen();
    if (is_hdf5(options->log))
      if (const Exit readable = try_reading(options->log); readable != Exit::ok) return readable;
    return print_judgement(*options, std::cout, std::cerr);
  });
}

void add_reference(Entry& entry) {
  CLI::App* sub =
      entry.parser("reference", "all terms at seeded states, to the last bit, for tests of others");
  const auto arm = std::make_shared<ModelArguments>();
  const auto options = std::make_shared<ReferenceOptions>();
  arm->add_to(sub, true);
  arm->add_gravity_to(sub);
  sub->add_option("--states", options->states, "how many; the first is at rest, the second nearly singular")
      ->required()
      ->check(CLI::Range(2, 1000000));
  sub->add_option("--seed", options->seed, "start of the random numbers; default 1");
  sub->add_option("--rows", options->rows, "task rows, for instance vx,vy,vz; default all six");
  sub->add_option("--armature", options->armature, "rotor inertia of each joint, base to tip; default 0");
  sub->add_option("-o,--output", options->output, "FILE.h5 or FILE.json")->required();
  add_force(sub, options->force);
  entry.add(sub, [=] {
    options->model = arm->model;
    options->choice = arm->chosen();
    return reference(*options, std::cout, std::cerr);
  });
}

void add_jury(Entry& entry) {
  CLI::App* sub = entry.parser("jury", "ours against KDL, MuJoCo, Simbody and DART, pair by pair");
  const auto arm = std::make_shared<ModelArguments>();
  const auto arguments = std::make_shared<JuryArguments>();
  arm->add_to(sub, false);
  arm->add_gravity_to(sub);
  sub->add_option("--states", arguments->states, "random states; default 100")->check(CLI::Range(1, 1000000));
  sub->add_option("--seed", arguments->seed, "start of the random numbers; default 1");
  sub->add_option("--rows", arguments->rows, "task rows, for instance vx,vy,vz; default all six");
  sub->add_flag("--solid", arguments->solid, "raise masses and inertias that no body has, for all members");
  sub->add_option("--disturb", arguments->disturb,
                  "NAME:x, the last mass times 1 + x in one library: shows that the jury sees it");
  sub->add_flag("--json", arguments->json, "one JSON object");
  entry.add(sub, [=] {
    arguments->model = arm->model;
    arguments->choice = arm->chosen();
    return print_jury(*arguments, std::cout, std::cerr);
  });
}

/// replay and resume.
void add_again(Entry& entry, const char* name, const char* about, const char* output,
               Exit (*act)(const AgainOptions&, std::ostream&, std::ostream&)) {
  CLI::App* sub = entry.parser(name, about);
  const auto options = std::make_shared<AgainOptions>();
  const auto quiet = std::make_shared<bool>(false);
  sub->add_option("file", options->file, "FILE.h5")->required();
  sub->add_option("-o,--output", options->output, output);
  add_force(sub, options->force);
  sub->add_flag("--run-controller", options->run_controller,
                "run the controller of a user's own that the file names");
  sub->add_flag("--quiet", *quiet, "no progress line");
  options->command = entry.line;
  options->signal = &caught_signal;
  entry.add(
      sub,
      [=] {
        if (!*quiet && isatty(STDERR_FILENO)) options->progress = show_progress;
        const Exit readable = try_reading(options->file);
        return readable == Exit::ok ? act(*options, std::cout, std::cerr) : readable;
      },
      true);
}

void add_diff(Entry& entry) {
  CLI::App* sub = entry.parser("diff", "compare two result files bit for bit");
  const auto files = std::make_shared<std::array<std::string, 2>>();
  sub->add_option("a", (*files)[0], "A.h5")->required();
  sub->add_option("b", (*files)[1], "B.h5")->required();
  entry.add(sub, [=] {
    for (const std::string& file : *files)
      if (const Exit readable = try_reading(file); readable != Exit::ok) return readable;
    return diff((*files)[0], (*files)[1], std::cout);
  });
}

/// A file that becomes another one.
struct Conversion {
  std::string from, to;
  bool force = false;
};

void add_export(Entry& entry) {
  CLI::App* sub = entry.parser("export", "write a result file as tables of text");
  const auto files = std::make_shared<Conversion>();
  sub->add_option("file", files->from, "FILE.h5")->required();
  sub->add_option("--csv", files->to, "directory for comma-separated values")->required();
  sub->add_flag("--force", files->force, "write into a directory that has files");
  entry.add(sub, [=] {
    if (const Exit readable = try_reading(files->from); readable != Exit::ok) return readable;
    const auto made = export_csv(files->from, files->to, files->force);
    std::cout << "exported into " << files->to << ": " << made.size() << " files, described in columns.csv\n";
    return Exit::ok;
  });
}

void add_recover(Entry& entry) {
  CLI::App* sub = entry.parser("recover", "make a complete file of what a killed run left");
  const auto files = std::make_shared<Conversion>();
  sub->add_option("file", files->from, "FILE.h5")->required();
  sub->add_option("-o,--output", files->to, "result; default: FILE.recovered.h5");
  add_force(sub, files->force);
  entry.add(sub, [=] {
    return contained(files->from, [&] {
      return guarded([&] {
        const auto made = recover(files->from, files->to, files->force, still_alive);
        std::cout << "recovered into " << made.string() << "\n";
        return Exit::ok;
      });
    });
  });
}

void add_schema(Entry& entry) {
  CLI::App* sub =
      entry.parser("schema", "the JSON Schema of experiment files, for editors that complete and check them");
  const auto markdown = std::make_shared<bool>(false);
  sub->add_flag("--markdown", *markdown, "the tables of docs/experiment-file.md instead");
  entry.add(sub, [=] {
    std::cout << (*markdown ? key_tables() : experiment_schema());
    return Exit::ok;
  });
}

}  // namespace

int osculate::program(int argc, char** argv) {
  CLI::App app{"Operational space control of serial arms: simulate it, and verify every step."};
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text());

  Entry entry{app, ""};
  for (int i = 0; i < argc; ++i) entry.line += (i ? " " : "") + std::string(argv[i]);
  add_run(entry);
  add_verify(entry);
  add_sweep(entry);
  add_check(entry);
  add_terms(entry);
  add_info(entry);
  add_paper(entry);
  add_judge(entry);
  add_reference(entry);
  add_jury(entry);
  add_schema(entry);
  add_recover(entry);
  add_again(entry, "replay", "run again from a result file alone, compare bit for bit", "keep the new result",
            replay);
  add_again(entry, "resume", "go on with a stopped run from its last restart point",
            "result; default: FILE.resumed.h5", resume);
  add_diff(entry);
  add_export(entry);

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    return app.exit(asked);  // help, version
  } catch (const CLI::ParseError& error) {
    app.exit(error);
    return static_cast<int>(Exit::bad_input);
  }

  Exit code = Exit::ok;
  for (const Subcommand& command : entry.commands) {
    if (!*command.parser) continue;
    if (command.ends_by_itself) catch_signals();
    code = guarded(command.act);
  }
  std::cout.flush();
  return static_cast<int>(std::cout ? code : graver(code, Exit::io_failure));
}
