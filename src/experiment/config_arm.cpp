// The sections `model` and `plant`.
#include <Eigen/Eigenvalues>

#include "experiment/config_sections.hpp"

namespace osculate {
namespace {

using yaml::above_zero;
using yaml::at_least_zero;
using yaml::entries;
using yaml::fail;
using yaml::fail_missing;
using yaml::Map;
using yaml::read;
using yaml::Setting;

/// One list of a friction map, checked to be as long as the lists before it.
void read_friction_list(const Setting& setting, const yaml::Range& range, double JointFriction::*part,
                        std::vector<JointFriction>& out, std::string& first) {
  std::vector<double> values;
  read(setting, values, range);
  if (!setting.given()) return;
  if (first.empty()) {
    first = setting.path;
    out.resize(values.size());
  }
  if (values.size() != out.size())
    fail(setting, "has " + std::to_string(values.size()) + " entries, " + first + " has " +
                      std::to_string(out.size()) + "; give one for each joint.");
  for (std::size_t i = 0; i < values.size(); ++i) out[i].*part = values[i];
}

std::vector<JointFriction> read_friction(const Setting& setting) {
  const std::string torques = "N m, N", both_ways = "instead of `coulomb`; give both directions";
  const Map map(setting, {{"viscous", "N m s/rad, N s/m", "for each velocity coordinate, >= 0", "none"},
                          {"coulomb", torques,
                           "for each velocity coordinate, the same in both directions, >= 0", "none"},
                          {"coulomb_positive", torques, "magnitude for qd > 0, " + both_ways, "none"},
                          {"coulomb_negative", torques, "magnitude for qd < 0, " + both_ways, "none"},
                          {"v_s", "rad/s, m/s",
                           "speed of the smooth step tanh(qd / v_s); a number or one for each velocity "
                           "coordinate, > 0. There is "
                           "no stiction",
                           "0.01"}});
  const auto both = map.at("coulomb"), positive = map.at("coulomb_positive"),
             negative = map.at("coulomb_negative");
  if (both.given() && positive.given()) fail(positive, "give this or coulomb, not both.");
  if (both.given() && negative.given()) fail(negative, "give this or coulomb, not both.");
  const std::string remedy = "give both directions, or coulomb where they are equal.";
  if (positive.given() && !negative.given()) fail_missing(negative, remedy);
  if (negative.given() && !positive.given()) fail_missing(positive, remedy);

  std::vector<JointFriction> out;
  std::string first;
  const auto magnitude = at_least_zero("give the magnitude, friction always opposes motion");
  read_friction_list(map.at("viscous"), at_least_zero(), &JointFriction::viscous, out, first);
  read_friction_list(both, magnitude, &JointFriction::coulomb_positive, out, first);
  read_friction_list(both, magnitude, &JointFriction::coulomb_negative, out, first);
  read_friction_list(positive, magnitude, &JointFriction::coulomb_positive, out, first);
  read_friction_list(negative, magnitude, &JointFriction::coulomb_negative, out, first);

  const auto speed = map.at("v_s");
  const auto range = above_zero("the speed that sets the width of the smoothed step");
  if (speed.given() && first.empty()) fail(speed, "has nothing to smooth: give viscous or coulomb as well.");
  if (yaml::is_scalar(speed)) {
    double v_s = 0;
    read(speed, v_s, range);
    for (auto& joint : out) joint.v_s = v_s;
  } else {
    read_friction_list(speed, range, &JointFriction::v_s, out, first);
  }
  return out;
}

/// Three rows, or [ixx, iyy, izz, ixy, ixz, iyz].
void read_inertia(const Setting& setting, Matrix3<double>& out) {
  if (!setting.given()) return;
  const std::string what = "three rows of three, or [ixx, iyy, izz, ixy, ixz, iyz]";
  const auto list = entries(setting, what);
  Matrix3<double> I;
  if (list.size() == 6) {
    Vector6 x;
    read(setting, x);
    I << x[0], x[3], x[4], x[3], x[1], x[5], x[4], x[5], x[2];
  } else if (list.size() == 3) {
    for (int i = 0; i < 3; ++i) {
      Vector3<double> row;
      read(list[i], row);
      I.row(i) = row.transpose();
    }
  } else {
    fail(setting, "must be " + what + ".");
  }
  if (I != I.transpose()) fail(setting, "must be symmetric.");
  // The eigenvalues of a symmetric 3x3 matrix come out within a few eps of its largest entry.
  const double smallest =
      Eigen::SelfAdjointEigenSolver<Matrix3<double>>(I, Eigen::EigenvaluesOnly).eigenvalues()[0];
  if (smallest < -16 * std::numeric_limits<double>::epsilon() * I.cwiseAbs().maxCoeff())
    fail(setting, "must have no negative principal moment; check the signs of the products of inertia.");
  out = I;
}

/// What every surface has, after its shape.
yaml::Keys with_contact(yaml::Keys shape) {
  const yaml::Keys contact{
      {"stiffness", "N/m", "normal force per depth, > 0"},
      {"damping", "N s/m", "normal force per speed of entry, >= 0; the surface never pulls"},
      {"friction", "", "Coulomb coefficient, >= 0"},
      {"v_s", "m/s", "speed of the smooth step of that friction, > 0"}};
  shape.insert(shape.end(), contact.begin(), contact.end());
  return shape;
}

const yaml::TypeKeys surface_types{
    {"plane", with_contact({{"point", "m", "a point of the plane"},
                            {"normal", "1", "direction out of the material, of any length but 0"}})},
    {"ball", with_contact({{"centre", "m", "its middle; the material is inside"}, {"radius", "m", "> 0"}})},
};

Environment read_environment(const Setting& setting) {
  const auto [type, map] = yaml::typed_map(setting, surface_types, "");
  Environment out;
  if (type == "plane") {
    Plane plane;
    const auto normal = map.at("normal");
    read(map.at("point"), plane.point);
    read(normal, plane.normal);
    if (plane.normal.isZero(0)) fail(normal, "must not be zero: it points out of the material.");
    out.surface = plane;
  } else {
    Ball ball;
    read(map.at("centre"), ball.centre);
    read(map.at("radius"), ball.radius, above_zero());
    out.surface = ball;
  }
  read(map.at("stiffness"), out.stiffness, above_zero());
  read(map.at("damping"), out.damping, at_least_zero());
  read(map.at("friction"), out.friction, at_least_zero("give the Coulomb coefficient, 0 is frictionless"));
  read(map.at("v_s"), out.v_s, above_zero("the speed that sets the width of the smoothed step"));
  return out;
}

}  // namespace

std::filesystem::path resolve(const std::filesystem::path& directory, const std::string& text) {
  return std::filesystem::absolute(directory / text).lexically_normal();
}

ModelConfig read_model(const Setting& setting, const std::filesystem::path& directory) {
  const Map map(
      setting,
      {{"urdf", "", "the arm, as controller and plant know it: a URDF file"},
       {"base", "", "link where the chain starts", "root link"},
       {"tip", "", "link whose motion is controlled"},
       {"gravity", "m/s^2", "acceleration of free fall, base frame"},
       {"side_branches", "",
        "`lump`: carry the mass of links beside the chain, their joints frozen at 0; `drop`: leave them out"},
       {"armature", "kg m^2, kg",
        "reflected motor inertia for each velocity coordinate, >= 0; 0 for joints with several axes",
        "[] (none)"},
       {"friction", "", "what both know of the friction in the joints", "none"}});
  ModelConfig out;
  std::string urdf;
  yaml::require_given(map.at("urdf"), "give the URDF file of the arm.");
  yaml::require_given(map.at("tip"), "give the link whose motion is controlled.");
  read(map.at("urdf"), urdf);
  out.urdf = resolve(directory, urdf);
  const auto base = map.at("base");
  if (!(yaml::is_scalar(base) && base.value->text.empty())) read(base, out.choice.base);  // "": the root
  read(map.at("tip"), out.choice.tip);
  read(map.at("gravity"), out.choice.gravity);
  read(map.at("side_branches"), out.choice.side_branches,
       {{"lump", SideBranches::lump}, {"drop", SideBranches::drop}});
  read(map.at("armature"), out.armature, at_least_zero());
  out.friction = read_friction(map.at("friction"));
  return out;
}

PlantConfig read_plant(const Setting& setting) {
  const Map map(
      setting,
      {{"payload", "", "body on the tip link that the controller does not know", "none"},
       {"armature", "kg m^2, kg", "the true arm's; replaces the model's altogether ([]: none)", "as `model`"},
       {"friction", "", "the true arm's; replaces the model's altogether ({}: none)", "as `model`"},
       {"mass_scale", "",
        "factor on mass and inertia, > 0: a number for every link, or a list with one for each link, base to "
        "tip"},
       {"inertia_scale", "", "factor on the inertia of every link about its centre of mass, > 0"},
       {"tip_force", "N m, N",
        "constant wrench on the tip, about the tip point; base axes, with `base_motion` inertial axes"},
       {"environment", "", "a surface that the tip point may touch", "none"},
       {"dynamics", "", "`recursive`: qdd by (51), O(n); `dense`: M^-1 by the definitions"},
       {"share_kinematics", "",
        "where plant and controller are the same arm at the same state, the plant takes over the "
        "controller's "
        "cosines, sines and kinematics ([claims](claims.md)); false: it shares nothing"}});
  const Map payload(
      map.at("payload"),
      {{"mass", "kg", ">= 0"},
       {"com", "m", "its centre of mass, tip frame"},
       {"inertia", "kg m^2",
        "about its centre of mass, tip axes: three rows, or [ixx, iyy, izz, ixy, ixz, iyz]", "0"}});
  PlantConfig out;
  read(payload.at("mass"), out.payload.mass, at_least_zero());
  read(payload.at("com"), out.payload.com);
  read_inertia(payload.at("inertia"), out.payload.inertia);
  if (map.at("armature").given()) read(map.at("armature"), out.armature.emplace(), at_least_zero());
  if (map.at("friction").given()) out.friction = read_friction(map.at("friction"));
  const auto mass_scale = map.at("mass_scale");
  const auto range = above_zero("1 leaves the masses as they are");
  if (mass_scale.given() && mass_scale.value->kind == yaml::Value::Kind::list)
    read(mass_scale, out.link_mass_scale, range);
  else
    read(mass_scale, out.mass_scale, range);
  read(map.at("inertia_scale"), out.inertia_scale, above_zero("1 leaves the inertias as they are"));
  read(map.at("tip_force"), out.tip_force);
  if (map.at("environment").given()) out.environment = read_environment(map.at("environment"));
  read(map.at("dynamics"), out.dynamics,
       {{"recursive", PlantDynamics::recursive}, {"dense", PlantDynamics::dense}});
  read(map.at("share_kinematics"), out.share_kinematics);
  return out;
}

}  // namespace osculate
