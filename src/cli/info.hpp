// `osculate info`: what a model file holds, and what became of each link.
#pragma once

#include <filesystem>
#include <iosfwd>

#include "experiment/run.hpp"

namespace osculate {

/// The chain if a tip is chosen, else the whole tree.
Exit print_info(const std::filesystem::path& model, const ChainChoice& choice, std::ostream& out);

}  // namespace osculate
