// Measures the constants behind the verdict's bounds, and asks the arbiter who is right.
//   bounds_study COUNT [bounds.hpp bounds.md]   COUNT states from seed 1; prints the page and writes the two
//                                               files if named. The same for any number of threads.
//   bounds_study --check COUNT                  COUNT states from seed 1000001, which no study sees: counts
//                                               claims above their bound; exit code 1 if there are any
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <limits>
#include <sstream>
#include <thread>

#include "verification/arbiter.hpp"
#include "verification/bounds.hpp"
#include "verification/bounds_sample.hpp"

using namespace osculate;
using namespace osculate::testing;

namespace {

constexpr std::size_t claims = measured_bounds.size();
constexpr std::uint64_t study_seed = 1, check_seed = 1'000'001;
/// constant = margin * worst: room for states that the sample missed, below the allowed 5
constexpr double margin = 2.5;
/// Last links up to 10, up to 100, ... times as heavy as drawn; 0: as drawn.
constexpr std::size_t decades = 7;

/// The largest of what was seen, and the state it was seen in. Not-a-number counts as infinite.
struct Worst {
  double ratio = 0;
  std::uint64_t seed = 0;

  void see(double value, std::uint64_t at) {
    const double now = std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
    // Of equals the smallest seed, so that the order of looking does not matter.
    if (now > ratio || (now == ratio && at < seed)) *this = {now, at};
  }
};

/// Residuals in units of eps times the condition number: who was compared with whom.
struct Columns {
  Worst recursion_dense, recursion_truth, dense_truth;

  void see(const Columns& x) {
    recursion_dense.see(x.recursion_dense.ratio, x.recursion_dense.seed);
    recursion_truth.see(x.recursion_truth.ratio, x.recursion_truth.seed);
    dense_truth.see(x.dense_truth.ratio, x.dense_truth.seed);
  }
};

struct Sampled {
  std::uint64_t states = 0, singular = 0;  // singular: no finite torque, to working accuracy
  std::uint64_t shipped = 0, graded = 0, armature = 0, prismatic = 0, redundant = 0, slow = 0, chart = 0,
                mixed = 0;
  std::uint64_t nearly_singular = 0,
                ill_conditioned = 0;  // as drawn; condition of Omega, unit diagonal, above 1e6
  std::array<std::uint64_t, decades> heavy{};
  std::array<std::uint64_t, claims> judged{};

  void add(const Sampled& x) {
    states += x.states, singular += x.singular;
    shipped += x.shipped, graded += x.graded, armature += x.armature, prismatic += x.prismatic;
    redundant += x.redundant, slow += x.slow, chart += x.chart, mixed += x.mixed;
    nearly_singular += x.nearly_singular, ill_conditioned += x.ill_conditioned;
    for (std::size_t i = 0; i < decades; ++i) heavy[i] += x.heavy[i];
    for (std::size_t i = 0; i < claims; ++i) judged[i] += x.judged[i];
  }
};

struct Study {
  std::array<Columns, claims> worst{};
  std::array<Columns, decades> omega_by_tip{};  // the claim on Omega alone, by weight of the last link
  Sampled tally;

  void add(const Study& x) {
    for (std::size_t i = 0; i < claims; ++i) worst[i].see(x.worst[i]);
    for (std::size_t i = 0; i < decades; ++i) omega_by_tip[i].see(x.omega_by_tip[i]);
    tally.add(x.tally);
  }
};

std::size_t decade(double factor) {
  return factor > 1 ? static_cast<std::size_t>(std::ceil(std::log10(factor))) : 0;
}

/// eps times the condition number.
double unit(const Residual& r, std::size_t claim) { return r.bound / measured_bounds[claim].constant; }

void count_kind(const Sample& sample, Sampled& tally) {
  tally.states += 1;
  tally.shipped += sample.shipped;
  tally.graded += sample.graded;
  tally.armature += sample.armature();
  tally.prismatic += sample.prismatic();
  tally.redundant += sample.arm.chain.velocities() > 6;
  tally.slow += sample.slow;
  tally.chart += sample.chart;
  tally.mixed += sample.mixed;
  tally.nearly_singular += sample.nearly_singular;
  tally.heavy[decade(sample.heavy_tip)] += 1;
}

void look(std::uint64_t seed, Study& study) {
  const Sample sample = draw(seed);
  count_kind(sample, study.tally);
  Evidence e;
  try {
    e = evidence(sample);
  } catch (const IntegrationStopped&) {
    study.tally.singular += 1;
    return;
  }
  const Truth truth = testing::truth(sample.arm.chain, sample.arm.q, e.qd, e.rows);
  const Residuals both = assess(e);
  const Residuals recursion = against_truth(e, recursive_answers(e), truth);
  const Residuals dense = against_truth(e, dense_answers(e), truth);
  study.tally.ill_conditioned += scaled_condition(e.task.Omega) > 1e6;
  for (std::size_t i = 0; i < claims; ++i) {
    if (!both[i].applies || both[i].bound > undecided_bound) continue;
    study.tally.judged[i] += 1;
    const double one = unit(both[i], i);
    const Columns seen{
        {both[i].value / one, seed}, {recursion[i].value / one, seed}, {dense[i].value / one, seed}};
    study.worst[i].see(seen);
    if (i == index(Claim::omega)) study.omega_by_tip[decade(sample.heavy_tip)].see(seen);
  }
}

/// Applies `each(seed, result)` to `count` seeds on all processors. Result::add must not depend on the order.
template <class Result, class Each>
Result over_seeds(std::uint64_t first, std::uint64_t count, Each each) {
  const unsigned threads = std::max(1u, std::thread::hardware_concurrency());
  std::vector<Result> parts(threads);
  std::vector<std::thread> running;
  for (unsigned t = 0; t < threads; ++t)
    running.emplace_back([&, t] {
      for (std::uint64_t i = t; i < count; i += threads) each(first + i, parts[t]);
    });
  for (auto& thread : running) thread.join();
  Result out;
  for (const Result& part : parts) out.add(part);
  return out;
}

const char* condition_name(Claim claim) {
  switch (claim) {
    case Claim::kinematics:
      return "1";
    case Claim::omega:
    case Claim::linearization:
    case Claim::coordinates:
      return "spread of Omega";
    case Claim::forward_dynamics:
      return "M, unit diagonal";
    case Claim::null_space:
      return "Omega, scaled by block";
    default:
      return "Omega, scaled by block, times its spread";
  }
}

void print_columns(const Columns& x, std::ostream& out) {
  out << x.recursion_dense.ratio << " | " << x.recursion_truth.ratio << " | " << x.dense_truth.ratio << " | ";
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(1)
      << 100 * static_cast<double>(part) / static_cast<double>(std::max<std::uint64_t>(whole, 1)) << " %";
  return out.str();
}

void write_header(const Study& study, std::ostream& out) {
  out << "// Generated by tests/verification/bounds_study.cpp; see docs/bounds.md. Do not edit.\n#pragma "
         "once\n\n"
         "#include <array>\n\nnamespace osculate {\n\n"
         "struct MeasuredBound {\n  const char* claim;\n"
         "  double constant;     // bound = constant * eps * condition number; at most 5 times `worst`\n"
         "  double worst;        // largest residual / (eps * condition number) seen\n"
         "  unsigned long seed;  // state in which it was seen\n};\n"
      << "inline constexpr unsigned long measured_states = " << study.tally.states << ";\n"
      << "inline constexpr std::array<MeasuredBound, " << claims << "> measured_bounds{{\n"
      << std::setprecision(3);
  for (std::size_t i = 0; i < claims; ++i) {
    const Worst& worst = study.worst[i].recursion_dense;
    out << "    {\"" << measured_bounds[i].claim << "\", " << margin * worst.ratio << ", " << worst.ratio
        << ", " << worst.seed << "},\n";
  }
  out << "}};\n\n}  // namespace osculate\n";
}

void write_page(const Study& study, std::ostream& out) {
  const Sampled& n = study.tally;
  out << "# Measured bounds\n\nMade by `./dev bounds` from " << n.states << " states (seeds " << study_seed
      << " to " << study_seed + n.states - 1 << ").\n"
      << "Every number below is the largest residual seen, in units of eps = 2^-52 times the condition "
         "number "
         "of its row.\nThe bound of a claim is `constant` times that unit, and `constant` is "
      << margin
      << " times the worst of recursion against dense,\nwhich is what a run compares. The residuals are "
         "defined in `src/verification/claims.cpp`.\n\n"
      << "The arbiter (`tests/verification/arbiter.hpp`) is the dense formulation in 113-bit arithmetic at "
         "the "
         "same doubles, with\nrotations made orthonormal and axes made unit vectors to 113 bits. It says how "
         "far each side is from the truth, by the\nsame residuals. For `linearization` and `null_space` that "
         "is the torque of each side, felt by the true arm. For `coordinates`\nthe truth columns repeat the "
         "first: the judge there is the dense side itself.\nStates in which a bound exceeds "
      << undecided_bound << " are undecided in a run, and not judged here.\n\n"
      << "| claim | condition number | states judged | recursion against dense | recursion against truth | "
         "dense against truth | constant | seed |\n|---|---|---|---|---|---|---|---|\n"
      << std::setprecision(3);
  for (std::size_t i = 0; i < claims; ++i) {
    out << "| " << measured_bounds[i].claim << " | " << condition_name(static_cast<Claim>(i)) << " | "
        << n.judged[i] << " | ";
    print_columns(study.worst[i], out);
    out << margin * study.worst[i].recursion_dense.ratio << " | " << study.worst[i].recursion_dense.seed
        << " |\n";
  }

  out << "\n`seed` names the state of the worst of recursion against dense.\n\n## The sample\n\n"
      << "| kind | states | share |\n|---|---|---|\n";
  const auto row = [&](const char* kind, std::uint64_t count) {
    out << "| " << kind << " | " << count << " | " << percent(count, n.states) << " |\n";
  };
  row("an arm of `models/`", n.shipped);
  row("a random arm of 6 to 9 revolute and prismatic joints", n.states - n.shipped - n.mixed);
  row("a random arm with joints of all types", n.mixed);
  row("masses falling along the chain by up to 1000", n.graded);
  row("more than six coordinates", n.redundant);
  row("with armature on some joint", n.armature);
  row("without armature", n.states - n.armature);
  row("with a prismatic joint", n.prismatic);
  row("rates below 2e-3 rad/s or m/s", n.slow);
  row("law in operational coordinates of its own", n.chart);
  row("drawn nearly singular, 1e-6 to 1e-2 rad or m away", n.nearly_singular);
  row("condition of Omega, scaled to unit diagonal, above 1e6", n.ill_conditioned);
  row("singular to working accuracy: no finite torque", n.singular);

  out << "\n## Heavy tips\n\nThe claim on Omega, by how many times heavier than drawn the last link is.\n\n"
      << "| last link | states | recursion against dense | recursion against truth | dense against truth |\n"
      << "|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < decades; ++i) {
    if (i == 0)
      out << "| as drawn | ";
    else
      out << "| up to 1e" << i << " | ";
    out << n.heavy[i] << " | " << study.omega_by_tip[i].recursion_dense.ratio << " | "
        << study.omega_by_tip[i].recursion_truth.ratio << " | " << study.omega_by_tip[i].dense_truth.ratio
        << " |\n";
  }
}

struct Alarms {
  std::uint64_t states = 0, above = 0;
  std::array<Worst, claims> worst{};  // residual / bound

  void add(const Alarms& x) {
    states += x.states, above += x.above;
    for (std::size_t i = 0; i < claims; ++i) worst[i].see(x.worst[i].ratio, x.worst[i].seed);
  }
};

void check(std::uint64_t seed, Alarms& alarms) {
  alarms.states += 1;
  Residuals residuals;
  try {
    residuals = assess(sample_state(seed));
  } catch (const IntegrationStopped&) { return; }
  for (std::size_t i = 0; i < claims; ++i) {
    const Residual& r = residuals[i];
    if (!r.applies || r.bound > undecided_bound) continue;
    alarms.above += !(r.value <= r.bound);
    alarms.worst[i].see(r.value / r.bound, seed);
  }
}

int run_check(std::uint64_t count) {
  const auto alarms = over_seeds<Alarms>(check_seed, count, check);
  std::cout << "states " << alarms.states << ", claims above their bound " << alarms.above << "\n";
  for (std::size_t i = 0; i < claims; ++i)
    std::cout << std::setw(18) << measured_bounds[i].claim << "  largest residual / bound " << std::setw(12)
              << alarms.worst[i].ratio << "  seed " << alarms.worst[i].seed << "\n";
  return alarms.above == 0 ? 0 : 1;
}

int run_study(std::uint64_t count, const char* header_file, const char* page_file) {
  const auto study = over_seeds<Study>(study_seed, count, look);
  write_page(study, std::cout);
  for (std::size_t i = 0; i < claims; ++i) {
    const Worst& worst = study.worst[i].recursion_dense;
    if (study.tally.judged[i] > 0 && std::isfinite(worst.ratio)) continue;
    std::cerr << "bounds_study: claim " << measured_bounds[i].claim << ": "
              << (study.tally.judged[i] > 0 ? "not a finite residual" : "not judged in any state")
              << ", seed " << worst.seed << "; nothing written\n";
    return 1;
  }
  if (header_file == nullptr) return 0;
  std::ofstream header(header_file), page(page_file);
  write_header(study, header);
  write_page(study, page);
  return header && page ? 0 : 4;
}

/// A positive whole number, or 0.
std::uint64_t number(const char* text) {
  char* end = nullptr;
  const std::uint64_t out = std::isdigit(text[0]) ? std::strtoull(text, &end, 10) : 0;
  return out > 0 && *end == 0 ? out : 0;
}

}  // namespace

int main(int argc, char** argv) {
  const bool checks = argc == 3 && std::strcmp(argv[1], "--check") == 0;
  const std::uint64_t count = checks ? number(argv[2]) : argc == 2 || argc == 4 ? number(argv[1]) : 0;
  if (count == 0) {
    std::cerr << "usage: bounds_study COUNT [bounds.hpp bounds.md] | bounds_study --check COUNT\n";
    return 2;
  }
  if (checks) return run_check(count);
  return run_study(count, argc == 4 ? argv[2] : nullptr, argc == 4 ? argv[3] : nullptr);
}
