// The command line as a function.
#pragma once

namespace osculate {

/// Does what the arguments say; the exit code of the process. Results to stdout, messages to stderr.
int program(int argc, char** argv);

}  // namespace osculate
