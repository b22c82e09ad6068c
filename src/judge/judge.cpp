#include "judge/judge.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <list>
#include <sstream>

#include "judge/deciding_motion.hpp"
#include "judge/examination.hpp"

namespace osculate {

namespace {

using Eigen::Index;

constexpr double significant = 5;  // standard deviations
constexpr double decisive = 2;     // squares: one reading of a log must leave so much less than another
constexpr double hopeless_at_sight =
    10;  // squares: a reading that leaves so much more at first sight is not looked at
constexpr double unexplained_part = 2e-3;
constexpr double white = 0.3;  // correlation of neighbouring samples below which a rest is noise
constexpr std::size_t most_doubts = 3;
constexpr double unseen_deviation = 0.1;  // of a coefficient that is -1 where the term is omitted

std::string format(const char* how, double x) {
  char text[48];
  std::snprintf(text, sizeof text, how, x);
  return text;
}
std::string number(double x) { return format("%.4g", x); }
std::string percent(double x) {
  const double p = 100 * std::clamp(x, 0.0, 1.0);
  return (p > 99.95 ? "100" : format(p < 0.05 ? "%.1g" : "%.1f", p)) + " %";
}
/// "-1.00 +- 0.01": as many digits as the deviation allows.
std::string measured(double value, double deviation) {
  const int digits =
      deviation > 0 ? std::clamp(static_cast<int>(std::ceil(-std::log10(deviation))), 2, 6) : 6;
  char text[80];
  if (deviation < 5e-7)
    std::snprintf(text, sizeof text, "%.*f +- %.1g", digits, value, deviation);
  else
    std::snprintf(text, sizeof text, "%.*f +- %.*f", digits, value, digits, deviation);
  return text;
}
std::string measured(const Coefficient& c) {
  return c.name + " " +
         (std::abs(c.value) < 0.005 ? format("%.3g", c.value) + " +- " + format("%.1g", c.deviation)
                                    : measured(c.value, c.deviation)) +
         (c.unit == "1" ? "" : " " + c.unit);
}
std::string listed(const std::vector<Coefficient>& all) {
  std::string out;
  for (const Coefficient& c : all) out += (out.empty() ? "" : ", ") + measured(c);
  return out;
}
bool near(double x, double target, double deviation) {
  return std::abs(x - target) <= std::max(0.03, 3 * deviation) && deviation < 0.3;
}

/// What a term of the exact law with this coefficient means.
std::string about_term(const std::string& phrase, const Coefficient& c) {
  if (near(c.value, -1, c.deviation)) return "omits " + phrase;
  if (near(c.value, -2, c.deviation)) return "has the wrong sign of " + phrase;
  if (near(c.value, 1, c.deviation)) return "counts " + phrase + " twice";
  return "takes " + phrase + " times " + format("%.6g", 1 + c.value);
}

class Words {
 public:
  Words(const Examination& examination, const Chain<double>& model)
      : examination_(examination), model_(model) {}

  Candidate candidate(int g) const {
    if (g != examination_.delay_group()) return examination_.candidates().list()[static_cast<std::size_t>(g)];
    return {"delay",   "a delay", CandidateKind::parameter, examination_.candidates().columns(), 1,
            {"delay"}, {"s"}};
  }

  Finding finding(int g) const {
    const Fit& fit = examination_.best();
    const Candidate c = candidate(g);
    Finding out;
    out.term = c.id;
    out.coefficients = coefficients(c, fit);
    out.explained = examination_.explained_by(g);
    out.sentence = sentence(c, out.coefficients);
    out.sentence +=
        c.kind == CandidateKind::term || (c.kind == CandidateKind::mistake && c.columns == 1)
            ? " (coefficient " + measured(out.coefficients[0].value, out.coefficients[0].deviation) + "; "
            : " (";
    out.sentence += "explains " + percent(out.explained) + ")";
    return out;
  }

  std::vector<Coefficient> coefficients(const Candidate& c, const Fit& fit) const {
    std::vector<Coefficient> out;
    for (int i = 0; i < c.columns; ++i) {
      const auto k = static_cast<std::size_t>(i);
      out.push_back({k < c.names.size() ? c.names[k] : c.id, k < c.units.size() ? c.units[k] : "1",
                     fit.beta[c.first + i] + offset(c.id, i),
                     fit.deviation[c.first + i] * std::sqrt(examination_.noise_square())});
    }
    return out;
  }

  std::string sentence(const Candidate& c, const std::vector<Coefficient>& values) const {
    if (c.kind == CandidateKind::term) return about_term(c.phrase, values[0]);
    if (c.kind == CandidateKind::mistake) {
      if (c.columns == 1)
        return c.phrase + (near(values[0].value, 1, values[0].deviation) ? "" : ", in part");
      if (c.id == "constant_lambda") {
        const bool whole = near(values[0].value, 1, values[0].deviation);
        return c.phrase + ": " + listed({values.begin() + (whole ? 1 : 0), values.end()});
      }
      return c.phrase;
    }
    std::vector<Coefficient> clear;
    for (const Coefficient& v : values)
      if (v.deviation > 0 && std::abs(v.value) > significant * v.deviation) clear.push_back(v);
    const std::string numbers = listed(clear.empty() ? values : clear);
    if (c.id == "armature") {
      bool all_of_it = true;
      for (std::size_t i = 0; i < values.size(); ++i)
        all_of_it =
            all_of_it && std::abs(values[i].value + model_.links[i].armature) <=
                             std::max(significant * values[i].deviation, 0.03 * model_.links[i].armature);
      const bool any = std::any_of(model_.links.begin(), model_.links.end(),
                                   [](const Link<double>& link) { return link.armature > 0; });
      return (all_of_it && any ? "omits the armature: "
                               : "believes in another armature than the model's: by ") +
             numbers;
    }
    if (c.id == "payload") return "believes in another load at the tip than the model's: by " + numbers;
    if (c.id == "tip_point") return "controls another point than the tip: off by " + numbers + ", tip axes";
    if (c.id == "torque_scale") return "scales torques: by " + numbers;
    if (c.id == "gravity_vector") return "believes in another gravity: by " + numbers;
    if (c.id == "delay") return "is late: " + numbers;
    return (std::all_of(clear.begin(), clear.end(), [](const Coefficient& v) { return v.value < 0; })
                ? "lacks " + c.phrase + " of the model, or subtracts some: "
                : "adds " + c.phrase + ": ") +
           numbers;
  }

 private:
  double offset(const std::string& id, int i) const {
    if (id == "armature") return examination_.belief().armature[i];
    if (id == "payload") return examination_.belief().payload[i];
    if (id == "tip_point") return examination_.belief().tip_offset[i];
    if (id == "delay") return examination_.delay();
    return 0;
  }

  const Examination& examination_;
  const Chain<double>& model_;
};

bool contains(const std::vector<int>& all, const std::vector<int>& part) {
  return std::includes(all.begin(), all.end(), part.begin(), part.end());
}

std::string joined(const std::vector<std::string>& all, const char* between) {
  std::string out;
  for (const std::string& one : all) out += (out.empty() ? "" : between) + one;
  return out;
}

void add_null_space(const Examination& examination, Judgement& out) {
  if (examination.candidates().null_columns() == 0) return;
  std::vector<ColumnGroup> groups;
  for (const Candidate& c : examination.candidates().null_space()) groups.push_back({c.first, c.columns});
  const Explanations all(examination.difference().null, groups);
  const double total = all.regression().d.squaredNorm();
  const double price =
      examination.price() + all.full().rss / static_cast<double>(all.regression().d.size()) * 40;
  const Fit best = all.search({}, price, 0).front();
  for (const int g : best.groups) {
    const Candidate& c = examination.candidates().null_space()[static_cast<std::size_t>(g)];
    std::vector<int> without = best.groups;
    std::erase(without, g);
    Finding finding;
    finding.term = c.id;
    finding.explained = (all.fit(without).rss - best.rss) / std::max(total, 1e-300);
    for (int i = 0; i < c.columns; ++i)
      finding.coefficients.push_back({c.id, "1", best.beta[c.first + i], best.deviation[c.first + i]});
    finding.sentence = c.phrase + " (coefficient " + number(best.beta[c.first]) + "; explains " +
                       percent(finding.explained) + " there)";
    out.null_space.push_back(finding);
  }
}

/// Columns of the best explanation.
int cost(const Examination& e) {
  int sum = 0;
  for (const int g : e.best().groups) sum += e.groups()[static_cast<std::size_t>(g)].columns;
  return sum;
}

/// Correlation of each sample's rest (n numbers) with that of the next: 0 for white noise, 1 for what is
/// smooth.
double hangs_together(const VectorX<double>& rest, Index n) {
  const Index most = rest.size() - n;
  return rest.head(most).dot(rest.tail(most)) / std::max(rest.squaredNorm(), 1e-300);
}

/// Explains the log under each reading and takes the one that leaves least; where several leave the same, the
/// one with the fewest columns. Throws LogError with `ask` where readings of another order are as good.
Examination best_reading(const Chain<double>& model, const Log& log, const JudgeOptions& options,
                         const std::vector<Reading>& readings, bool order_known, const std::string& ask) {
  std::list<Examination> all;
  for (const Reading& reading : readings) {
    all.emplace_back(model, log, options, reading, order_known);
    if (readings.size() > 1) all.back().glance();
  }
  const auto least = [&all] {
    double out = std::numeric_limits<double>::infinity();
    for (const Examination& e : all) out = std::min(out, e.left_over());
    return out;
  };
  if (all.size() > 1)
    std::erase_if(
        all, [limit = hopeless_at_sight * least()](const Examination& e) { return e.left_over() > limit; });
  for (Examination& e : all) e.explain();
  std::erase_if(all, [limit = decisive * least()](const Examination& e) { return e.left_over() > limit; });
  const auto simplest = std::min_element(
      all.begin(), all.end(), [](const Examination& a, const Examination& b) { return cost(a) < cost(b); });
  for (const Examination& e : all)
    if (cost(e) == cost(*simplest) && (e.reading().u_order != simplest->reading().u_order ||
                                       e.reading().quaternion_order != simplest->reading().quaternion_order))
      throw LogError(log.source + ask);
  return std::move(*simplest);
}

/// How the log is read: as declared, or else as explains it better.
Examination read_and_explain(const Chain<double>& model, const Log& log, const JudgeOptions& options,
                             Judgement& out) {
  constexpr const char* better = " explains more than the other order; ";
  if (log.u) {
    const auto order = options.u_order ? options.u_order : log.u_order;
    const bool open = !order && options.rows.size() == 6;
    std::vector<Reading> readings{{order.value_or(RowOrder::angular_first), {}, {}}};
    if (open) readings.push_back({RowOrder::linear_first, {}, {}});
    Examination found =
        best_reading(model, log, options, readings, order.has_value(),
                     ": u has six numbers in an order that the log does not tell, and both orders "
                     "explain it alike; say --u-order angular or --u-order linear");
    if (open)
      out.conventions.push_back(std::string("u with the ") +
                                (found.reading().u_order == RowOrder::angular_first ? "angular" : "linear") +
                                " rows first" + better + "--u-order declares it");
    return found;
  }
  // Most programs follow the angular velocity of the reference, osculate the rotation vector of the error.
  const auto order = options.quaternion_order ? options.quaternion_order : log.quaternion_order;
  std::vector<Reading> readings;
  for (const QuaternionOrder one : {QuaternionOrder::w_first, QuaternionOrder::w_last})
    for (const ErrorLaw law : {ErrorLaw::rotation_vector, ErrorLaw::angular_velocity})
      if (!order || one == *order) readings.push_back({{}, one, law});
  Examination found =
      best_reading(model, log, options, readings, true,
                   ": the order of the quaternion is not told by the log, and both orders explain it "
                   "alike; say --quaternion wxyz or --quaternion xyzw");
  if (!order)
    out.conventions.push_back(
        std::string("quaternions as ") +
        (found.reading().quaternion_order == QuaternionOrder::w_first ? "w x y z" : "x y z w") + better +
        "--quaternion declares it");
  out.conventions.push_back(found.reading().error_law == ErrorLaw::angular_velocity
                                ? "orientation: omega. = omega_ref. + D (omega_ref - omega) + K e fits best"
                                : "orientation: e.. + D e. + K e = 0 of the rotation vector e fits best");
  return found;
}

void add_doubts(const Examination& examination, const Words& words, Judgement& out) {
  const Fit& best = examination.best();
  for (const Fit& other : examination.fits()) {
    if (out.doubts.size() == most_doubts) break;
    if (contains(other.groups, best.groups) || contains(best.groups, other.groups)) continue;
    Doubt doubt;
    std::vector<std::string> sentences;
    for (const int g : other.groups) {
      if (std::find(best.groups.begin(), best.groups.end(), g) != best.groups.end()) continue;
      const Candidate c = words.candidate(g);
      doubt.terms.push_back(c.id);
      sentences.push_back(words.sentence(c, words.coefficients(c, other)));
    }
    std::vector<std::string> replaced;
    for (const int g : best.groups)
      if (std::find(other.groups.begin(), other.groups.end(), g) == other.groups.end())
        replaced.push_back(words.candidate(g).id);
    doubt.sentence = "this log explains as well: " + joined(sentences, ", and ") + ", in place of " +
                     joined(replaced, " and ") +
                     "; a log that decides: " + deciding_motion(examination, best, other);
    out.doubts.push_back(std::move(doubt));
  }
}

void add_unseen(const Examination& examination, const Explanations& all, const Words& words, Judgement& out) {
  const Fit& best = examination.best();
  for (int g = 0; g < examination.delay_group(); ++g) {
    const Candidate c = words.candidate(g);
    if (c.kind != CandidateKind::term || contains(best.groups, {g})) continue;
    std::vector<int> with = best.groups;
    with.insert(std::upper_bound(with.begin(), with.end(), g), g);
    const double deviation = all.fit(with).deviation[c.first] * std::sqrt(examination.noise_square());
    if (all.size(c.first) == 0) {
      out.unseen.push_back(c.phrase + ": is zero in this log");
    } else if (deviation == 0) {
      out.unseen.push_back(c.phrase + ": cannot be told from what was found");
    } else if (deviation > unseen_deviation) {
      out.unseen.push_back(c.phrase + ": its coefficient would be uncertain by " + number(deviation));
    }
  }
}

}  // namespace

Judgement judge(const Chain<double>& model, const Log& log, const JudgeOptions& options) {
  Judgement out;
  const Examination examination = read_and_explain(model, log, options, out);
  const Difference& difference = examination.difference();
  const Explanations all(difference.regression, examination.groups());
  const Words words(examination, model);
  const Fit& best = examination.best();
  out.samples = difference.samples;
  out.left_out = difference.left_out;
  out.difference = std::sqrt(examination.asked());
  out.noise = difference.noise;
  out.rest = examination.rest();
  for (const int g : best.groups) {
    const Candidate c = words.candidate(g);
    if (c.kind == CandidateKind::gains) {
      out.gains = words.coefficients(c, best);
      for (const Coefficient& gain : out.gains)
        if (gain.value < -significant * gain.deviation)
          out.findings.push_back({"gains", "has the wrong sign of a gain: " + measured(gain), {gain}, 0});
    } else {
      out.findings.push_back(words.finding(g));
    }
  }
  std::stable_sort(out.findings.begin(), out.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.explained > b.explained; });
  add_doubts(examination, words, out);
  add_unseen(examination, all, words, out);
  add_null_space(examination, out);
  // What is left, against the noise of neighbouring samples. White noise is no mistake: gains make that of q
  // larger.
  const double left = best.rss / static_cast<double>(difference.regression.d.size());
  const bool explained = left < significant * significant || out.rest < unexplained_part ||
                         hangs_together(all.rest(best), model.velocities()) < white;
  out.ruling = !explained ? Ruling::unexplained : out.findings.empty() ? Ruling::right : Ruling::wrong;
  return out;
}

std::string report(const Judgement& j, const std::string& source) {
  std::ostringstream out;
  out << source << ": " << j.samples << " samples used";
  if (j.left_out > 0)
    out << ", " << j.left_out << " left out (singular, saturated, or at the ends of a delay)";
  out << "\ndifference from the exact torque: " << number(j.difference) << " rms; noise of the log "
      << number(j.noise) << " (N m or N)\n";
  for (const std::string& line : j.conventions) out << "  " << line << "\n";
  if (!j.gains.empty())
    out << "gains as found, which were not judged (--stiffness and --damping give them): " << listed(j.gains)
        << "\n";
  switch (j.ruling) {
    case Ruling::right:
      out << "right: no term is missing as far as this log can tell\n";
      break;
    case Ruling::wrong:
      out << "wrong: the controller\n";
      break;
    case Ruling::unexplained:
      out << "unexplained: " << percent(j.rest) << " of the difference is left"
          << (j.findings.empty()
                  ? " and nothing known explains it\n"
                  : "; there is a mistake that is not known here, and what follows imitates it\n");
      break;
  }
  for (const Finding& finding : j.findings) out << "  - " << finding.sentence << "\n";
  const auto omitted = [&](const char* id) {
    return std::any_of(j.findings.begin(), j.findings.end(), [&](const Finding& f) {
      return f.term == id && near(f.coefficients[0].value, -1, f.coefficients[0].deviation);
    });
  };
  if (omitted("jdot_qd") && omitted("coriolis")) out << "  together these two are J* c, (14)\n";
  const bool left = j.rest * j.difference * j.difference > significant * j.noise * j.noise;
  if (j.ruling == Ruling::wrong && left) out << "  not explained: " << percent(j.rest) << "\n";
  for (const Doubt& doubt : j.doubts) out << "not sure: " << doubt.sentence << "\n";
  for (const std::string& line : j.unseen) out << "not seen in this log: " << line << "\n";
  for (const Finding& finding : j.null_space)
    out << "in the null space, where the tip feels nothing: " << finding.sentence << "\n";
  return out.str();
}

}  // namespace osculate
