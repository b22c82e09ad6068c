// A law in a shared library, loaded by a child process. Both sides of the socket: fixed structures, then the
// arrays that they name, in the order of osculate_controller_input and _output.
#pragma once

#include <osculate/controller.h>

#include "plugin/user_law.hpp"

namespace osculate {

/// What the child says first, and before each answer.
struct LibraryReply {
  enum Status : std::int32_t { fine, refused, overrun /* it wrote past the end of an array */ };
  std::int32_t status = fine;
  char message[1020] = "";
};

/// A question as bytes.
std::vector<char> packed(const osculate_controller_input& in);

/// The child's life: loads, creates, answers until the parent is gone. Returns its exit code.
int serve_library(int socket, const UserLawSetup& setup);

}  // namespace osculate
