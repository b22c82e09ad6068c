// A child process at the other end of a socket, which may crash, hang or end without harm to this one.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>

namespace osculate {

/// The child did not answer in time; it has been killed.
struct HelperLate : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The child is gone. The message says how it ended: "crashed (Segmentation fault)".
struct HelperGone : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class HelperProcess {
 public:
  using Deadline = std::chrono::steady_clock::time_point;

  /// Forks. The child leads a session of its own (Ctrl-C does not reach it), dies with this process, keeps no
  /// open file but `socket` and standard error, writes to standard error what it prints, and ends with the
  /// code that `work` returns. Throws HelperGone where there can be no child.
  explicit HelperProcess(const std::function<int(int socket)>& work);
  /// Closes the socket, and kills the child if that does not end it within a second.
  ~HelperProcess();
  HelperProcess(const HelperProcess&) = delete;
  HelperProcess& operator=(const HelperProcess&) = delete;

  /// All `size` bytes. Throws HelperLate, HelperGone.
  void send(const char* data, std::size_t size, Deadline deadline);
  /// At least one byte and at most `size`. Throws HelperLate, HelperGone.
  std::size_t receive(char* data, std::size_t size, Deadline deadline);

 private:
  void wait_until_ready(short events, Deadline deadline);
  [[noreturn]] void gone();
  bool ended(std::chrono::milliseconds patience);
  void kill();

  int socket_ = -1;
  pid_t child_ = -1;
  int status_ = 0;  // of the child, once child_ is -1
};

/// In a child: all `size` bytes to the parent; false where it is gone.
bool send_all(int socket, const char* data, std::size_t size);
/// In a child: exactly `size` bytes from the parent; false where it is gone.
bool receive_all(int socket, char* data, std::size_t size);

}  // namespace osculate
