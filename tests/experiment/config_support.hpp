// Small experiments as text, and the messages they cause.
#pragma once

#include "experiment/config.hpp"

namespace osculate {

using Strings = std::vector<std::string>;

/// The smallest experiment, one section a line; line 4 is free.
struct Lines {
  std::string model = "model: {urdf: arm.urdf, tip: tool}";
  std::string initial = "initial: {q: [0, 1]}";
  std::string controller = "controller: {law: operational_space}";
  std::string more = {};
  std::string text() const { return model + "\n" + initial + "\n" + controller + "\n" + more + "\n"; }
};

inline Experiment parse(const std::string& text, const Strings& overrides = {}) {
  return parse_experiment(text, "reach.yaml", "/arms/lab", overrides);
}
inline Experiment parse_with(const std::string& more, const Strings& overrides = {}) {
  return parse(Lines{.more = more}.text(), overrides);
}

/// The message of the ConfigError that `call` throws; a note where it throws none.
template <class Call>
std::string message(Call call) {
  try {
    call();
  } catch (const ConfigError& error) { return error.what(); }
  return "(accepted)";
}
inline std::string message_of(const std::string& text, const Strings& overrides = {}) {
  return message([&] { parse(text, overrides); });
}
inline std::string message_of_set(const std::string& override_text) {
  return message_of(Lines{}.text(), {override_text});
}

}  // namespace osculate
