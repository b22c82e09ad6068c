// The parts of the Python module osculate._core, one file each; module.cpp puts them together. A new part is
// a file with one function of this kind.
#pragma once

#include <pybind11/pybind11.h>

namespace osculate::python {

void bind_chain(pybind11::module_& module);       // chain.cpp: Chain, Terms
void bind_experiment(pybind11::module_& module);  // experiment.cpp: Experiment, Run, Claim

}  // namespace osculate::python
