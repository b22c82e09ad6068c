// SUNDIALS' serial vector with operations for the 15 numbers of an arm. The library's own take 100 to 200
// instructions for so few, and a step of CVODE is little else than some eighty of them. Only
// simulation/integrator.cpp includes this.
#pragma once

#include <nvector/nvector_serial.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace osculate::small_vector {

// The memory is filled up with zeros to whole blocks, so that no loop has a rest; every operation here keeps
// them zero, and those of the library do not touch them. Lengths and norms are those of the vector.
constexpr std::ptrdiff_t block = 4;

inline N_VectorContent_Serial content(N_Vector v) { return static_cast<N_VectorContent_Serial>(v->content); }
inline double* data(N_Vector v) { return content(v)->data; }

using Block = double __attribute__((vector_size(block * sizeof(double)), may_alias));

inline const Block* blocks(N_Vector v) { return reinterpret_cast<const Block*>(data(v)); }
inline Block* blocks_of(N_Vector v) { return reinterpret_cast<Block*>(data(v)); }
inline std::ptrdiff_t block_count(N_Vector v) { return (content(v)->length + block - 1) / block; }

/// A new vector like v, all zeros.
inline N_Vector clone(N_Vector v) {
  const N_Vector copy = N_VCloneEmpty_Serial(v);
  if (!copy) return nullptr;
  const auto bytes = static_cast<std::size_t>(block_count(v)) * sizeof(Block);
  content(copy)->data = static_cast<double*>(std::aligned_alloc(sizeof(Block), bytes));
  content(copy)->own_data = SUNTRUE;  // N_VDestroy_Serial frees it
  if (!data(copy)) {
    N_VDestroy(copy);
    return nullptr;
  }
  std::memset(data(copy), 0, bytes);
  return copy;
}

/// z = a x + b y
inline void linear_sum(double a, N_Vector x, double b, N_Vector y, N_Vector z) {
  const Block *p = blocks(x), *q = blocks(y);
  Block* r = blocks_of(z);
  const auto n = block_count(x);
  if (a == 1 && b == 1)  // a predictor's Pascal triangle is nothing else
    for (std::ptrdiff_t i = 0; i < n; ++i) r[i] = p[i] + q[i];
  else
    for (std::ptrdiff_t i = 0; i < n; ++i) r[i] = a * p[i] + b * q[i];
}

/// z = c x
inline void scale(double c, N_Vector x, N_Vector z) {
  const Block* p = blocks(x);
  Block* r = blocks_of(z);
  const auto n = block_count(x);
  for (std::ptrdiff_t i = 0; i < n; ++i) r[i] = c * p[i];
}

inline double dot(N_Vector x, N_Vector y) {
  const Block *p = blocks(x), *q = blocks(y);
  const auto n = block_count(x);
  Block sum{};
  for (std::ptrdiff_t i = 0; i < n; ++i) sum += p[i] * q[i];
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

inline double wrms_norm(N_Vector x, N_Vector w) {
  const Block *p = blocks(x), *q = blocks(w);
  const auto n = block_count(x);
  Block sum{};
  for (std::ptrdiff_t i = 0; i < n; ++i) sum += (p[i] * q[i]) * (p[i] * q[i]);
  const double total = (sum[0] + sum[2]) + (sum[1] + sum[3]);
  return std::sqrt(total / static_cast<double>(content(x)->length));
}

/// z = the sum of c[i] x[i]; z may be x[0]
inline int linear_combination(int count, double* c, N_Vector* x, N_Vector z) {
  Block* r = blocks_of(z);
  const auto n = block_count(z);
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    Block sum = c[0] * blocks(x[0])[i];
    for (int k = 1; k < count; ++k) sum += c[k] * blocks(x[k])[i];
    r[i] = sum;
  }
  return 0;
}

/// z[i] = a[i] x + y[i]; z[i] may be y[i]
inline int scale_add_multi(int count, double* a, N_Vector x, N_Vector* y, N_Vector* z) {
  const Block* p = blocks(x);
  const auto n = block_count(x);
  for (int k = 0; k < count; ++k) {
    const Block* q = blocks(y[k]);
    Block* r = blocks_of(z[k]);
    for (std::ptrdiff_t i = 0; i < n; ++i) r[i] = a[k] * p[i] + q[i];
  }
  return 0;
}

/// z[i] = c[i] x[i]
inline int scale_vectors(int count, double* c, N_Vector* x, N_Vector* z) {
  for (int k = 0; k < count; ++k) scale(c[k], x[k], z[k]);
  return 0;
}

/// A new vector of `length` zeros; those cloned from it have these operations too.
inline N_Vector create(std::ptrdiff_t length, SUNContext context) {
  const N_Vector empty = N_VNewEmpty_Serial(length, context);
  if (!empty) return nullptr;
  N_VEnableFusedOps_Serial(empty, SUNTRUE);
  N_Vector_Ops ops = empty->ops;
  ops->nvclone = clone;
  ops->nvlinearsum = linear_sum;
  ops->nvscale = scale;
  ops->nvdotprod = dot;
  ops->nvwrmsnorm = wrms_norm;
  ops->nvlinearcombination = linear_combination;
  ops->nvscaleaddmulti = scale_add_multi;
  ops->nvscalevectorarray = scale_vectors;
  const N_Vector v = clone(empty);
  N_VDestroy(empty);
  return v;
}

}  // namespace osculate::small_vector
