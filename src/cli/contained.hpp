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
  const bool late = WTERMSIG(status) == SIGALRM;
  std::cerr << "osculate: " << file << ": is damaged so that reading it "
            << (late ? "came to no end"
                     : std::string("crashed the HDF5 library (") + strsignal(WTERMSIG(status)) + ")")
            << "; nothing was written under the final name\n";
  return Exit::io_failure;
}

}  // namespace osculate
