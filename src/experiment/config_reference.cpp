// The sections `reference` and `base_motion`.
#include <algorithm>

#include "experiment/config_sections.hpp"

namespace osculate {
namespace {

using yaml::above_zero;
using yaml::at_least_zero;
using yaml::fail;
using yaml::Map;
using yaml::read;
using yaml::Setting;

const yaml::Key offset{"offset", "rad, m", "displacement from the initial tip pose, six numbers, base axes"};
const yaml::TypeKeys reference_types{
    {"hold", {}},
    {"step", {offset, {"at", "s", "when the reference jumps, >= 0"}}},
    {"line",
     {offset,
      {"start", "s", "rest before it, >= 0"},
      {"duration", "s", "of the minimum-jerk motion, > 0; then rest"}}},
    {"circle",
     {{"radius", "m", "> 0"},
      {"period", "s", "one turn, > 0"},
      {"plane", "",
       "two of x, y, z. The motion starts along the second; the centre lies towards minus the first"}}},
    {"lissajous",
     {{"amplitude", "rad, m", "six numbers"},
      {"period", "s", "a number or six; y = amplitude (sin(2 pi t / period + phase) - sin(phase))"},
      {"phase", "rad", "a number or six"}}},
    {"waypoints",
     {{"file", "", "CSV with header t,x,y,z or t,x,y,z,qw,qx,qy,qz, base frame; at most 1e6 rows"}}},
    {"each_axis",
     {{"amplitude", "rad, m", "six jumps, one axis after the other; axes with 0 are passed over"},
      {"period", "s", "time of one axis, > 0: half of it displaced, half of it back"}}},
    {"multisine",
     {{"row", "", "the task row that moves", "vx"},
      {"amplitude", "rad, m", "of each sine"},
      {"frequencies", "Hz", "a list, each > 0, none twice"}}},
};

EachAxisOptions read_each_axis(const Map& map) {
  EachAxisOptions out;
  const auto amplitude = map.at("amplitude");
  yaml::require_given(amplitude, "give six jumps in rad and m; axes with 0 are passed over.");
  read(amplitude, out.amplitude);
  if (out.amplitude.isZero(0)) fail(amplitude, "must have a number that is not 0: there is no axis to move.");
  read(map.at("period"), out.period, above_zero("the time of one axis"));
  return out;
}

MultisineOptions read_multisine(const Map& map) {
  MultisineOptions out;
  const auto frequencies = map.at("frequencies");
  yaml::note_words(map.at("row"), {task_row_names.begin(), task_row_names.end()}, task_row_names[3]);
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

namespace {

ReferenceConfig read_path(const Setting& setting, const yaml::TypeKeys& types,
                          const std::filesystem::path& directory) {
  const auto [type, map] = yaml::typed_map(setting, types, "hold");
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
    const std::vector<std::string> planes{"xy", "yx", "yz", "zy", "zx", "xz"};
    yaml::note_words(map.at("plane"), planes, out.plane);
    if (map.at("plane").given()) out.plane = yaml::read_word(map.at("plane"), planes);
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
    yaml::require_given(map.at("file"), "give a CSV file with the columns t,x,y,z.");
    read(map.at("file"), file);
    const auto absolute = resolve(directory, file);
    return WaypointsOptions{absolute, text_of(absolute)};  // a missing file is reported where it is used
  }
  if (type == "each_axis") return read_each_axis(map);
  if (type == "multisine") return read_multisine(map);
  return HoldOptions{};
}

}  // namespace

ReferenceConfig read_reference(const Setting& setting, const std::filesystem::path& directory) {
  return read_path(setting, reference_types, directory);
}

ReferenceConfig read_base_motion(const Setting& setting, const std::filesystem::path& directory) {
  yaml::TypeKeys smooth;
  for (const auto& [type, keys] : reference_types) {
    const bool moves_a_base = type == "hold" || type == "line" || type == "circle" || type == "lissajous";
    if (moves_a_base) smooth.emplace_back(type, keys);
    if (moves_a_base || !yaml::is_map(setting)) continue;
    for (const auto& item : setting.value->items)
      if (item.key == "type" && item.text == type)
        fail(setting, "a base moves along type line, circle or lissajous.");
  }
  return read_path(setting, smooth, directory);
}

}  // namespace osculate
