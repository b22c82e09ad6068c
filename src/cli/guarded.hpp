// Failures as messages and exit codes.
#pragma once

#include <iostream>

#include "experiment/run.hpp"
#include "judge/log.hpp"

namespace osculate {

/// The gravest of several exit codes: interruption, then 4 > 3 > 2 > 1 > 0.
inline Exit graver(Exit a, Exit b) { return static_cast<int>(a) > static_cast<int>(b) ? a : b; }

/// Runs `work`, turning every known failure into its message and exit code.
template <class Work>
Exit guarded(const Work& work) {
  const auto complain = [](const std::exception& error, Exit code) {
    std::cerr << "osculate: " << error.what() << "\n";
    return code;
  };
  try {
    return work();
  } catch (const FileError& error) {
    return complain(error, Exit::io_failure);
  } catch (const ConfigError& error) {
    return complain(error, Exit::bad_input);
  } catch (const ModelError& error) {
    return complain(error, Exit::bad_input);
  } catch (const ReferenceError& error) {
    return complain(error, Exit::bad_input);
  } catch (const LogError& error) {
    return complain(error, Exit::bad_input);
  } catch (const IntegrationStopped& error) {
    return complain(error, Exit::stopped);
  } catch (const std::exception& error) { return complain(error, Exit::stopped); }
}

}  // namespace osculate
