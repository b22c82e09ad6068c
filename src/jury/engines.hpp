// Loads the other libraries.
#pragma once

#include <string>
#include <vector>

#include "jury/engine.hpp"
#include "model/urdf.hpp"

namespace osculate::jury {

/// A library that takes no part, and why.
struct Absent {
  std::string name, reason;
};
struct Engines {
  std::vector<Engine> present;
  std::vector<Absent> absent;
};

/// The mass of the last link that has one, in one library alone, times 1 + relative: shows that the jury sees
/// such a thing.
struct Disturbance {
  std::string engine;
  double relative = 0;
};

/// Every library whose module is there and takes the arm: KDL, MuJoCo, Simbody, DART. Modules are looked for
/// in the directory that OSCULATE_ENGINES names, else beside the program in benchmarks/ (a build) or
/// ../lib/osculate/ (an installation).
Engines load_engines(const ArmDescription& arm, const Disturbance& disturbance = {});

/// The same numbers for a library. A planar joint becomes two sliding and one turning joint, with links of no
/// mass between them, whose coordinates are those of the planar joint. Throws ModelError for other joints
/// with several axes.
Arm arm_of(const Chain<double>& chain);

/// Raises masses that are 0 to 1 kg, and moments of inertia that break the triangle inequality by what is
/// missing: some libraries take bodies only that could exist. One line for each link changed.
std::vector<std::string> make_solid(ArmDescription& arm);

}  // namespace osculate::jury
