#include "python/arrays.hpp"

#include <algorithm>
#include <cmath>

namespace py = pybind11;

namespace osculate::python {

namespace {

std::string shape_text(const py::array& a) {
  std::string out = "(";
  for (py::ssize_t i = 0; i < a.ndim(); ++i) out += (i ? ", " : "") + std::to_string(a.shape(i));
  return out + (a.ndim() == 1 ? ",)" : ")");
}

[[noreturn]] void refuse(const std::string& text) { throw py::value_error(text); }

}  // namespace

StateRows States::add(const py::object& argument, const char* name, int columns, const std::string& meaning) {
  const std::string width = std::to_string(columns);
  const std::string wanted = "give shape (" + width + ",) or (N, " + width + "): " + meaning;
  if (argument.is_none()) {
    Array zeros(columns);
    std::fill_n(zeros.mutable_data(), columns, 0.0);
    held_.push_back(zeros);
    return {zeros.data(), static_cast<std::size_t>(columns), true};
  }
  const py::array given = py::array::ensure(argument);
  if (!given) refuse(std::string(name) + " is no array of numbers: " + wanted);
  if (std::string("biuf").find(given.dtype().kind()) == std::string::npos)
    refuse(std::string(name) + " has dtype " + py::str(given.dtype()).cast<std::string>() +
           ", not real numbers: " + wanted);
  const bool many = given.ndim() == 2;
  if ((given.ndim() != 1 && !many) || given.shape(given.ndim() - 1) != columns)
    refuse(std::string(name) + " has shape " + shape_text(given) + ": " + wanted);
  if (many) {
    const auto rows = static_cast<std::size_t>(given.shape(0));
    if (count_ && *count_ != rows)
      refuse(std::string(name) + " has shape " + shape_text(given) + ", but " + counted_ +
             ": give as many states, or one of shape (" + width + ",) for all of them");
    if (!count_) counted_ = std::string(name) + " has shape " + shape_text(given);
    count_ = rows;
  }
  const Array numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
  if (!numbers) throw py::error_already_set();
  const double* const end = numbers.data() + numbers.size();
  const double* const wrong = std::find_if(numbers.data(), end, [](double x) { return !std::isfinite(x); });
  if (wrong != end) {
    const auto at = wrong - numbers.data();
    refuse(std::string(name) + "[" + (many ? std::to_string(at / columns) + ", " : "") +
           std::to_string(at % columns) + "] is " + std::to_string(*wrong) + ": give finite numbers");
  }
  held_.push_back(numbers);
  return {numbers.data(), static_cast<std::size_t>(columns), !many};
}

void set_entry(Array& to, std::size_t state, const MatrixX<double>& values) {
  double* at = to.mutable_data() + state * static_cast<std::size_t>(values.size());
  for (Eigen::Index i = 0; i < values.rows(); ++i)
    for (Eigen::Index j = 0; j < values.cols(); ++j) *at++ = values(i, j);
}

Array array_of(const VectorX<double>& values) { return Array(values.size(), values.data()); }

}  // namespace osculate::python
