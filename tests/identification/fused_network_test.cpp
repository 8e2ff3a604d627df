#include "identification/fused_network.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "identification/training.h"
#include "signals.h"

namespace {

long allocations = 0;

}  // namespace

// Counts what Eigen and the library allocate; the address sanitizer brings its own.
#ifndef __SANITIZE_ADDRESS__
extern "C" {
void* __libc_malloc(std::size_t size);
void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
}
#endif

namespace capsoc::identification {
namespace {

constexpr Width all_widths[] = {Width::portable, Width::sse2, Width::avx2, Width::avx512};

Nodes nodes_of(double a1, double a2, double b1, double b2, double t) {
  Nodes nodes;
  nodes << a1, a2, b1, b2, t;
  return nodes;
}

TEST(FusedNetwork, AgreesWithTheLayeredOneInLossAndGradient) {
  double worst = 0;
  for (const Eigen::Index count : {1, 5, 8, 99, 1000}) {
    const TestSignal signal = make_signal(table_1, count, 7, 1e-2);
    Network layered(count);
    for (const double t : {-0.6, 0.0, 0.3, 0.7}) {
      const Nodes nodes = nodes_of(0.4, 0.3, 0.03, 0.02, t);
      layered.set_nodes(nodes);
      const double loss = layered.forward(signal.u, signal.v);
      const Nodes gradient = layered.backward();
      const auto fused = FusedNetwork().gradient(nodes, signal.u, signal.v);
      worst = std::max(worst, std::abs(fused.loss / loss - 1));
      worst = std::max(worst, (fused.by_nodes - gradient).norm() / gradient.norm());
    }
  }
  std::printf("largest relative difference between the fused and the layered form %.1e\n", worst);
  EXPECT_LT(worst, 1e-13);
}

TEST(FusedNetwork, AgreesWithTheLayeredOneInTheNormalEquations) {
  const TestSignal signal = make_signal(table_1, 101, 9, 1e-2);
  const Nodes nodes = nodes_of(0.4, 0.3, 0.03, 0.02, 0.5);
  Network layered(101);
  layered.set_nodes(nodes);
  const double loss = layered.forward(signal.u, signal.v);
  const Eigen::Matrix<double, 5, 5> jtj = layered.jacobian().transpose() * layered.jacobian();
  const Nodes jtr = layered.jacobian().transpose() * layered.residuals().matrix();
  const auto normal = FusedNetwork().normal(nodes, signal.u, signal.v);
  EXPECT_NEAR(normal.loss, loss, 1e-15);
  EXPECT_LT((normal.jtj - jtj).norm(), 1e-13 * jtj.norm());
  EXPECT_LT((normal.jtr - jtr).norm(), 1e-13 * jtr.norm());
}

TEST(FusedNetwork, GivesTheSameDigitsAtEveryWidth) {
  Random random(3);
  int widths = 0;
  for (const Width width : all_widths) {
    std::printf("%s: %s\n", to_string(width),
                supported(width) ? "tested" : "not on this processor");
    widths += supported(width) ? 1 : 0;
  }
  for (int run = 0; run < 300; ++run) {
    const TestSignal signal = make_signal(table_1, 1 + random.index(300), random.word(), 1e-2);
    const Nodes nodes =
        nodes_of(0.1 + random.uniform(), 0.1 + random.uniform(), random.uniform() - 0.5,
                 random.uniform() - 0.5, 1.8 * random.uniform() - 0.9);
    const FusedNetwork narrow(Width::portable);
    const auto gradient = narrow.gradient(nodes, signal.u, signal.v);
    const auto normal = narrow.normal(nodes, signal.u, signal.v);
    for (const Width width : all_widths) {
      if (!supported(width)) continue;
      const FusedNetwork wide(width);
      const auto other = wide.gradient(nodes, signal.u, signal.v);
      ASSERT_EQ(gradient.loss, other.loss) << to_string(width);
      ASSERT_EQ(gradient.by_nodes, other.by_nodes) << to_string(width);
      ASSERT_EQ(normal.jtj, wide.normal(nodes, signal.u, signal.v).jtj) << to_string(width);
    }
  }
  EXPECT_GE(widths, 1);
}

TEST(FusedNetwork, SumsTheMomentsAndBoundsAlikeAtEveryWidth) {
  for (const Eigen::Index count : {5, 8, 17, 1000}) {
    const TestSignal signal = make_signal(table_1, count, 4);
    const Kernels& narrow = kernels(Width::portable);
    const Extent extent = narrow.extent(signal.u.data(), signal.v.data(), count);
    const MomentSums sums = narrow.moments(signal.u.data(), signal.v.data(), count, 0.1, 0.2, 3, 4);
    EXPECT_EQ(extent.least_u, signal.u.minCoeff());
    EXPECT_EQ(extent.largest_v, signal.v.maxCoeff());
    EXPECT_NEAR(sums.xxyy, (((signal.u - 0.1) * 3) * ((signal.v - 0.2) * 4)).square().sum(),
                1e-12 * sums.xxyy);
    for (const Width width : all_widths) {
      if (!supported(width)) continue;
      const Extent other = kernels(width).extent(signal.u.data(), signal.v.data(), count);
      const MomentSums same =
          kernels(width).moments(signal.u.data(), signal.v.data(), count, 0.1, 0.2, 3, 4);
      EXPECT_EQ(extent.sum_u, other.sum_u);
      EXPECT_EQ(extent.sum_v, other.sum_v);
      EXPECT_EQ(sums.xxxx, same.xxxx);
      EXPECT_EQ(sums.xyyy, same.xyyy);
    }
  }
}

TEST(FusedNetwork, StaysFiniteInTheCentreOfTheEllipse) {
  const Eigen::ArrayXd zero = Eigen::ArrayXd::Zero(4);
  const auto gradient = FusedNetwork().gradient(to_nodes({1, 1, 0, 0, 0.3}), zero, zero);
  EXPECT_DOUBLE_EQ(gradient.loss, 1);
  EXPECT_TRUE(gradient.by_nodes.allFinite());
}

TEST(FusedNetwork, AllocatesNothingInTheLoop) {
  const TestSignal signal = make_signal(table_1, 10000, 5, 1e-3);
  const Parameters start = paper_start(signal.u, signal.v);
  const auto spent = [&](int iterations) {
    AdamOptions options;
    options.iterations = iterations;
    options.convergence = 0;
    const long before = allocations;
    const auto training = train_adam(signal.u, signal.v, start, options);
    EXPECT_TRUE(training);
    return allocations - before;
  };
  EXPECT_EQ(spent(10), spent(1000));
}

}  // namespace
}  // namespace capsoc::identification
