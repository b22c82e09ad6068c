// osculate, and in a test build its copy with one seeded fault: OSCULATE_FAULT=name.
#include "cli/program.hpp"
#ifdef OSCULATE_FAULTS
#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "scalar/fault.hpp"
#endif

int main(int argc, char** argv) {
#ifdef OSCULATE_FAULTS
  using namespace osculate;
  if (const char* name = std::getenv("OSCULATE_FAULT"); name && *name) {
    const auto found = std::find(fault_names.begin(), fault_names.end(), name);
    if (found == fault_names.end()) return std::cerr << "no fault is named " << name << "\n", 2;
    active_fault = static_cast<Fault>(found - fault_names.begin());
  }
  const int code = program(argc, argv);
  if (active_fault != Fault::none)
    std::cerr << "fault " << fault_names[static_cast<std::size_t>(active_fault)] << " executed "
              << fault_executions << " times\n";
  return code;
#else
  return osculate::program(argc, argv);
#endif
}
