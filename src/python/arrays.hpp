// NumPy arrays in and out: shapes and numbers are checked here, with messages that name argument, shape and
// remedy.
#pragma once

#include <pybind11/numpy.h>

#include <optional>
#include <string>
#include <vector>

#include "model/chain.hpp"
#include "python/states.hpp"

namespace osculate::python {

using Array = pybind11::array_t<double, pybind11::array::c_style>;

/// States from arguments of shape (columns,) or (N, columns). An argument of shape (columns,) stands for
/// every state; results have the first axis N where any argument has it.
class States {
 public:
  /// Checks `argument` and adds it; `meaning` says what the columns are. Converts any real dtype and memory
  /// order. An absent argument (None) is zero. Throws pybind11::value_error.
  StateRows add(const pybind11::object& argument, const char* name, int columns, const std::string& meaning);

  std::size_t count() const { return count_.value_or(1); }
  bool many() const { return count_.has_value(); }
  /// A new array of one entry of shape `entry` for each state.
  template <class Number = double>
  pybind11::array_t<Number, pybind11::array::c_style> result(std::vector<pybind11::ssize_t> entry) const {
    if (many()) entry.insert(entry.begin(), static_cast<pybind11::ssize_t>(count()));
    return pybind11::array_t<Number, pybind11::array::c_style>(entry);
  }

 private:
  std::vector<Array> held_;
  std::optional<std::size_t> count_;
  std::string counted_;  // the argument that gave the count, with its shape
};

/// Writes `values`, row by row, as the entry of one state of `to`.
void set_entry(Array& to, std::size_t state, const MatrixX<double>& values);
/// An array of its own from a list of numbers.
Array array_of(const VectorX<double>& values);

}  // namespace osculate::python
