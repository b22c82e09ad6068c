#include "record/ending.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "record/hdf5_create.hpp"

namespace osculate {
namespace {

using hdf5::Check;
using hdf5::Creator;
using hdf5::Handle;
using hdf5::stored_type;

void write_verdict(Creator& create, const std::vector<VerdictRow>& rows) {
  std::vector<std::string> claims, equations, reasons;
  for (const VerdictRow& row : rows) {
    claims.push_back(row.claim);
    equations.push_back(row.equation);
    reasons.push_back(row.reason);
  }
  const Handle claim = create.strings("verdict/claim", claims, false, "claim checked along the trajectory");
  create.make_scale(claim, "verdict/claim");
  const auto along_claim = [&](const std::string& where, const std::vector<std::string>& values,
                               const std::string& long_name) {
    create.attach(create.strings(where, values, false, long_name), where, {"verdict/claim"});
  };
  const auto numbers = [&]<class T>(const std::string& where, T VerdictRow::*member, Kind kind,
                                    const std::string& unit, const std::string& long_name) {
    std::vector<double> values;
    for (const VerdictRow& row : rows) values.push_back(static_cast<double>(row.*member));
    Handle made =
        create.dataset(where, stored_type(kind), {rows.size()}, {}, kind == Kind::real, unit, long_name);
    create.attach(made, where, {"verdict/claim"});
    create.write(made, where, H5T_NATIVE_DOUBLE, values.data());
    return made;
  };
  along_claim("verdict/equation", equations, "equation of the source that the claim checks");
  numbers("verdict/worst", &VerdictRow::worst, Kind::real, "", "worst residual");
  numbers("verdict/bound", &VerdictRow::bound, Kind::real, "", "bound at the worst residual");
  numbers("verdict/at_time", &VerdictRow::at_time, Kind::real, "s", "time of the worst residual");
  const Handle result =
      numbers("verdict/result", &VerdictRow::result, Kind::small, "", "1 pass, 0 fail, -1 not applicable");
  const std::int8_t flags[] = {-1, 0, 1};
  create.number_attribute(result, "flag_values", H5T_STD_I8LE, H5T_NATIVE_INT8, flags);
  create.text_attribute(result, "flag_meanings", "not_applicable fail pass");
  numbers("verdict/undecided_steps", &VerdictRow::undecided_steps, Kind::integer, "",
          "steps without a decision");
  numbers("verdict/checked_steps", &VerdictRow::checked_steps, Kind::integer, "", "steps checked");
  along_claim("verdict/reason", reasons, "why the result is what it is");
}

/// Axes, then what lies along them and along those that the file has already.
void write_along_axes(Creator& create, const Ending& ending, const FixedAxes& sizes) {
  for (const Axis& axis : ending.axes) create.fixed_axis(axis);
  for (const Table& table : ending.tables) {
    std::vector<hsize_t> extent;
    for (const std::string& axis : table.axes) extent.push_back(sizes.at(axis));
    const bool holes =
        std::any_of(table.values.begin(), table.values.end(), [](double x) { return std::isnan(x); });
    const Handle made =
        create.dataset(table.path, H5T_IEEE_F64LE, extent, {}, holes, table.unit, table.long_name);
    create.attach(made, table.path, table.axes);
    create.write(made, table.path, H5T_NATIVE_DOUBLE, table.values.data());
  }
  for (const StringList& list : ending.lists)
    create.attach(create.strings(list.path, list.values, false, list.long_name), list.path, {list.axis});
}

}  // namespace

void require(bool good, const std::string& message) {
  if (!good) throw std::invalid_argument("result layout: " + message);
}

void require_one_kind(const Axis& axis) {
  require(axis.labels.empty() || axis.coordinates.empty(),
          "axis '" + axis.name + "' has labels and coordinates; it can have one of them");
  for (const double x : axis.coordinates)
    require(std::isfinite(x), "axis '" + axis.name + "' has a coordinate that is not finite");
}

void require_fits(const StringList& list, std::size_t size) {
  require(size > 0 && size == list.values.size(),
          list.path + ": needs one string for each element of the fixed axis '" + list.axis + "'");
}

FixedAxes checked_axes(const Ending& ending, const FixedAxes& layout) {
  FixedAxes sizes = layout;
  for (const Axis& axis : ending.axes) {
    require(axis.fixed(), "axis '" + axis.name + "' of the ending has neither labels nor coordinates");
    require_one_kind(axis);
    require(sizes.emplace(axis.name, axis.size()).second, "axis '" + axis.name + "' given twice");
  }
  const auto size_of = [&sizes](const std::string& axis, const std::string& user) {
    require(sizes.contains(axis), user + ": '" + axis + "' is not a fixed axis of this file");
    return sizes.at(axis);
  };
  for (const Table& table : ending.tables) {
    require(!table.axes.empty(), table.path + ": has no axis");
    require(std::set(table.axes.begin(), table.axes.end()).size() == table.axes.size(),
            table.path + ": one axis twice; two equal axes need two names");
    std::size_t count = 1;
    for (const std::string& axis : table.axes) count *= size_of(axis, table.path);
    require(count == table.values.size(), table.path + ": has " + std::to_string(table.values.size()) +
                                              " values, not " + std::to_string(count));
  }
  for (const StringList& list : ending.lists) require_fits(list, size_of(list.axis, list.path));
  return sizes;
}

void write_ending(hid_t file, const Check& check, const std::string& status, const std::string& verdict,
                  const Ending& ending, const FixedAxes& sizes) {
  Creator create(file, check);
  if (!ending.rows.empty()) write_verdict(create, ending.rows);
  for (const Scalar& scalar : ending.scalars) {
    const Handle made =
        create.dataset(scalar.path, H5T_IEEE_F64LE, {}, {}, true, scalar.unit, scalar.long_name);
    create.write(made, scalar.path, H5T_NATIVE_DOUBLE, &scalar.value);
  }
  write_along_axes(create, ending, sizes);
  create.write_references();
  const Handle root = check(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "open the root group");
  const Handle attribute = check(H5Aopen(root, "status", H5P_DEFAULT), H5Aclose, "open attribute", "status");
  const char* const text = status.c_str();
  check(H5Awrite(attribute, hdf5::string_type(), &text), "write attribute", "status");
  if (!verdict.empty()) create.text_attribute(root, "verdict", verdict);
}

}  // namespace osculate
