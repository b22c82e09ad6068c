// What a finished run amounts to: status, verdict and exit code.
#pragma once

#include "experiment/run.hpp"

namespace osculate {

/// Fills status, verdict, exit and message of a run whose claims are known. `stop`: why it ended early, or
/// "". `signal`: number of the signal that interrupted it, or 0.
void conclude(const ExpectConfig& expect, const std::string& stop, int signal, RunResult& result);

/// The word of ExpectConfig::stop for it, or "failed".
std::string stop_name(IntegrationStopped::Reason reason);

/// Claims that cannot be judged in this experiment, each with its reason; "" where it can.
std::array<std::string, claim_count> reasons_against(const ClosedLoop& loop, bool filtered);

}  // namespace osculate
