// What a controller was told and what torque it gave, sample by sample.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/chain.hpp"

namespace osculate {

/// A log that cannot be judged. The message names file, place, value and remedy.
struct LogError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Which half of a six-vector, and which end of a quaternion, comes first in the numbers of a log.
enum class RowOrder { angular_first, linear_first };
enum class QuaternionOrder { w_first, w_last };
/// Of a tip acceleration: the derivative of the tip's velocity, or the linear part without omega x v.
enum class Acceleration { classical, spatial };

/// Where the tip should have been. Base frame; every matrix has one row for each sample.
struct LoggedReference {
  MatrixX<double> position;      // N x 3, m
  MatrixX<double> quaternion;    // N x 4, in the order of the log
  MatrixX<double> velocity;      // N x 6, angular part first: rad/s, m/s
  MatrixX<double> acceleration;  // N x 6, angular part first: rad/s^2, m/s^2
};

/// N samples, evenly spaced or not, times increasing. Joints base to tip.
struct Log {
  std::string source;                // file name, for messages
  std::vector<double> t;             // s
  MatrixX<double> q;                 // N x positions
  MatrixX<double> qd;                // N x velocities
  MatrixX<double> tau;               // N x velocities: N m or N, as commanded
  std::optional<MatrixX<double>> u;  // N x task rows: commanded tip acceleration, in the order of the log
  std::optional<LoggedReference> reference;
  // What the log says of its own order; none: it has to be found out or told.
  std::optional<RowOrder> u_order;
  std::optional<QuaternionOrder> quaternion_order;

  /// Number of rows.
  Eigen::Index samples() const { return static_cast<Eigen::Index>(t.size()); }
};

/// Throws LogError, with the number of the sample, where times do not increase or a number is not finite.
void check(const Log& log);

/// Reads a CSV file with a header (docs/judge.md has the names of the columns), or an HDF5 file with one
/// dataset for each of them, or a result file of `osculate run`. `joints` are the names of the model's
/// joints, base to tip; `task_rows` the number of controlled rows. Throws LogError and FileError.
Log read_log(const std::filesystem::path& file, const Chain<double>& model,
             const std::vector<std::string>& joints, std::size_t task_rows);

}  // namespace osculate
