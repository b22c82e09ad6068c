// Where a result came from: enough to make it again.
#pragma once

#include <string>
#include <vector>

#include "experiment/config.hpp"
#include "record/result_file.hpp"

namespace osculate {

/// "osculate 0.1.0 (commit ...)" and one line for each library.
std::string version_text();

/// "0.1.0 (commit ...)"
std::string version();

/// The texts of /provenance.
std::vector<Text> provenance(const Experiment& experiment, const std::string& urdf_text,
                             const std::string& command);

}  // namespace osculate
