#include "jury/engines.hpp"

#include <dlfcn.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace osculate::jury {

namespace {

namespace fs = std::filesystem;

constexpr const char* modules[][2] = {{"KDL", "peer_kdl.so"},
                                      {"MuJoCo", "peer_mujoco.so"},
                                      {"Simbody", "peer_simbody.so"},
                                      {"DART", "peer_dart.so"}};

std::vector<fs::path> directories() {
  if (const char* named = std::getenv("OSCULATE_ENGINES")) return {named};
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return {};
  return {program.parent_path() / "benchmarks", program.parent_path().parent_path() / "lib" / "osculate"};
}

Engine load(const std::string& file, const Arm& arm) {
  fs::path found;
  for (const fs::path& directory : directories())
    if (found.empty() && fs::exists(directory / file)) found = directory / file;
  if (found.empty()) throw std::runtime_error("not built: ./dev jury installs and builds it");
  void* const module = dlopen(found.c_str(), RTLD_NOW | RTLD_LOCAL);  // stays until the program ends
  if (!module) throw std::runtime_error(dlerror());
  void* const function = dlsym(module, "make_engine");
  if (!function) throw std::runtime_error(found.string() + " is no module of this version");
  Engine out;
  reinterpret_cast<MakeEngine*>(function)(arm, out);
  return out;
}

/// One line, without the name of the library before it.
std::string reason(std::string text, const std::string& name) {
  if (text.starts_with(name + ": ")) text.erase(0, name.size() + 2);
  for (char& c : text)
    if (c == '\n') c = ' ';
  return text;
}

void disturb(Arm& arm, double relative) {
  for (auto link = arm.links.rbegin(); link != arm.links.rend(); ++link)
    if (link->mass > 0) {
      link->mass *= 1 + relative;
      return;
    }
}

}  // namespace

Arm arm_of(const Chain<double>& chain) {
  Arm out{{}, chain.R_tip, chain.p_tip, chain.gravity};
  const Matrix3<double> one = Matrix3<double>::Identity(), no_inertia = Matrix3<double>::Zero();
  const Vector3<double> origin = Vector3<double>::Zero();
  for (const Link<double>& link : chain.links) {
    if (link.type == JointType::planar) {
      const Vector3<double> second = link.axis.cross(link.axis2);
      out.links.push_back({link.R_origin, link.p_origin, link.axis2, 0, origin, no_inertia, true});
      out.links.push_back({one, origin, second, 0, origin, no_inertia, true});
      out.links.push_back({one, origin, link.axis, link.mass, link.com, link.inertia, false});
    } else if (one_axis(link.type)) {
      out.links.push_back({link.R_origin, link.p_origin, link.axis, link.mass, link.com, link.inertia,
                           link.type == JointType::prismatic});
    } else {
      throw ModelError(
          "the arm has a spherical, floating or other joint with several axes; only planar ones can be "
          "split");
    }
  }
  return out;
}

std::vector<std::string> make_solid(ArmDescription& arm) {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < arm.chain.links.size(); ++i) {
    Link<double>& link = arm.chain.links[i];
    std::string what;
    if (link.mass == 0) {
      link.mass = 1;
      what = "mass 0 raised to 1 kg";
    }
    const Vector3<double> moments =
        Eigen::SelfAdjointEigenSolver<Matrix3<double>>(link.inertia).eigenvalues();  // ascending
    const double shortfall = moments[2] - moments[0] - moments[1];
    if (shortfall > -1e-12 * moments[2] || moments[0] <= 0) {  // on the edge rounding decides
      const double more = std::max(1.01 * shortfall, moments[2] > 0 ? 1e-3 * moments[2] : 1e-3);
      link.inertia += more * Matrix3<double>::Identity();
      char text[64];
      std::snprintf(text, sizeof text, "moments of inertia raised by %.3g kg m^2", more);
      what += (what.empty() ? "" : ", ") + std::string(text);
    }
    if (!what.empty()) notes.push_back("link '" + arm.joints[i].link + "': " + what);
  }
  return notes;
}

Engines load_engines(const ArmDescription& arm, const Disturbance& disturbance) {
  Engines out;
  for (const auto& [name, file] : modules) {
    try {
      Arm numbers = arm_of(arm.chain);
      if (disturbance.engine == name) disturb(numbers, disturbance.relative);
      out.present.push_back(load(file, numbers));
    } catch (const std::exception& error) { out.absent.push_back({name, reason(error.what(), name)}); }
  }
  return out;
}

}  // namespace osculate::jury
