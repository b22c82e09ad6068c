// Pieces of URDF text for the tests of the loader.
#pragma once

#include <locale>
#include <sstream>
#include <string>
#include <vector>

#include "model/urdf.hpp"
#include "support/catch.hpp"

namespace urdf_text {

inline std::string number(double x) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(17);
  out << x;
  return out.str();
}

inline std::string triple(const Eigen::Vector3d& v) {
  return number(v[0]) + " " + number(v[1]) + " " + number(v[2]);
}

inline std::string robot(const std::string& body) { return "<robot name=\"r\">" + body + "</robot>"; }

/// A link of 1 kg with a ball's inertia, or with the given inside.
inline const std::string ball =
    "<inertial><mass value=\"1\"/>"
    "<inertia ixx=\"0.1\" iyy=\"0.1\" izz=\"0.1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
inline std::string a_link(const std::string& name, const std::string& inside = ball) {
  return "<link name=\"" + name + "\">" + inside + "</link>";
}

inline std::string inertial(const std::string& mass, double xx, double yy, double zz, double xy = 0) {
  return "<inertial><mass value=\"" + mass + "\"/><inertia ixx=\"" + number(xx) + "\" iyy=\"" + number(yy) +
         "\" izz=\"" + number(zz) + "\" ixy=\"" + number(xy) + "\" ixz=\"0\" iyz=\"0\"/></inertial>";
}

inline const std::string limit = "<limit lower=\"-1\" upper=\"1\" effort=\"5\" velocity=\"2\"/>";

inline std::string a_joint(const std::string& name, const std::string& parent, const std::string& child,
                           const std::string& type = "revolute",
                           const std::string& inside = "<axis xyz=\"0 0 1\"/>" + limit) {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + inside + "</joint>";
}

/// base - j1 - one - j2 - two, the numbers of link "one" and the inside of joint "j2" as given.
inline std::string two_links(const std::string& one = ball,
                             const std::string& j2 = "<axis xyz=\"0 0 1\"/>" + limit) {
  return robot(a_link("base", "") + a_link("one", one) + a_link("two") + a_joint("j1", "base", "one") +
               a_joint("j2", "one", "two", "revolute", j2));
}

inline osculate::ArmDescription load(const std::string& text, const std::string& tip = "two",
                                     const std::string& base = "",
                                     osculate::SideBranches side = osculate::SideBranches::lump) {
  osculate::ChainChoice choice;
  choice.base = base;
  choice.tip = tip;
  choice.side_branches = side;
  return osculate::parse_urdf(text, "arm.urdf", choice);
}

/// The message of the ModelError that `load` throws; empty if it throws none.
inline std::string error_of(const std::string& text, const std::string& tip = "two",
                            const std::string& base = "") {
  try {
    load(text, tip, base);
  } catch (const osculate::ModelError& error) { return error.what(); }
  return "";
}

/// Whether `text` contains every part.
inline bool says(const std::string& text, const std::vector<std::string>& parts) {
  for (const auto& part : parts)
    if (text.find(part) == std::string::npos) return false;
  return true;
}

}  // namespace urdf_text
