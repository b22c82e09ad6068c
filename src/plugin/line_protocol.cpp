#include "plugin/line_protocol.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "plugin/helper_process.hpp"
#include "plugin/json.hpp"

namespace osculate {

namespace {

constexpr std::array<const char*, 6> row_names{"wx", "wy", "wz", "vx", "vy", "vz"};

/// One JSON object on one line.
class Line {
 public:
  template <class Value>
  Line& add(const char* key, const Value& value) {
    begin(key);
    add_json(text_, value);
    return *this;
  }
  /// `json`: written already.
  Line& add_written(const char* key, const std::string& json) {
    begin(key);
    text_ += json;
    return *this;
  }
  std::string object() const { return "{" + text_ + "}"; }

 private:
  void begin(const char* key) {
    if (!text_.empty()) text_ += ", ";
    add_json(text_, std::string_view(key));
    text_ += ": ";
  }
  std::string text_;
};

std::string list_of_texts(const std::vector<std::string>& texts) {
  std::string out = "[";
  for (const auto& text : texts) {
    if (out.size() > 1) out += ", ";
    add_json(out, std::string_view(text));
  }
  return out + "]";
}

/// Row by row.
std::string matrix(const double* numbers, std::size_t rows, std::size_t columns) {
  std::string out = "[";
  for (std::size_t i = 0; i < rows; ++i) {
    if (i > 0) out += ", ";
    add_json(out, std::span(numbers + i * columns, columns));
  }
  return out + "]";
}

std::string shown(const std::string& line) {
  constexpr std::size_t most = 60;
  std::string out = "'";
  for (const char c : line.substr(0, most)) out += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  return out + (line.size() > most ? "...'" : "'");
}

JsonValue object(const std::string& line) {
  try {
    JsonValue out = parse_json(line);
    if (out.kind == JsonValue::Kind::object) return out;
    throw JsonError("expected an object");
  } catch (const JsonError& error) {
    throw BadAnswer("printed " + shown(line) + ", which is no answer (" + error.what() + "),",
                    "print one JSON object on one line, flush it, and print nothing else to standard output");
  }
}

[[noreturn]] void unknown_key(const std::string& key, const char* known) {
  throw BadAnswer("answered with the unknown key '" + key + "'",
                  std::string("the keys of an answer are ") + known);
}

void read_numbers(const std::string& key, const JsonValue& value, std::vector<double>& out) {
  bool fine = value.kind == JsonValue::Kind::list;
  out.clear();
  for (const JsonValue& item : value.items) {
    fine = fine && item.kind == JsonValue::Kind::number;
    out.push_back(item.number);
  }
  if (!fine) throw BadAnswer("gave no list of numbers as " + key, "give [x, y, ...]");
}

}  // namespace

int become_program(int socket, const UserLawOptions& law) {
  const auto complain = [&socket](const std::string& what) {
    const std::string line = Line().add("error", std::string_view(what)).object() + "\n";
    send_all(socket, line.data(), line.size());
    return 127;
  };
  if (chdir(law.directory.c_str()) != 0)
    return complain("its directory " + law.directory + " cannot be entered: " + std::strerror(errno));
  if (dup2(socket, STDIN_FILENO) < 0 || dup2(socket, STDOUT_FILENO) < 0) return 127;
  close(socket);
  socket = STDOUT_FILENO;
  std::vector<char*> arguments;
  for (const auto& argument : law.process) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  return complain(law.process[0] + " cannot be run: " + std::strerror(errno));
}

std::string first_line(const UserLawSetup& setup) {
  const UserLawModel& m = setup.model;
  std::vector<std::string> rows;
  for (const int row : m.rows) rows.emplace_back(row_names[static_cast<std::size_t>(row)]);
  return Line()
             .add("protocol", double{protocol_version})
             .add("urdf", std::string_view(m.urdf))
             .add("base", std::string_view(m.base))
             .add("tip", std::string_view(m.tip))
             .add("side_branches", std::string_view(m.lump_side_branches ? "lump" : "drop"))
             .add("gravity", std::span<const double>(m.gravity))
             .add_written("joints", list_of_texts(m.joints))
             .add("positions", static_cast<double>(m.positions))
             .add("velocities", static_cast<double>(m.velocities))
             .add("armature", std::span<const double>(m.armature))
             .add_written("rows", list_of_texts(rows))
             .add("stiffness", std::span<const double>(m.stiffness))
             .add("damping", std::span<const double>(m.damping))
             .add("period", m.period)
             .add("options", std::string_view(setup.law.options))
             .object() +
         "\n";
}

std::string question(const osculate_controller_input& in) {
  const auto np = static_cast<std::size_t>(in.positions), nv = static_cast<std::size_t>(in.velocities),
             m = static_cast<std::size_t>(in.rows);
  using Numbers = std::span<const double>;
  const auto frame = [](Numbers position, Numbers orientation, Numbers velocity, const double* acceleration) {
    Line out;
    out.add("position", position).add("orientation", orientation).add("velocity", velocity);
    if (acceleration != nullptr) out.add("acceleration", Numbers(acceleration, 6));
    return out.object();
  };
  Line out;
  out.add("t", in.t)
      .add("q", Numbers(in.q, np))
      .add("qd", Numbers(in.qd, nv))
      .add_written("tip", frame(in.tip_position, in.tip_orientation, in.tip_velocity, nullptr))
      .add_written("reference", frame(in.reference_position, in.reference_orientation, in.reference_velocity,
                                      in.reference_acceleration))
      .add_written("base",
                   frame(in.base_position, in.base_orientation, in.base_velocity, in.base_acceleration))
      .add("u", Numbers(in.u, m))
      .add("null_space_torque", Numbers(in.null_space_torque, nv));
  if (in.tip_force_known != 0) out.add("tip_force", Numbers(in.tip_force));
  if (in.M != nullptr)
    out.add_written("M", matrix(in.M, nv, nv))
        .add("C", Numbers(in.C, nv))
        .add("G", Numbers(in.G, nv))
        .add_written("J", matrix(in.J, m, nv))
        .add("Jdot_qd", Numbers(in.Jdot_qd, m));
  return out.object() + "\n";
}

void read_first_answer(const std::string& line) {
  const JsonValue answer = object(line);
  bool told = false;
  for (std::size_t i = 0; i < answer.items.size(); ++i) {
    const JsonValue& value = answer.items[i];
    if (answer.keys[i] == "error") throw Refusal(value.text);
    if (answer.keys[i] != "protocol") unknown_key(answer.keys[i], "protocol or error, for the first line");
    if (value.kind != JsonValue::Kind::number || value.number != protocol_version)
      throw BadAnswer("speaks another version of the line protocol",
                      "this osculate speaks version " + std::to_string(protocol_version));
    told = true;
  }
  if (!told)
    throw BadAnswer("did not tell its protocol",
                    "answer the first line with {\"protocol\": " + std::to_string(protocol_version) + "}");
}

void read_answer(const std::string& line, UserLawAnswer& out) {
  const JsonValue answer = object(line);
  bool given = false;
  for (std::size_t i = 0; i < answer.items.size(); ++i) {
    const std::string& key = answer.keys[i];
    if (key == "error") throw Refusal(answer.items[i].text);
    if (key == "torque")
      read_numbers(key, answer.items[i], out.torque), given = true;
    else if (key == "u")
      read_numbers(key, answer.items[i], out.u);
    else if (key == "null_space_torque")
      read_numbers(key, answer.items[i], out.null_space_torque);
    else
      unknown_key(key, "torque, u, null_space_torque or error");
  }
  if (!given)
    throw BadAnswer("answered without the key 'torque'", "give one number for each velocity coordinate");
}

}  // namespace osculate
