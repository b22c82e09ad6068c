// What a run carries from one restart point to the next, as one list of numbers.
#pragma once

#include <Eigen/Core>
#include <array>
#include <concepts>
#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

namespace osculate {

/// A list of numbers that is not the memory of this object: too short, too long or out of range.
struct MemoryMismatch : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Writes the members of an object one after the other, or reads them back. An object with more than numbers
/// in it has a function `void remember(Memory& memory) { memory(member, ...); }`: one list of members for
/// both ways. Doubles keep every bit; whole numbers must be below 2^53.
class Memory {
 public:
  /// To be written.
  Memory() = default;
  /// To be read.
  explicit Memory(std::vector<double> numbers) : numbers_(std::move(numbers)), reading_(true) {}

  bool reading() const { return reading_; }
  const std::vector<double>& numbers() const { return numbers_; }
  /// Throws MemoryMismatch unless all numbers have been read.
  void require_end() const {
    if (next_ != numbers_.size()) throw MemoryMismatch("it has more numbers than this run remembers");
  }

  template <class... Values>
  void operator()(Values&... values) {
    (one(values), ...);
  }

 private:
  void one(double& x) {
    if (!reading_) {
      numbers_.push_back(x);
      return;
    }
    if (next_ == numbers_.size()) throw MemoryMismatch("it has fewer numbers than this run remembers");
    x = numbers_[next_++];
  }
  template <std::integral Whole>
  void one(Whole& n) {
    double as_double = static_cast<double>(n);
    one(as_double);
    if (!(as_double >= -0x1p31 && as_double < 0x1p53)) throw MemoryMismatch("a count in it is out of range");
    n = static_cast<Whole>(as_double);
  }
  template <class Value>
  requires requires(Value& value, Memory& memory) { value.remember(memory); }
  void one(Value& value) { value.remember(*this); }
  template <class Value>
  void one(std::optional<Value>& value) {
    bool there = value.has_value();
    one(there);
    if (!there) value.reset();
    if (there && !value) value.emplace();
    if (there) one(*value);
  }
  template <class Value, std::size_t size>
  void one(std::array<Value, size>& values) {
    for (Value& value : values) one(value);
  }
  template <class Value>
  void one(std::vector<Value>& values) {
    values.resize(size_of(values.size()));
    for (Value& value : values) one(value);
  }
  template <class Value>
  void one(std::map<int, Value>& values) {
    std::size_t left = size_of(values.size());
    if (!reading_) {
      for (auto& [key, value] : values) {
        int copy = key;
        (*this)(copy, value);
      }
      return;
    }
    for (values.clear(); left > 0; --left) {
      int key = 0;
      one(key);
      one(values[key]);
    }
  }
  template <class Derived>
  void one(Eigen::PlainObjectBase<Derived>& matrix) {
    const auto rows = size_of(static_cast<std::size_t>(matrix.rows()));
    const auto columns = size_of(static_cast<std::size_t>(matrix.cols()));
    const auto fits = [](int fixed, int most, std::size_t n) {
      return (fixed == Eigen::Dynamic || static_cast<std::size_t>(fixed) == n) &&
             (most == Eigen::Dynamic || n <= static_cast<std::size_t>(most));
    };
    if (!fits(Derived::RowsAtCompileTime, Derived::MaxRowsAtCompileTime, rows) ||
        !fits(Derived::ColsAtCompileTime, Derived::MaxColsAtCompileTime, columns))
      throw MemoryMismatch("a matrix in it has another size");
    matrix.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
    for (Eigen::Index i = 0; i < matrix.size(); ++i) one(matrix.data()[i]);
  }

  /// A length; none can exceed what is left to read.
  std::size_t size_of(std::size_t length) {
    one(length);
    if (reading_ && length > numbers_.size()) throw MemoryMismatch("a length in it is out of range");
    return length;
  }

  std::vector<double> numbers_;
  std::size_t next_ = 0;
  bool reading_ = false;
};

}  // namespace osculate
