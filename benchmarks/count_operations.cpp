// Writes docs/operations.md: what the recursions and the dense reference cost, counted by running them.
//   count_operations PAGE
#include <fstream>
#include <iostream>

#include "benchmarks/operations.hpp"

using namespace osculate::operations;

namespace {

void write(std::ostream& out, const std::vector<std::string>& rows) {
  for (const std::string& row : rows) out << row << '\n';
}

/// From how many links on our forward dynamics needs fewer operations than the best published dense method.
int crossover() {
  const Law law = linear_law(series_of(whole_costs, osculate::JointType::revolute)[1].costs).value();
  const auto ours = [&](int n) {
    return sum(law.constant) - law.constant.negations + (sum(law.slope) - law.slope.negations) * n;
  };
  const auto published = [](int n) {
    const Published c = published_dense(n);
    return c.multiplications + c.additions;
  };
  int n = 1;
  while (published(n) <= static_cast<double>(ours(n))) ++n;
  return n;
}

void write_page(const Tables& t, std::ostream& out) {
  out << R"(# Counted operations

Made by `./dev operations`: every computation is run over `Counted` (`src/scalar/counted.hpp`), a double that counts
its arithmetic. A test counts again and compares with this page.

**What is counted.** Multiplications, additions (subtractions included), divisions and negations on scalars, as the
code executes them. Copies, comparisons and absolute values are free. No recursion takes a square root, and cosines
and sines are given. What a type knows to be zero is not multiplied: half of H(k), the shape of phi, the symmetry of P
and Omega. A zero that only turns up at run time (armature 0, a base at rest, an axis along z) is multiplied like any
other number, so a count depends on the number of links and the kinds of joints alone.

**The chains** have n identical links of generic shape, with armature. Every law in n below is exact for each n from
1 to )"
      << longest << R"(; for resolved acceleration, from 1 to 6.

## Recursions

Turning joints. Controller torque: forward kinematics, four sweeps, the 6 x 6 factor and one solve, and n additions of
torques given beforehand. Forward dynamics: forward kinematics, sweeps 1 and 2, acceleration sweep. With a dash:
the sampled forms with values of the sample before. They save sweeps, not operations.

| computation | multiplications | additions | divisions | negations | sweeps |
|---|---|---|---|---|---|
)";
  write(out, t.turning);
  out << R"(
Resolved acceleration controls the first n task rows; its n x n solve, O(n^3) with n <= 6, is not in the row. It needs
neither P nor Omega, and fails where the arm is singular.

Sliding joints cost the same, but for these:

| computation | multiplications | additions | divisions | negations | sweeps |
|---|---|---|---|---|---|
)";
  write(out, t.sliding);
  out << R"(
The products for joints with any number of axes (`src/spatial/joint.hpp`), which nothing but such joints should pay
for. n counts links:

| computation | multiplications | additions | divisions | negations | sweeps |
|---|---|---|---|---|---|
)";
  write(out, t.many_axes);
  out << R"(
## Dense reference

`src/reference/dense.hpp`, turning joints. It is an oracle written to be plain, not fast: dual numbers for Jdot qd,
one Jacobian for each centre of mass. So the last column does not say how the recursions compare with a good dense
method; see below. Eigen )"
      << EIGEN_WORLD_VERSION << '.' << EIGEN_MAJOR_VERSION << '.' << EIGEN_MINOR_VERSION <<
      R"(; its products multiply by a factor of 1, which is counted.

| computation | n | multiplications | additions | divisions | negations | all | recursion, all | ratio |
|---|---|---|---|---|---|---|---|---|
)";
  write(out, t.dense);
  out << R"(
The multiplications are a cubic in n exactly, from some n on. The order that shows at these lengths,
log2(cost(2n) / cost(n)) over all operations, is still lower:

| computation | leading term | exact from n = | order 6 to 12 | order 12 to 24 |
|---|---|---|---|---|
)";
  write(out, t.order);
  out << R"(
## Published counts

Multiplications and divisions | additions and subtractions, n turning joints; cosines and sines not counted. The rows
of Featherstone (2008) are for Denavit-Hartenberg frames, where a change of frame is two turns about coordinate axes
and each joint axis is a unit vector z. Ours takes any frames and any axis, and resolves everything in one frame.
Compare slopes and orders, not constants. We quote these from notes and manuals that cite them and have not seen the
printed tables.

| algorithm | computes | multiplications | additions | source |
|---|---|---|---|---|
| Newton-Euler | T | 150 n - 48 | 131 n - 48 | Hollerbach (1980), counting Luh, Walker & Paul (1980) |
| RNEA, best | T | 93 n - 108 | 81 n - 100 | Balafoutis & Patel (1991), algorithm 5.7, in Featherstone (2008), Table 10.1 |
| CRBA, best | M | 10 n^2 + 22 n - 32 | 6 n^2 + 37 n - 43 | Featherstone (2005), in Featherstone (2008), Table 10.1 |
| factor M and solve | qdd | n^3/6 + 3 n^2/2 - 2 n/3 | n^3/6 + n^2 - 7 n/6 | Featherstone (2008), Table 10.1 |
| ABA, best | qdd | 224 n - 259 | 205 n - 248 | McMillan et al. (1995), in Featherstone (2008), Table 10.1 |

Forward dynamics in that convention, multiplications + additions:

| algorithm | n = 6 | n = 12 | n = 24 |
|---|---|---|---|
)";
  write(out, t.forward_dynamics);
  out << "\nBy these counts our forward dynamics needs fewer operations than the best published dense method "
         "from n = "
      << crossover() << R"(
on, and more than the best published ABA at every n.

For Lambda and Omega themselves we have no published law to print. Lilly and Orin (1990) give an O(n) recursion for
Lambda, by its abstract the cheapest then known for n >= 6; Featherstone (2010) and Wensing, Featherstone and Orin (2012)
give detailed counts that we have not seen.

- Featherstone, "Efficient factorization of the joint-space inertia matrix for branched kinematic trees", Int. J.
  Robotics Research 24(6), 2005
- Featherstone, *Rigid Body Dynamics Algorithms* (2008), Table 10.1
- Featherstone, "Exploiting sparsity in operational-space dynamics", Int. J. Robotics Research 29(10), 2010
- Hollerbach, "A recursive Lagrangian formulation of manipulator dynamics ...", IEEE Trans. SMC 10(11), 1980
- Lilly & Orin, "Efficient O(N) computation of the operational space inertia matrix", ICRA 1990
- Luh, Walker & Paul, ASME J. Dyn. Sys. Meas. Control 102(2), 1980
- Wensing, Featherstone & Orin, "A reduced-order recursive algorithm for the computation of the operational-space
  inertia matrix", ICRA 2012
)";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: count_operations PAGE\n";
    return 2;
  }
  try {
    const Tables counted = tables();
    std::ofstream page(argv[1]);
    write_page(counted, page);
    page.flush();
    if (!page) throw std::runtime_error(std::string("cannot write ") + argv[1]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
