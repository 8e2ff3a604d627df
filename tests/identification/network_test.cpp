#include "identification/network.h"

#include <gtest/gtest.h>

#include "signals.h"

namespace capsoc::identification {
namespace {

const char* const node_names[] = {"a1", "a2", "b1", "b2", "t"};

TEST(Network, YieldsOneEverywhereOnTheEllipseOfItsParameters) {
  const TestSignal signal = make_signal(table_1, 1000, 7);
  Network network(1000);
  network.set_nodes(to_nodes(table_1));
  network.forward(signal.u, signal.v);
  // Y is rounded in a dozen operations whose values stay below 4.
  EXPECT_LT(network.residuals().abs().maxCoeff(), 1e-14);
}

TEST(Network, AgreesWithFiniteDifferencesInEveryParameter) {
  const uint64_t seed = 11;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  const TestSignal signal = make_signal(table_1, 100, seed);
  Network network(100);
  for (const double t : {-0.5, 0.0, 0.4}) {
    Nodes nodes;
    nodes << 0.4, 0.3, 0.03, 0.02, t;
    network.set_nodes(nodes);
    network.forward(signal.u, signal.v);
    const Nodes gradient = network.backward();
    for (int i = 0; i < 5; ++i) {
      // Fourth-order central differences: h^4 and 1e-16/h are both near 1e-12 at h = 1e-3 ... 1e-4.
      const double h = 2e-4;
      const auto loss = [&](double by) {
        Nodes moved = nodes;
        moved[i] += by;
        network.set_nodes(moved);
        return network.forward(signal.u, signal.v);
      };
      const double numeric = (8 * (loss(h) - loss(-h)) - (loss(2 * h) - loss(-2 * h))) / (12 * h);
      const double relative = std::abs(gradient[i] / numeric - 1);
      std::printf("t %4.1f d/d%s %+.12f relative difference %.1e\n", t, node_names[i], gradient[i],
                  relative);
      EXPECT_LT(relative, 1e-7) << node_names[i];
    }
  }
}

TEST(Network, HasAJacobianWhoseProductWithTheResidualsIsTheGradient) {
  const TestSignal signal = make_signal(table_1, 50, 3);
  Network network(64);
  Nodes nodes;
  nodes << 0.4, 0.3, 0.03, 0.02, 0.1;
  network.set_nodes(nodes);
  network.forward(signal.u, signal.v);
  const Nodes gradient = network.backward();
  const Nodes product = network.jacobian().transpose() * network.residuals().matrix() * (-2.0 / 50);
  EXPECT_LT((gradient - product).norm(), 1e-14 * gradient.norm());
}

TEST(Network, StaysFiniteInTheCentreOfTheEllipse) {
  const Eigen::ArrayXd zero = Eigen::ArrayXd::Zero(4);
  Network network(4);
  network.set_nodes(to_nodes({1, 1, 0, 0, 0.3}));
  EXPECT_DOUBLE_EQ(network.forward(zero, zero), 1);
  EXPECT_TRUE(network.backward().allFinite());
}

TEST(Network, GivesEquivalentNodesTheSameCanonicalParameters) {
  Nodes nodes = to_nodes(table_1);
  EXPECT_LT(difference(to_parameters(nodes), table_1), 1e-15);
  nodes[4] = 1 / nodes[4];
  EXPECT_LT(difference(to_parameters(nodes), table_1), 1e-15);
  nodes[0] = -nodes[0];
  nodes[4] = -nodes[4];
  EXPECT_LT(difference(to_parameters(nodes), table_1), 1e-15);
  // And the network agrees that they are equivalent.
  const TestSignal signal = make_signal(table_1, 100, 5);
  Network network(100);
  network.set_nodes(nodes);
  EXPECT_LT(network.forward(signal.u, signal.v), 1e-28);
}

}  // namespace
}  // namespace capsoc::identification
