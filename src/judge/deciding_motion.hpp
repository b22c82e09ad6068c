// Which motion would tell two explanations of a torque apart.
#pragma once

#include <string>

#include "judge/examination.hpp"

namespace osculate {

/// The simplest of some motions near those of the log under which `other`, fitted anew, cannot imitate
/// `best`; in words. Where none does, says so.
std::string deciding_motion(const Examination& examination, const Fit& best, const Fit& other);

}  // namespace osculate
