// The sections `reference` and `base_motion`.
#include <algorithm>

#include "experiment/config_sections.hpp"

namespace osculate {
namespace {

using yaml::above_zero;
using yaml::at_least_zero;
using yaml::fail;
using yaml::fail_missing;
using yaml::Map;
using yaml::read;
using yaml::Setting;

const yaml::TypeKeys reference_types{
    {"hold", {}},
    {"step", {"offset", "at"}},
    {"line", {"offset", "start", "duration"}},
    {"circle", {"radius", "period", "plane"}},
    {"lissajous", {"amplitude", "period", "phase"}},
    {"waypoints", {"file"}},
    {"each_axis", {"amplitude", "period"}},
    {"multisine", {"row", "amplitude", "frequencies"}},
};

EachAxisOptions read_each_axis(const Map& map) {
  EachAxisOptions out;
  const auto amplitude = map.at("amplitude");
  if (!amplitude.given())
    fail_missing(amplitude, "give six jumps in rad and m; axes with 0 are passed over.");
  read(amplitude, out.amplitude);
  if (out.amplitude.isZero(0)) fail(amplitude, "must have a number that is not 0: there is no axis to move.");
  read(map.at("period"), out.period, above_zero("the time of one axis"));
  return out;
}

MultisineOptions read_multisine(const Map& map) {
  MultisineOptions out;
  const auto frequencies = map.at("frequencies");
  if (map.at("row").given()) out.row = read_row(map.at("row"));
  read(map.at("amplitude"), out.amplitude);
  read(frequencies, out.frequencies, above_zero(), "a list of frequencies in Hz");
  if (out.frequencies.empty()) fail(frequencies, "must have at least one frequency in Hz.");
  for (std::size_t i = 0; i < out.frequencies.size(); ++i)
    if (std::find(out.frequencies.begin(), out.frequencies.begin() + static_cast<std::ptrdiff_t>(i),
                  out.frequencies[i]) != out.frequencies.begin() + static_cast<std::ptrdiff_t>(i))
      fail(yaml::entries(frequencies, "")[i], "is given twice: remove one.");
  return out;
}

}  // namespace

int read_row(const Setting& setting) {
  const std::vector<std::string> names(task_row_names.begin(), task_row_names.end());
  const auto name = yaml::read_word(setting, names);
  return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
}

ReferenceConfig read_reference(const Setting& setting, const std::filesystem::path& directory) {
  const auto [type, map] = yaml::typed_map(setting, reference_types, "hold");
  if (type == "step") {
    StepOptions out;
    read(map.at("offset"), out.offset);
    read(map.at("at"), out.at, at_least_zero());
    return out;
  }
  if (type == "line") {
    LineOptions out;
    read(map.at("offset"), out.offset);
    read(map.at("start"), out.start, at_least_zero());
    read(map.at("duration"), out.duration, above_zero("use type step for a jump"));
    return out;
  }
  if (type == "circle") {
    CircleOptions out;
    read(map.at("radius"), out.radius, above_zero("use type hold to stay"));
    read(map.at("period"), out.period, above_zero("exchange the letters of plane to turn the other way"));
    if (map.at("plane").given())
      out.plane = yaml::read_word(map.at("plane"), {"xy", "yx", "yz", "zy", "zx", "xz"});
    return out;
  }
  if (type == "lissajous") {
    LissajousOptions out;
    read(map.at("amplitude"), out.amplitude);
    yaml::read_one_or_six(map.at("period"), out.period, above_zero());
    yaml::read_one_or_six(map.at("phase"), out.phase);
    return out;
  }
  if (type == "waypoints") {
    std::string file;
    if (!map.at("file").given()) fail_missing(map.at("file"), "give a CSV file with the columns t,x,y,z.");
    read(map.at("file"), file);
    const auto absolute = resolve(directory, file);
    return WaypointsOptions{absolute, text_of(absolute)};  // a missing file is reported where it is used
  }
  if (type == "each_axis") return read_each_axis(map);
  if (type == "multisine") return read_multisine(map);
  return HoldOptions{};
}

ReferenceConfig read_base_motion(const Setting& setting, const std::filesystem::path& directory) {
  const auto out = read_reference(setting, directory);
  const bool moves_a_base =
      std::holds_alternative<HoldOptions>(out) || std::holds_alternative<LineOptions>(out) ||
      std::holds_alternative<CircleOptions>(out) || std::holds_alternative<LissajousOptions>(out);
  if (!moves_a_base) fail(setting, "a base moves along type line, circle or lissajous.");
  return out;
}

}  // namespace osculate
