// Ensembles: states a second of one core, by packets and by the scalar sweeps, on the same arm and states.
// The two are compared before they are timed. `min` is the line to read on a machine with other work.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "model/random_arm.hpp"
#include "recursion/ensemble.hpp"

using namespace osculate;

namespace {

constexpr int state_count = 64;

struct States {
  Chain<double> chain;
  MatrixX<double> q, qd, u, T;
};
/// n turning joints, random links, states anywhere.
States random_states(int n) {
  States out;
  out.chain =
      random_arm_of(7, std::vector<JointType>(static_cast<std::size_t>(n), JointType::revolute)).chain;
  Random random(static_cast<std::uint64_t>(n));
  const auto filled = [&](int columns, double range) {
    MatrixX<double> x(state_count, columns);
    for (double& entry : x.reshaped()) entry = random.uniform(-range, range);
    return x;
  };
  out.q = filled(n, 3), out.qd = filled(n, 1), out.u = filled(6, 1), out.T = filled(n, 10);
  return out;
}

/// What BasicEnsemble does, by the scalar sweeps. Rows of states are copied out beforehand.
class Scalar {
 public:
  explicit Scalar(const States& states)
      : space_(states.chain), plant_(states.chain), numbers_(states.chain.links.size()) {
    for (int i = 0; i < state_count; ++i) {
      const auto row = [i](const MatrixX<double>& x) {
        std::vector<double> out;
        for (Eigen::Index j = 0; j < x.cols(); ++j) out.push_back(x(i, j));
        return out;
      };
      rows_.push_back({row(states.q), row(states.qd), row(states.u), row(states.T)});
    }
  }
  void evaluate(int i) {
    const Row& state = rows_[static_cast<std::size_t>(i)];
    space_.place(state.q);
    space_.sweep(state.qd);
    const TaskFactor<double> factor(space_.Omega(), all_);
    TaskVector<double> right = restricted(space_.right_side(), all_);
    c = factor.solve(right);
    g = factor.solve(restricted(space_.right_side_of_g(), all_));
    for (std::size_t j = 0; j < 6; ++j) c[j] -= g[j], right[j] += state.u[j];
    F = factor.solve(right);
    space_.torques(wrench(F, all_), numbers_);
  }
  void accelerations(int i) {
    const Row& state = rows_[static_cast<std::size_t>(i)];
    plant_.place(state.q);
    plant_.accelerations(state.qd, state.T, {}, numbers_);
  }
  /// T or qdd of the last call.
  const std::vector<double>& numbers() const { return numbers_; }
  TaskVector<double> c, g, F;

 private:
  struct Row {
    std::vector<double> q, qd, u, T;
  };
  OperationalSpace<double> space_;
  ForwardDynamics<double> plant_;
  std::vector<double> numbers_;
  std::vector<Row> rows_;
  TaskRows all_ = all_rows();
};

void evaluate_scalar(benchmark::State& run) {
  const States states = random_states(static_cast<int>(run.range(0)));
  Scalar scalar(states);
  for (auto _ : run)
    for (int i = 0; i < state_count; ++i) {
      scalar.evaluate(i);
      benchmark::DoNotOptimize(scalar.numbers().data());
    }
  run.SetItemsProcessed(run.iterations() * state_count);
}
void accelerate_scalar(benchmark::State& run) {
  const States states = random_states(static_cast<int>(run.range(0)));
  Scalar scalar(states);
  for (auto _ : run)
    for (int i = 0; i < state_count; ++i) {
      scalar.accelerations(i);
      benchmark::DoNotOptimize(scalar.numbers().data());
    }
  run.SetItemsProcessed(run.iterations() * state_count);
}
template <int N>
void evaluate_packets(benchmark::State& run) {
  const States states = random_states(static_cast<int>(run.range(0)));
  Ensemble<N> ensemble(states.chain);
  EnsembleTerms terms;
  for (auto _ : run) {
    ensemble.evaluate(states.q, states.qd, states.u, terms);
    benchmark::DoNotOptimize(terms.T.data());
  }
  run.SetItemsProcessed(run.iterations() * state_count);
}
template <int N>
void accelerate_packets(benchmark::State& run) {
  const States states = random_states(static_cast<int>(run.range(0)));
  Ensemble<N> ensemble(states.chain);
  MatrixX<double> qdd;
  for (auto _ : run) {
    ensemble.accelerations(states.q, states.qd, states.T, qdd);
    benchmark::DoNotOptimize(qdd.data());
  }
  run.SetItemsProcessed(run.iterations() * state_count);
}
void slopes(benchmark::State& run) {
  const States states = random_states(static_cast<int>(run.range(0)));
  Ensemble<> ensemble(states.chain);
  for (auto _ : run) {
    PlantSlopes found = plant_slopes(ensemble, VectorX<double>(states.q.row(0)),
                                     VectorX<double>(states.qd.row(0)), VectorX<double>(states.T.row(0)));
    benchmark::DoNotOptimize(found.q.data());
  }
  run.SetItemsProcessed(run.iterations() * 6 * run.range(0));
}

/// Largest difference of T and qdd from the scalar sweeps, against the largest of each state.
double disagreement(int n) {
  const States states = random_states(n);
  Ensemble<> ensemble(states.chain);
  EnsembleTerms terms;
  MatrixX<double> qdd;
  ensemble.evaluate(states.q, states.qd, states.u, terms);
  ensemble.accelerations(states.q, states.qd, states.T, qdd);
  Scalar scalar(states);
  double worst = 0;
  const auto compare = [&](const MatrixX<double>& found, int i) {
    double difference = 0, size = 0;
    for (int j = 0; j < n; ++j) {
      const double x = scalar.numbers()[static_cast<std::size_t>(j)];
      difference = std::max(difference, std::abs(found(i, j) - x)), size = std::max(size, std::abs(x));
    }
    worst = std::max(worst, difference / size);
  };
  for (int i = 0; i < state_count; ++i) {
    scalar.evaluate(i), compare(terms.T, i);
    scalar.accelerations(i), compare(qdd, i);
  }
  return worst;
}

void settings(benchmark::internal::Benchmark* b) {
  b->Arg(7)->Arg(100)->Repetitions(20)->ReportAggregatesOnly()->MinTime(0.02)->ComputeStatistics(
      "min", [](const std::vector<double>& x) { return *std::min_element(x.begin(), x.end()); });
}
BENCHMARK(evaluate_scalar)->Apply(settings);
BENCHMARK_TEMPLATE(evaluate_packets, native_lanes)->Apply(settings);
BENCHMARK(accelerate_scalar)->Apply(settings);
BENCHMARK_TEMPLATE(accelerate_packets, native_lanes)->Apply(settings);
BENCHMARK(slopes)->Apply(settings);

}  // namespace

int main(int argc, char** argv) {
  for (int n : {7, 100}) {
    const double difference = disagreement(n);
    std::printf("n = %d, %d lanes: T and qdd within %.1e of the scalar sweeps\n", n, native_lanes,
                difference);
    if (!(difference < 1e-8)) return 1;  // condition numbers up to 1e6 here
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
