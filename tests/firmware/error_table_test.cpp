// The table of firmware/apps/harmonics, compiled for the host, against the error that it was learnt
// from, read off as the coprocessor's page says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

extern "C" {
#include "apps/harmonics/error_table.c"
}

namespace {

constexpr double turn = 6.283185307179586;

/// Of a turn, as an angle of the sensor's in turns has it.
double error_at(double angle) {
  return (0.3 + 1.1 * std::sin(turn * angle + 1) + 0.7 * std::cos(turn * 3 * angle) +
          0.2 * std::sin(turn * 10 * angle)) /
         360;
}

uint32_t word(double turns) {
  return static_cast<uint32_t>(static_cast<int64_t>(std::llround(turns * 0x1p32)));
}

/// Largest deviation of the table's lines from the error, degrees.
double deviation(const int32_t* nodes) {
  double worst = 0;
  for (int i = 0; i < 12800; ++i) {
    const double angle = i / 12800.0;
    const int left = i / 100;
    const double share = i % 100 / 100.0;
    const double line = nodes[left] * (1 - share) + nodes[(left + 1) % 128] * share;
    worst = std::max(worst, std::fabs(line * 0x1p-24 - error_at(angle)) * 360);
  }
  return worst;
}

error_table learnt(int samples, int turns) {
  error_table table{};
  for (int k = 0; k < samples * turns; ++k) {
    const double angle = static_cast<double>(k) / samples;
    error_table_add(&table, word(angle - std::floor(angle)),
                    static_cast<int32_t>(word(error_at(angle))));
  }
  return table;
}

TEST(ErrorTable, HasTheErrorThatItWasLearntFrom) {
  const error_table table = learnt(5000, 4);
  int32_t nodes[error_nodes];
  ASSERT_EQ(error_table_nodes(&table, nodes), nullptr);
  // A chord of order h is a (pi h / 128)^2 / 2 off at most, 0.0060 + 0.0019 + 0.0003 degrees; half
  // of that stands in the nodes. A node's mean is that of 39 places, not of all.
  EXPECT_LT(deviation(nodes), 0.0055);
  EXPECT_GT(deviation(nodes), 0.0020);
}

TEST(ErrorTable, KeepsTheErrorFreeOfOrdersAboveTheTenth) {
  error_table table{};
  for (int k = 0; k < 12800; ++k) {
    const double angle = k / 12800.0;
    error_table_add(&table, word(angle),
                    static_cast<int32_t>(word(std::sin(turn * 20 * angle) / 360)));
  }
  int32_t nodes[error_nodes];
  ASSERT_EQ(error_table_nodes(&table, nodes), nullptr);
  EXPECT_LT(*std::max_element(nodes, nodes + error_nodes) * 0x1p-24 * 360, 0.001);
}

TEST(ErrorTable, NeedsSamplesEverywhere) {
  error_table table = learnt(5000, 1);
  int32_t nodes[error_nodes];
  for (const int node : {17, 18, 19}) table.counts[node] = error_least_samples - 1;
  const char* reason = error_table_nodes(&table, nodes);
  ASSERT_NE(reason, nullptr);
  EXPECT_NE(std::string(reason).find("too few samples"), std::string::npos);
  table.counts[18] = error_least_samples;
  EXPECT_EQ(error_table_nodes(&table, nodes), nullptr);
}

TEST(ErrorTable, TwoNodesWithoutSamplesAreBetweenTheirNeighbours) {
  for (const int node : {0, 17, 126, 127}) {
    error_table table = learnt(5000, 4);
    for (const int missing : {node, (node + 1) % error_nodes}) {
      table.counts[missing] = 0;
      table.sums[missing] = INT64_C(1) << 40;  // none of it may be used
    }
    int32_t nodes[error_nodes];
    ASSERT_EQ(error_table_nodes(&table, nodes), nullptr) << node;
    EXPECT_LT(deviation(nodes), 0.03) << node;
  }
}

TEST(ErrorTable, RefusesWhatDoesNotFit) {
  error_table table{};
  for (uint32_t i = 0; i < 1280; ++i)
    error_table_add(&table, i * 3355443, i < 640 ? 1 << 28 : -(1 << 28));
  int32_t nodes[error_nodes];
  const char* const reason = error_table_nodes(&table, nodes);
  ASSERT_NE(reason, nullptr);
  EXPECT_NE(std::string(reason).find("larger than the table"), std::string::npos);
}

TEST(ErrorTable, TwoSpeedsTellInertiaFromTheSensor) {
  // A sensor's error, and a shaft's that is a quarter at twice the speed, or four times at half.
  for (const double ratio : {2.0, 0.5}) {
    int32_t first[error_nodes], second[error_nodes];
    double worst = 0;
    for (int j = 0; j < error_nodes; ++j) {
      const double sensor = 20000 * std::sin(turn * 2 * j / 128),
                   shaft = 9000 * std::cos(turn * j / 128);
      first[j] = static_cast<int32_t>(std::lround(sensor + shaft));
      second[j] = static_cast<int32_t>(std::lround(sensor + shaft / (ratio * ratio)));
    }
    ASSERT_EQ(error_table_without_inertia(first, second, ratio * ratio), nullptr);
    for (int j = 0; j < error_nodes; ++j)
      worst = std::max(worst, std::fabs(second[j] - 20000 * std::sin(turn * 2 * j / 128)));
    EXPECT_LT(worst, 2);
  }
  int32_t first[error_nodes] = {500000}, second[error_nodes] = {-500000};
  EXPECT_NE(error_table_without_inertia(first, second, 2), nullptr);
}

TEST(ErrorTable, ANodeTakesTheSamplesOnBothOfItsSides) {
  error_table table{};
  error_table_add(&table, 0xFFFFFFFF, -3);
  error_table_add(&table, 0, 5);
  error_table_add(&table, (1u << 24) - 1, 7);
  error_table_add(&table, 1u << 24, 11);
  EXPECT_EQ(table.counts[0], 3u);
  EXPECT_EQ(table.sums[0], 9);
  EXPECT_EQ(table.sums[1], 11);
}

}  // namespace
