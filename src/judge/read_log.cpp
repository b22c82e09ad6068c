// From named columns to a log. Names may be plain or those of result files of osculate.
#include <algorithm>
#include <cmath>

#include "input/named_columns.hpp"
#include "judge/log.hpp"
#include "record/log_table.hpp"

namespace osculate {

namespace {

using Matrix = MatrixX<double>;
using Names = std::vector<std::string>;

const Names time_names{"t", "time", "timestamp"};

class Columns {
 public:
  Columns(const NamedColumns& table, std::string source) : table_(table), source_(std::move(source)) {}

  const std::vector<double>* one(const Names& names) const {
    for (const std::string& name : names) {
      const auto found = std::find(table_.names.begin(), table_.names.end(), name);
      if (found != table_.names.end())
        return &table_.columns[static_cast<std::size_t>(found - table_.names.begin())];
    }
    return nullptr;
  }
  /// The columns "NAME" + ending for each ending, with or without _ between them; empty if one is missing.
  Matrix named(const Names& names, const Names& endings) const {
    for (const std::string& name : names) {
      std::vector<const std::vector<double>*> found;
      for (const std::string& ending : endings) found.push_back(one({name + "_" + ending, name + ending}));
      if (std::none_of(found.begin(), found.end(), [](const auto* c) { return c == nullptr; }))
        return filled(found);
    }
    return {};
  }
  /// The columns "NAME1", "NAME2", ..., or from 0, or "NAME[0]", "NAME_1", up to the first that is missing.
  Matrix numbered(const Names& names) const {
    for (const std::string& name : names)
      for (const std::size_t first : {0u, 1u}) {
        std::vector<const std::vector<double>*> found;
        for (std::size_t i = first;; ++i) {
          const std::string n = std::to_string(i);
          const auto* column = one({name + n, name + "_" + n, name + "[" + n + "]"});
          if (!column) break;
          found.push_back(column);
        }
        if (!found.empty()) return filled(found);
      }
    return {};
  }
  [[noreturn]] void missing(const std::string& what, const std::string& remedy) const {
    std::string names;
    for (const std::string& name : table_.names)
      if (names.size() < 300) names += (names.empty() ? "" : ", ") + name;
    throw LogError(source_ + ": has no " + what + "; " + remedy + ". It has: " + names);
  }

 private:
  Matrix filled(const std::vector<const std::vector<double>*>& columns) const {
    Matrix out(static_cast<Eigen::Index>(table_.rows()), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i)
      out.col(static_cast<Eigen::Index>(i)) = Eigen::Map<const VectorX<double>>(
          columns[i]->data(), static_cast<Eigen::Index>(columns[i]->size()));
    return out;
  }

  const NamedColumns& table_;
  std::string source_;
};

Matrix joint_columns(const Columns& columns, const Names& names, const std::vector<std::string>& joints,
                     Eigen::Index wanted, const std::string& source) {
  Matrix out = columns.named(names, joints);
  if (out.cols() == 0) out = columns.numbered(names);
  if (out.cols() == 0)
    columns.missing("columns of " + names.front(), "name them " + names.front() + "1, " + names.front() +
                                                       "2, ... from base to tip, or " + names.front() +
                                                       "_JOINT by the joints' names");
  if (out.cols() != wanted)
    throw LogError(source + ": has " + std::to_string(out.cols()) + " columns of " + names.front() +
                   ", the arm from base to tip needs " + std::to_string(wanted) +
                   "; choose the chain with --base and --tip");
  return out;
}

/// Six columns, angular part first: by w and v endings, or two groups of three.
Matrix six(const Columns& columns, const Names& together, const Names& angular, const Names& linear) {
  Matrix out = columns.named(together, {"wx", "wy", "wz", "vx", "vy", "vz"});
  if (out.cols() == 6) return out;
  const Matrix w = columns.named(angular, {"x", "y", "z"}), v = columns.named(linear, {"x", "y", "z"});
  if (w.cols() + v.cols() == 6) {
    out.resize(w.rows(), 6);
    out << w, v;
  }
  return out;
}

std::optional<LoggedReference> reference(const Columns& columns, bool from_osculate,
                                         std::optional<QuaternionOrder>& order) {
  LoggedReference out;
  out.position = columns.named({"ref", "ref_p"}, {"x", "y", "z"});
  if (out.position.cols() == 0) out.position = columns.numbered({"trajectory/reference_position"});
  if (out.position.cols() == 0) return std::nullopt;
  out.quaternion = columns.named({"ref_q", "ref_quat"}, {"w", "x", "y", "z"});
  order = QuaternionOrder::w_first;
  if (out.quaternion.cols() == 0) {
    out.quaternion = columns.numbered({"ref_quat", "trajectory/reference_orientation"});
    if (!from_osculate) order.reset();
  }
  out.velocity = six(columns, {"ref"}, {"ref_w"}, {"ref_v"});
  if (out.velocity.cols() == 0) out.velocity = columns.numbered({"trajectory/reference_velocity"});
  out.acceleration = six(columns, {"ref_acc"}, {"ref_alpha"}, {"ref_a"});
  if (out.acceleration.cols() == 0)
    out.acceleration = columns.numbered({"trajectory/reference_acceleration"});
  if (out.quaternion.cols() != 4)
    columns.missing("quaternion of the reference", "name its columns ref_qw, ref_qx, ref_qy, ref_qz");
  if (out.velocity.cols() != 6)
    columns.missing("velocity of the reference", "name its columns ref_wx ... ref_wz, ref_vx ... ref_vz");
  if (out.acceleration.cols() != 6)
    columns.missing("acceleration of the reference",
                    "name its columns ref_alphax ... ref_alphaz, ref_ax ... ref_az");
  return out;
}

}  // namespace

void check(const Log& log) {
  for (std::size_t k = 0; k < log.t.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const std::string place = log.source + ": sample " + std::to_string(k + 1);
    if (!std::isfinite(log.t[k]) || (k > 0 && !(log.t[k] > log.t[k - 1])))
      throw LogError(place + ": t = " + std::to_string(log.t[k]) +
                     " s does not follow the one before it; give the "
                     "samples in the order of time");
    if (!log.q.row(row).allFinite() || !log.qd.row(row).allFinite() || !log.tau.row(row).allFinite())
      throw LogError(place + ": q, qd or tau is not finite; leave such samples out");
  }
}

Log read_log(const std::filesystem::path& file, const Chain<double>& model,
             const std::vector<std::string>& joints, std::size_t task_rows) {
  const bool hdf5 = is_hdf5(file);
  NamedColumns table;
  if (hdf5) {
    table = read_log_table(file, time_names);
  } else {
    auto [read, fault] = read_csv(file);
    if (!fault.empty()) throw LogError(fault);
    table = std::move(read);
  }
  const std::string source = file.string();
  const Columns columns(table, source);
  Log out;
  out.source = source;
  const auto* t = columns.one(time_names);
  if (!t) columns.missing("time", "name its column t, in s");
  out.t = *t;
  const bool from_osculate = columns.numbered({"trajectory/joint_position"}).cols() > 0;
  out.q = joint_columns(columns, {"q", "position", "trajectory/joint_position"}, joints, model.positions(),
                        source);
  out.qd = joint_columns(columns, {"qd", "dq", "velocity", "trajectory/joint_velocity"}, joints,
                         model.velocities(), source);
  out.tau = joint_columns(columns, {"tau", "effort", "torque", "trajectory/joint_torque"}, joints,
                          model.velocities(), source);
  Matrix u = columns.named({"u"}, {"wx", "wy", "wz", "vx", "vy", "vz"});
  if (u.cols() == 6) {
    out.u_order = RowOrder::angular_first;
  } else {
    u = columns.numbered({"u", "trajectory/command"});
    if (from_osculate) out.u_order = RowOrder::angular_first;
  }
  if (u.cols() > 0) {
    if (u.cols() != 6 && u.cols() != static_cast<Eigen::Index>(task_rows))
      throw LogError(source + ": has " + std::to_string(u.cols()) +
                     " columns of u; give six, or one for each of the " + std::to_string(task_rows) +
                     " task rows");
    out.u = u;
  } else {
    out.reference = reference(columns, from_osculate, out.quaternion_order);
    if (!out.reference)
      columns.missing(
          "command",
          "give u_wx ... u_vz, the commanded tip acceleration, or the reference: ref_x, ref_y, ref_z, "
          "ref_qw ... ref_qz, ref_wx ... ref_vz, ref_alphax ... ref_az. Without either any torque could "
          "be right");
  }
  check(out);
  return out;
}

}  // namespace osculate
