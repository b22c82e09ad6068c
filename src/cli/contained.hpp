// Work on files that may be hostile, in a process of its own. HDF5 1.10 trusts parts of a file that have no
// checksum (global heaps above all): damaged bytes there can make the library crash, or search for ever. Then
// only the child ends.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <iostream>

#include "experiment/run.hpp"
#include "record/restart_point.hpp"
#include "record/texts.hpp"

namespace osculate {

/// Tells the parent that there is progress: within the next minute there must be more.
inline void still_alive() { alarm(60); }

/// Does `work` (which reports its own errors and returns an exit code) in a child and returns its code. Where
/// the child dies, says so of `file` and returns Exit::io_failure. Where there can be no child, does it here.
template <class Work>
Exit contained(const std::string& file, const Work& work) {
  std::cout.flush();
  const pid_t child = fork();
  if (child < 0) return work();
  if (child == 0) {
    std::signal(SIGALRM, SIG_DFL);
    still_alive();
    const Exit code = work();
    std::cout.flush();
    _exit(static_cast<int>(std::cout ? code : Exit::io_failure));
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (WIFEXITED(status)) return static_cast<Exit>(WEXITSTATUS(status));
  const bool late = WTERMSIG(status) == SIGALRM || WTERMSIG(status) == SIGXCPU;
  std::cerr << "osculate: " << file << ": is damaged so that reading it "
            << (late ? "came to no end"
                     : std::string("crashed the HDF5 library (") + strsignal(WTERMSIG(status)) + ")")
            << "; nothing was written under the final name\n";
  return Exit::io_failure;
}

/// Reads all of a result file in a child. After Exit::ok this process can read it too, and says itself what
/// else may be wrong with the file.
inline Exit try_reading(const std::filesystem::path& file) {
  return contained(file.string(), [&] {
    const auto attempt = [](const auto& read) {
      try {
        read();
      } catch (const std::exception&) {}
    };
    attempt([&] { read_texts(file); });
    attempt([&] { last_restart_point(file); });
    attempt([&] { read_all(file, still_alive); });
    return Exit::ok;
  });
}

}  // namespace osculate
