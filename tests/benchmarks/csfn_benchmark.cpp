// What the CSFN identifier costs on one core. An iteration is what it is in the NumPy and PyTorch
// programs of csfn_benchmark.py: gradient of the loss over one batch and Adam's update.
#include <benchmark/benchmark.h>

#include <cmath>

#include "base/random.h"
#include "identification/ellipse_fit.h"
#include "identification/fused_network.h"
#include "identification/identify.h"

namespace capsoc::identification {
namespace {

/// Table 1 of the CSFN paper at random angles, with normal-like noise.
Samples table_1(Eigen::Index count, double noise) {
  Random random(2018);
  Samples samples{Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double theta = 2 * 3.14159265358979323846 * random.uniform();
    samples.u[i] = 0.3428 * std::sin(theta) + 0.0485 + noise * (random.uniform() - 0.5);
    samples.v[i] = 0.2537 * std::cos(theta + 0.9032) - 0.0224 + noise * (random.uniform() - 0.5);
  }
  return samples;
}

AdamOptions endless(int64_t batch, int iterations) {
  AdamOptions options;
  options.batch = batch;
  options.iterations = iterations;
  options.convergence = 0;
  return options;
}

/// Gradient and update, batches in the order of the samples.
void iteration(benchmark::State& state, Width width) {
  if (!supported(width)) {
    state.SkipWithError("not on this processor");
    return;
  }
  const Eigen::Index batch = state.range(0);
  const Samples samples = table_1(10000, 1e-3);
  const FusedNetwork network(width);
  Nodes nodes = to_nodes(paper_start(samples.u, samples.v));
  const AdamOptions options;
  Adam adam(options);
  Eigen::Index at = 0;
  for (auto _ : state) {
    const auto gradient =
        network.gradient(nodes, samples.u.segment(at, batch), samples.v.segment(at, batch));
    adam.update(nodes, gradient.by_nodes, options.rate);
    at = at + 2 * batch <= 10000 ? at + batch : 0;
  }
  benchmark::DoNotOptimize(nodes);
  state.SetItemsProcessed(state.iterations() * batch);
}
BENCHMARK_CAPTURE(iteration, widest, widest())->Arg(100)->Arg(1000);
BENCHMARK_CAPTURE(iteration, SSE2, Width::sse2)->Arg(100)->Arg(1000);
BENCHMARK_CAPTURE(iteration, AVX2, Width::avx2)->Arg(100)->Arg(1000);

/// Whole trainings as train_adam() runs them, shuffling included; time per iteration.
void training(benchmark::State& state) {
  const Samples samples = table_1(10000, 1e-3);
  const AdamOptions options = endless(state.range(0), 2000);
  const Parameters start = paper_start(samples.u, samples.v);
  for (auto _ : state) {
    benchmark::DoNotOptimize(train_adam(samples.u, samples.v, start, options));
  }
  state.counters["iteration"] = benchmark::Counter(
      2000, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(training)->Arg(100)->Arg(1000)->Unit(benchmark::kMillisecond);

/// Everything: checks, training, companions, intervals, gates.
void identification(benchmark::State& state, Method method, double noise) {
  const Samples samples = table_1(state.range(0), noise);
  IdentifyOptions options;
  options.method = method;
  for (auto _ : state) benchmark::DoNotOptimize(identify(samples, options));
}
BENCHMARK_CAPTURE(identification, adam, Method::adam, 0)
    ->Arg(10000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(identification, adam_noise_1e3, Method::adam, 1e-3)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(identification, lm, Method::levenberg_marquardt, 0)
    ->Arg(10000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(identification, taubin, Method::taubin, 0)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond);

void taubin(benchmark::State& state) {
  const Samples samples = table_1(state.range(0), 1e-3);
  for (auto _ : state) benchmark::DoNotOptimize(fit_taubin(samples.u, samples.v));
}
BENCHMARK(taubin)->Arg(10000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace capsoc::identification

BENCHMARK_MAIN();
