#include "plugin/helper_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <thread>

namespace osculate {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int child_socket = 3;

/// The rest of the child's life.
[[noreturn]] void live(int socket, pid_t parent, const std::function<int(int)>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);  // it died meanwhile
  setsid();
  for (const int number : {SIGINT, SIGTERM, SIGPIPE, SIGALRM}) std::signal(number, SIG_DFL);
  if (socket != child_socket && dup2(socket, child_socket) < 0) _exit(127);
  if (const int nothing = open("/dev/null", O_RDONLY); nothing >= 0) dup2(nothing, STDIN_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  if (close_range(child_socket + 1, ~0u, 0) != 0)  // the kernel is older than that call
    for (int file = child_socket + 1; file < 1024; ++file) close(file);
  // Code that calls exit() must not run what this process would do at its end.
  on_exit(
      [](int status, void*) {
        std::fflush(nullptr);
        _exit(status);
      },
      nullptr);
  std::exit(work(child_socket));
}

}  // namespace

HelperProcess::HelperProcess(const std::function<int(int)>& work) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw HelperGone(std::string("cannot be given a socket (") + std::strerror(errno) + ")");
  std::cout.flush();  // or the child would print it once more
  std::fflush(nullptr);
  const pid_t parent = getpid();
  child_ = fork();
  if (child_ == 0) live(ends[1], parent, work);
  close(ends[1]);
  socket_ = ends[0];
  if (child_ < 0) {
    const std::string why = std::strerror(errno);
    close(socket_);
    throw HelperGone("cannot be given a process (" + why + ")");
  }
}

HelperProcess::~HelperProcess() {
  close(socket_);
  if (!ended(std::chrono::seconds(1))) kill();
}

bool HelperProcess::ended(std::chrono::milliseconds patience) {
  const auto until = Clock::now() + patience;
  auto pause = std::chrono::microseconds(20);
  while (child_ > 0) {
    const pid_t found = waitpid(child_, &status_, WNOHANG);
    if (found == child_ || (found < 0 && errno != EINTR)) {
      child_ = -1;
      break;
    }
    if (Clock::now() > until) return false;
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, std::chrono::microseconds(5000));
  }
  return true;
}

void HelperProcess::kill() {
  if (child_ <= 0) return;
  ::kill(-child_, SIGKILL);  // and what it has started
  ::kill(child_, SIGKILL);
  while (waitpid(child_, &status_, 0) < 0 && errno == EINTR) continue;
  child_ = -1;
}

void HelperProcess::gone() {
  if (!ended(std::chrono::seconds(1))) {
    kill();
    throw HelperGone("closed its end of the connection");
  }
  if (WIFSIGNALED(status_)) throw HelperGone(std::string("crashed (") + strsignal(WTERMSIG(status_)) + ")");
  throw HelperGone("ended itself (exit code " + std::to_string(WEXITSTATUS(status_)) + ")");
}

void HelperProcess::wait_until_ready(short events, Deadline deadline) {
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(deadline - Clock::now()).count();
    if (left <= 0) {
      kill();
      throw HelperLate("");
    }
    pollfd waiting{socket_, events, 0};
    const timespec time{left / 1'000'000'000, left % 1'000'000'000};
    const int ready = ppoll(&waiting, 1, &time, nullptr);
    if (ready > 0) return;
  }
}

void HelperProcess::send(const char* data, std::size_t size, Deadline deadline) {
  if (child_ < 0) gone();
  while (size > 0) {
    const ssize_t sent = ::send(socket_, data, size, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent >= 0) {
      data += sent;
      size -= static_cast<std::size_t>(sent);
    } else if (errno == EAGAIN) {
      wait_until_ready(POLLOUT, deadline);
    } else if (errno != EINTR) {
      gone();
    }
  }
}

std::size_t HelperProcess::receive(char* data, std::size_t size, Deadline deadline) {
  for (;;) {
    wait_until_ready(POLLIN, deadline);
    const ssize_t got = recv(socket_, data, size, MSG_DONTWAIT);
    if (got > 0) return static_cast<std::size_t>(got);
    if (got == 0 || (errno != EAGAIN && errno != EINTR)) gone();
  }
}

bool send_all(int socket, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t sent = ::send(socket, data, size, MSG_NOSIGNAL);
    if (sent < 0 && errno != EINTR) return false;
    if (sent < 0) continue;
    data += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive_all(int socket, char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t got = recv(socket, data, size, 0);
    if (got == 0 || (got < 0 && errno != EINTR)) return false;
    if (got < 0) continue;
    data += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

}  // namespace osculate
