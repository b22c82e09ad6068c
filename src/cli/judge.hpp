// `osculate judge`: which term of the exact law a logged torque lacks.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "experiment/run.hpp"

namespace osculate {

struct JudgeArguments {
  std::filesystem::path log;
  std::filesystem::path model;  // empty: that of the log, which is a result file
  ChainChoice choice;
  std::string armature, viscous;    // comma-separated lists of the model, one for each joint; empty: none
  std::string rows;                 // comma-separated names; empty: all six
  std::string u_order, quaternion;  // angular or linear, wxyz or xyzw; empty: as the log says
  std::string acceleration;         // classical or spatial; empty: classical
  std::string stiffness, damping;   // of the tracking law, one number or six; empty: found
  int samples = 500;                // used for the fit
  bool json = false;
};

/// Exit 0 if the torque is right as far as the log can tell, else 1. Throws LogError, ModelError,
/// ConfigError, FileError.
Exit print_judgement(const JudgeArguments& arguments, std::ostream& out, std::ostream& messages);

}  // namespace osculate
