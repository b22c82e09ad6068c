// A law in a program of its own that reads and writes lines, one JSON object each: docs/your-controller.md.
#pragma once

#include <osculate/controller.h>

#include "plugin/user_law.hpp"

namespace osculate {

inline constexpr int protocol_version = 1;

/// In a child: becomes the program, with the socket as standard input and output. Returns an exit code, after
/// a line that says why, where it cannot.
int become_program(int socket, const UserLawOptions& law);

/// The first line, and the question at one instant; with the end of the line.
std::string first_line(const UserLawSetup& setup);
std::string question(const osculate_controller_input& in);

/// An answer that cannot be used. The message continues "controller ... ": "gave 5 torques".
struct BadAnswer : std::runtime_error {
  BadAnswer(const std::string& what, std::string to_do)
      : std::runtime_error(what), remedy(std::move(to_do)) {}
  std::string remedy;
};
/// One with a number that is not finite: at another state there may be better ones.
struct NotFinite : BadAnswer {
  using BadAnswer::BadAnswer;
};
/// The law says itself that it cannot go on: its text.
struct Refusal : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Checks the answer to the first line. Throws BadAnswer, Refusal.
void read_first_answer(const std::string& line);
/// An answer into `out`, which is preset to what is not in it. Throws BadAnswer, Refusal.
void read_answer(const std::string& line, UserLawAnswer& out);

}  // namespace osculate
