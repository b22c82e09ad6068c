#include "cli/judge.hpp"

#include <ostream>

#include "cli/json.hpp"
#include "cli/lists.hpp"
#include "experiment/arms.hpp"
#include "experiment/embedded.hpp"
#include "judge/judge.hpp"
#include "record/texts.hpp"

namespace osculate {

namespace {

/// The arm that the controller believes in, with the friction that it compensates and the rows that it
/// controls.
struct Believed {
  ArmDescription description;
  Chain<double> chain;
  JudgeOptions options;
};

/// One number for all, or one for each.
std::vector<double> spread(const std::string& text, const std::string& what, std::size_t count,
                           const std::string& each) {
  std::vector<double> out = parse_list(text, what);
  if (out.size() == 1) out.resize(count, out.front());
  if (out.size() != count)
    throw ConfigError(what + " has " + std::to_string(out.size()) + " entries, needs 1 or " +
                      std::to_string(count) + " (one for each " + each + ")");
  return out;
}

Believed from_file(const JudgeArguments& arguments) {
  Believed out;
  out.description = load_urdf(arguments.model, arguments.choice);
  require_simulable(out.description);
  out.chain = out.description.chain;
  const auto n = static_cast<std::size_t>(out.chain.velocities());
  if (!arguments.armature.empty()) {
    if (!out.chain.one_axis_joints())
      throw ConfigError("--armature: the chain has joints of several axes, which have none");
    const auto armature = spread(arguments.armature, "--armature", n, "joint");
    for (std::size_t i = 0; i < n; ++i) out.chain.links[i].armature = armature[i];
  }
  if (!arguments.viscous.empty())
    for (const double viscous : spread(arguments.viscous, "--viscous", n, "velocity coordinate"))
      out.options.friction.push_back({viscous, 0, 0, 1e-2});
  out.options.rows = parse_rows(arguments.rows);
  return out;
}

Believed from_log(const JudgeArguments& arguments) {
  Experiment experiment;
  try {
    experiment = embedded_experiment(read_texts(arguments.log), arguments.log);
  } catch (const FileError& error) {
    throw ConfigError(std::string(error.what()) + "; for the log of another program say --model and --tip");
  }
  const Arms arms = make_arms(experiment);
  Believed out{arms.description, arms.model, {}};
  out.options.rows = experiment.controller.rows;
  if (experiment.controller.compensate_friction) out.options.friction = arms.friction;
  return out;
}

Gains gains(const JudgeArguments& arguments) {
  Gains out;
  const auto fill = [](Vector6& row, const std::string& text, const std::string& what) {
    const auto values = spread(text, what, 6, "axis, angular first");
    for (int i = 0; i < 6; ++i) row[i] = values[static_cast<std::size_t>(i)];
  };
  fill(out.stiffness, arguments.stiffness, "--stiffness");
  fill(out.damping, arguments.damping, "--damping");
  return out;
}

void write(Json& json, const std::vector<Coefficient>& coefficients) {
  json.begin_array();
  for (const Coefficient& c : coefficients) {
    json.begin_object().key("name").value(c.name).key("unit").value(c.unit);
    json.key("value").value(c.value).key("deviation").value(c.deviation).end_object();
  }
  json.end_array();
}

void write(Json& json, const std::vector<Finding>& findings) {
  json.begin_array();
  for (const Finding& finding : findings) {
    json.begin_object().key("term").value(finding.term).key("sentence").value(finding.sentence);
    json.key("explained").value(finding.explained).key("coefficients");
    write(json, finding.coefficients);
    json.end_object();
  }
  json.end_array();
}

void write(Json& json, const std::vector<std::string>& texts) {
  json.begin_array();
  for (const std::string& text : texts) json.value(text);
  json.end_array();
}

void write_json(std::ostream& out, const Judgement& j) {
  Json json(out);
  constexpr const char* verdicts[] = {"right", "wrong", "unexplained"};
  json.begin_object().key("verdict").value(std::string(verdicts[static_cast<int>(j.ruling)]));
  json.key("findings");
  write(json, j.findings);
  json.key("doubts").begin_array();
  for (const Doubt& doubt : j.doubts) {
    json.begin_object().key("terms");
    write(json, doubt.terms);
    json.key("sentence").value(doubt.sentence).end_object();
  }
  json.end_array();
  json.key("null_space");
  write(json, j.null_space);
  json.key("gains");
  write(json, j.gains);
  json.key("conventions");
  write(json, j.conventions);
  json.key("unseen");
  write(json, j.unseen);
  json.key("difference").value(j.difference).key("noise").value(j.noise).key("rest").value(j.rest);
  json.key("samples").value(static_cast<int>(j.samples)).key("left_out").value(static_cast<int>(j.left_out));
  json.end_object();
  out << "\n";
}

}  // namespace

Exit print_judgement(const JudgeArguments& arguments, std::ostream& out, std::ostream& messages) {
  Believed believed = arguments.model.empty() ? from_log(arguments) : from_file(arguments);
  JudgeOptions& options = believed.options;
  if (!arguments.model.empty())
    for (const auto& warning : believed.description.warnings) messages << "warning: " << warning << "\n";
  if (!arguments.u_order.empty())
    options.u_order = arguments.u_order == "angular" ? RowOrder::angular_first : RowOrder::linear_first;
  if (!arguments.quaternion.empty())
    options.quaternion_order =
        arguments.quaternion == "wxyz" ? QuaternionOrder::w_first : QuaternionOrder::w_last;
  if (arguments.acceleration == "spatial") options.acceleration = Acceleration::spatial;
  if (arguments.stiffness.empty() != arguments.damping.empty())
    throw ConfigError("--stiffness and --damping belong together: give both, or none to have them found");
  if (!arguments.stiffness.empty()) options.gains = gains(arguments);
  options.samples = arguments.samples;
  std::vector<std::string> joints;
  for (const JointInfo& joint : believed.description.joints) joints.push_back(joint.name);
  const Log log = read_log(arguments.log, believed.chain, joints, options.rows.size());
  const Judgement judgement = judge(believed.chain, log, options);
  if (arguments.json) {
    write_json(out, judgement);
  } else {
    out << report(judgement, log.source);
  }
  return judgement.ruling == Ruling::right ? Exit::ok : Exit::claim_failed;
}

}  // namespace osculate
