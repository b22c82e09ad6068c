// The sections of an experiment file, one reader each. Relative paths are relative to `directory`.
#pragma once

#include "experiment/config.hpp"
#include "experiment/yaml_reader.hpp"

namespace osculate {

ModelConfig read_model(const yaml::Setting&, const std::filesystem::path& directory);
PlantConfig read_plant(const yaml::Setting&);
ReferenceConfig read_reference(const yaml::Setting&, const std::filesystem::path& directory);
/// A reference along which the base can move.
ReferenceConfig read_base_motion(const yaml::Setting&, const std::filesystem::path& directory);
ControllerConfig read_controller(const yaml::Setting&, const std::filesystem::path& directory);

/// A sweep with the place of each override in the file.
struct PlacedSweep {
  SweepConfig sweep;
  std::vector<std::vector<std::string>> places;  // of each variant's overrides
};
PlacedSweep read_sweep(const yaml::Setting&);

/// The absolute path of a file that an experiment names.
std::filesystem::path resolve(const std::filesystem::path& directory, const std::string& text);
/// One of wx, wy, wz, vx, vy, vz as 0..5.
int read_row(const yaml::Setting&);

}  // namespace osculate
