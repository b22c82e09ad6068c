// osculate paper: the equations of the paper, checked on an arm and proven over exact fractions.
#pragma once

#include <iosfwd>
#include <optional>

#include "experiment/run.hpp"

namespace osculate {

struct PaperOptions {
  std::filesystem::path model;
  ChainChoice choice;  // tip empty: the link that ends the only branch
  int states = 100;
  bool exact = false;
  int arms = 20;  // of each size, for the proof
};

/// Exit 1 where a statement fails, or a printed form that is wrong comes out right.
Exit print_paper(const PaperOptions& options, std::ostream& out, std::ostream& messages);

}  // namespace osculate
