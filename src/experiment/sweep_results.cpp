// What becomes of the runs of a sweep: slopes, text and result file.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "experiment/sweep.hpp"

namespace osculate {

namespace {

constexpr double none = SweepRun::none;

/// A number that each run has. In the result file `path` along the axis `variant`.
struct Quantity {
  const char* path;
  const char* unit;
  const char* long_name;
  double SweepRun::*of;
  const char* label = nullptr;  // with a label: slopes are fitted to it
};

constexpr std::array<Quantity, 17> quantities{{
    {"tip_error_position", "m", "largest tracking error of the tip point", &SweepRun::position,
     "tip error, position"},
    {"tip_error_orientation", "rad", "largest tracking error of the tip axes", &SweepRun::orientation,
     "tip error, orientation"},
    {"tip_error_position_rms", "m", "root mean square over time of the tip point's tracking error",
     &SweepRun::position_rms, "rms tip error, position"},
    {"tip_error_orientation_rms", "rad", "root mean square over time of the tip axes' tracking error",
     &SweepRun::orientation_rms, "rms tip error, orientation"},
    {"missed_acceleration_linear", "m/s^2",
     "largest length of tip acceleration minus command, linear task rows", &SweepRun::linear_missed,
     "missed acceleration, linear"},
    {"missed_acceleration_angular", "rad/s^2",
     "largest length of tip acceleration minus command, angular task rows", &SweepRun::angular_missed,
     "missed acceleration, angular"},
    {"peak_torque", "", "largest joint torque, N m, or force, N", &SweepRun::torque},
    {"peak_torque_joint", "1", "velocity coordinate with the largest torque or force, 1 at the base",
     &SweepRun::torque_joint},
    {"closed_form_position", "m", "largest distance of the tip from the closed-form solution",
     &SweepRun::analytic_position, "from closed form, position"},
    {"closed_form_orientation", "rad", "largest angle between the tip and the closed-form solution",
     &SweepRun::analytic_orientation, "from closed form, orientation"},
    {"global_error_position", "m", "estimate of the tip position's true error", &SweepRun::error_position,
     "global error, position"},
    {"global_error_orientation", "rad", "estimate of the tip orientation's true error",
     &SweepRun::error_orientation, "global error, orientation"},
    {"end_time", "s", "simulated time", &SweepRun::end_time},
    {"steps", "1", "accepted integrator steps", &SweepRun::steps},
    {"rhs_evaluations", "1", "right-hand side evaluations", &SweepRun::rhs_evaluations},
    {"exit_code", "1", "what osculate verify would exit with", &SweepRun::exit_code},
    {"timing/wall", "s", "wall time of simulation, shadow run and checks", &SweepRun::wall_time},
}};

bool all_have_values(const SweepResult& result) {
  return std::all_of(result.runs.begin(), result.runs.end(),
                     [](const SweepRun& run) { return run.value.has_value(); });
}

std::string text(double x, double unit = 1) {
  if (std::isnan(x)) return "-";
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.3g", x / unit);
  return digits;
}

/// With so many decimals.
std::string fixed(double x, int decimals) {
  if (std::isnan(x)) return "-";
  char digits[64];
  std::snprintf(digits, sizeof digits, "%.*f", decimals, x);
  return digits;
}

std::string count(double x) { return fixed(x, 0); }

using Rows = std::vector<std::vector<std::string>>;

/// Characters, not bytes.
std::size_t width_of(const std::string& utf8) {
  return static_cast<std::size_t>(
      std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

/// Columns of equal width; the first `left` ones aligned to the left.
std::string aligned(const Rows& rows, std::size_t left) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths.resize(std::max(widths.size(), i + 1));
      widths[i] = std::max(widths[i], width_of(row[i]));
    }
  std::string out;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string space(widths[i] - width_of(row[i]), ' ');
      line += (i > 0 ? "  " : "") + (i < left ? row[i] + space : space + row[i]);
    }
    out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return out;
}

std::string slope_text(const SweepResult& result) {
  const auto found = slopes(result);
  if (found.empty())
    return all_have_values(result) ? "\nno slopes: they need at least 3 values, all above 0\n" : "";
  Rows rows{{"quantity", "slope", "spread", "from each variant to the next"}};
  for (const Slope& slope : found) {
    if (!slope.fit) continue;
    std::vector<std::string> row{slope.label, fixed(slope.fit->slope, 3), fixed(slope.fit->spread, 4), ""};
    for (std::size_t i = 1; i < slope.fit->between.size(); ++i)
      row[3] += (i > 1 ? "  " : "") + fixed(slope.fit->between[i], 3);
    rows.push_back(std::move(row));
  }
  if (rows.size() == 1) return "\nno slopes: fewer than 3 variants ran to the end with errors above 0\n";
  return "\nd log(quantity) / d log(" + result.key + "); spread: rms of log10(quantity) about the fit\n" +
         aligned(rows, 1);
}

}  // namespace

std::optional<SlopeFit> fit_slope(std::span<const double> values, std::span<const double> quantities_of) {
  const auto usable = [&](std::size_t i) {
    return std::isfinite(values[i]) && values[i] > 0 && std::isfinite(quantities_of[i]) &&
           quantities_of[i] > 0;
  };
  const auto x = [&](std::size_t i) { return std::log10(values[i]); };
  const auto y = [&](std::size_t i) { return std::log10(quantities_of[i]); };
  SlopeFit fit;
  double mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!usable(i)) continue;
    ++fit.points;
    mean_x += (x(i) - mean_x) / fit.points;
    mean_y += (y(i) - mean_y) / fit.points;
  }
  double xx = 0, xy = 0;
  bool alike = true;
  for (std::size_t i = 0, first = values.size(); i < values.size(); ++i) {
    if (!usable(i)) continue;
    if (first == values.size()) first = i;
    alike = alike && values[i] == values[first];
    xx += (x(i) - mean_x) * (x(i) - mean_x);
    xy += (x(i) - mean_x) * (y(i) - mean_y);
  }
  if (fit.points < 3 || alike || xx == 0) return std::nullopt;
  fit.slope = xy / xx;
  double squares = 0;
  fit.between.assign(values.size(), none);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!usable(i)) continue;
    const double off = y(i) - mean_y - fit.slope * (x(i) - mean_x);
    squares += off * off;
    if (i > 0 && usable(i - 1) && values[i] != values[i - 1])
      fit.between[i] = (y(i) - y(i - 1)) / (x(i) - x(i - 1));
  }
  fit.spread = std::sqrt(squares / fit.points);
  return fit;
}

std::vector<Slope> slopes(const SweepResult& result) {
  if (result.runs.size() < 3 || !all_have_values(result)) return {};
  std::vector<double> values;
  for (const SweepRun& run : result.runs) values.push_back(*run.value);
  if (!std::all_of(values.begin(), values.end(), [](double x) { return x > 0; })) return {};
  std::vector<Slope> out;
  for (const Quantity& quantity : quantities) {
    if (!quantity.label) continue;
    std::vector<double> ys;
    for (const SweepRun& run : result.runs) ys.push_back(run.status == "complete" ? run.*quantity.of : none);
    out.push_back({quantity.path, quantity.label, fit_slope(values, ys)});
  }
  return out;
}

std::string report(const SweepResult& result) {
  Rows rows{{"variant", "status", "verdict", "tip error", "", "rms", "missed", "", "torque", "joint",
             "closed form", "", "global error", "", "steps", "rhs"},
            {"", "", "", "mm", "mrad", "mm", "m/s^2", "rad/s^2", "N m, N", "", "mm", "mrad", "mm", "mrad"}};
  for (const SweepRun& run : result.runs)
    rows.push_back({run.name, run.status, run.verdict.empty() ? "-" : run.verdict, text(run.position, 1e-3),
                    text(run.orientation, 1e-3), text(run.position_rms, 1e-3), text(run.linear_missed),
                    text(run.angular_missed), text(run.torque), count(run.torque_joint),
                    text(run.analytic_position, 1e-3), text(run.analytic_orientation, 1e-3),
                    text(run.error_position, 1e-3), text(run.error_orientation, 1e-3), count(run.steps),
                    count(run.rhs_evaluations)});
  std::string out = result.name;
  if (!result.key.empty()) out += ", over " + result.key;
  out += "\n" + aligned(rows, 3);
  for (const SweepRun& run : result.runs)
    if (!run.message.empty()) out += run.name + ": " + run.message + "\n";
  return out + slope_text(result);
}

Layout sweep_layout(const SweepResult& planned, std::vector<Text> provenance, const NamedFiles& files) {
  Layout layout;
  layout.title = planned.name;
  std::vector<std::string> names, changes;
  for (const SweepRun& run : planned.runs) {
    names.push_back(run.name);
    changes.push_back(run.changes);
  }
  layout.axes = {{"variant", names, "", "variants of the experiment"}};
  layout.lists = {{"changes", "variant", changes, "key.path=value, one a line, as of --set"}};
  std::vector<std::string> paths, texts;
  for (const auto& [path, text] : files) {
    paths.push_back(path);
    texts.push_back(text);
  }
  layout.axes.push_back({"file", paths, "", "files that the variants name"});
  layout.lists.push_back({"provenance/file_text", "file", texts, "what was in them"});
  layout.texts = std::move(provenance);
  layout.texts.push_back({"provenance/swept_key", planned.key, "the key that changes, if it is one"});
  return layout;
}

Ending sweep_ending(const SweepResult& result) {
  Ending ending;
  const auto along_variants = [&](auto of) {
    std::vector<double> out;
    for (const SweepRun& run : result.runs) out.push_back(of(run));
    return out;
  };
  const auto texts = [&](const std::string& path, std::string SweepRun::*of, const std::string& long_name) {
    std::vector<std::string> out;
    for (const SweepRun& run : result.runs) out.push_back(run.*of);
    ending.lists.push_back({path, "variant", out, long_name});
  };
  if (all_have_values(result))
    ending.tables.push_back(
        {"value", {"variant"}, "", "value of " + result.key, along_variants([](const SweepRun& run) {
           return *run.value;
         })});
  texts("status", &SweepRun::status, "complete, failed, interrupted, refused or not_run");
  texts("verdict", &SweepRun::verdict, "pass, fail, as_expected, or empty");
  texts("message", &SweepRun::message, "why a run stopped or was not as expected");
  for (const Quantity& quantity : quantities)
    ending.tables.push_back({quantity.path,
                             {"variant"},
                             quantity.unit,
                             quantity.long_name,
                             along_variants([&](const SweepRun& run) { return run.*quantity.of; })});

  const auto found = slopes(result);
  if (found.empty()) return ending;
  Axis axis{"slopes/quantity", {}, "", "quantity that is fitted"};
  Table slope{"slopes/slope", {axis.name}, "1", "d log(quantity) / d log(value), least squares", {}};
  Table spread{"slopes/spread", {axis.name}, "1", "root mean square of log10(quantity) about the fit", {}};
  Table points{"slopes/points", {axis.name}, "1", "variants that the fit could use", {}};
  Table between{
      "slopes/between", {axis.name, "variant"}, "1", "slope from the variant before to this one", {}};
  for (const auto& [quantity, label, fit] : found) {
    axis.labels.push_back(quantity);
    slope.values.push_back(fit ? fit->slope : none);
    spread.values.push_back(fit ? fit->spread : none);
    points.values.push_back(fit ? fit->points : 0);
    for (std::size_t i = 0; i < result.runs.size(); ++i)
      between.values.push_back(fit ? fit->between[i] : none);
  }
  ending.axes.push_back(std::move(axis));
  for (Table* table : {&slope, &spread, &points, &between}) ending.tables.push_back(std::move(*table));
  return ending;
}

std::string sweep_status(const SweepResult& result) {
  return result.exit == Exit::interrupted || result.exit == Exit::terminated ? "interrupted" : "complete";
}

std::string sweep_verdict(const SweepResult& result) {
  if (result.exit != Exit::ok) return "fail";
  const bool all_pass = std::all_of(result.runs.begin(), result.runs.end(),
                                    [](const SweepRun& run) { return run.verdict == "pass"; });
  return all_pass ? "pass" : "as_expected";
}

}  // namespace osculate
