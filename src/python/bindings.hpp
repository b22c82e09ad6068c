// The parts of the Python module osculate._core, one file each; module.cpp puts them together. A new part is
// a file with one function of this kind.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

#include "model/chain.hpp"

namespace osculate::python {

void bind_chain(pybind11::module_& module);       // chain.cpp: Chain, Terms
void bind_experiment(pybind11::module_& module);  // experiment.cpp: Experiment, Run, Claim
void bind_judge(pybind11::module_& module);       // judge.cpp: judge, Judgement, Finding, Doubt, Coefficient

/// The arm of an osculate.Chain. Throws pybind11::cast_error for another object.
const Chain<double>& chain_of(const pybind11::object& chain);
/// Task rows by name; all six if absent. Throws pybind11::value_error.
std::vector<int> task_rows(const std::optional<std::vector<std::string>>& names);

}  // namespace osculate::python
