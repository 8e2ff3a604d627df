#include "identification/peers.h"

#include <gtest/gtest.h>

#include <string>

#include "signals.h"

namespace capsoc::identification {
namespace {

/// `turns` at constant speed, negative: backwards.
TestSignal turning(const Parameters& p, double turns, Eigen::Index count = 20000) {
  TestSignal signal{Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double theta = 2 * pi * turns * static_cast<double>(i) / static_cast<double>(count);
    signal.u[i] = p.a1 * std::sin(theta + 0.3) + p.b1;
    signal.v[i] = p.a2 * std::cos(theta + 0.3 + p.beta) + p.b2;
  }
  return signal;
}

/// What is left of a clean record of some turns. Fourier's line has no whole number of samples in
/// it, the two-step gradient has not settled, and the observer's error is exp(-x) (1 + x + x^2 / 2)
/// with x = 0.3 omega t: 2e-5 here.
double tolerance_of(Peer peer) {
  if (peer == Peer::fourier) return 1e-3;
  if (peer == Peer::two_step) return 2e-2;
  return peer == Peer::observer ? 5e-5 : 1e-8;
}

void expect_near(const Parameters& found, const Parameters& truth, double tolerance) {
  EXPECT_NEAR(found.a1, truth.a1, tolerance);
  EXPECT_NEAR(found.a2, truth.a2, tolerance);
  EXPECT_NEAR(found.b1, truth.b1, tolerance);
  EXPECT_NEAR(found.b2, truth.b2, tolerance);
  EXPECT_NEAR(found.beta, truth.beta, tolerance);
}

TEST(Peers, FindACleanSensorInEitherDirection) {
  for (const double turns : {8.4, -8.4}) {
    const TestSignal signal = turning(table_1, turns);
    for (const Peer peer : all_peers) {
      SCOPED_TRACE(std::string(to_string(peer)) + (turns < 0 ? ", backwards" : ""));
      const auto found = identify_by(peer, signal.u, signal.v);
      ASSERT_TRUE(found) << found.error();
      expect_near(found.value().parameters, table_1, tolerance_of(peer));
    }
  }
}

TEST(Peers, AreAsGoodForASmallSignal) {
  const Parameters small = {0.02, 0.03, 0.004, -0.002, 0.2};
  const TestSignal signal = turning(small, 8.4);
  for (const Peer peer : all_peers) {
    SCOPED_TRACE(to_string(peer));
    const auto found = identify_by(peer, signal.u, signal.v);
    ASSERT_TRUE(found) << found.error();
    expect_near(found.value().parameters, small, 0.1 * tolerance_of(peer));
  }
}

TEST(Peers, ThoseThatNeedOrderRefuseSamplesWithoutIt) {
  const TestSignal shuffled = make_signal(table_1, 20000, 1);
  const TestSignal short_record = turning(table_1, 2.5);
  for (const Peer peer : all_peers) {
    SCOPED_TRACE(to_string(peer));
    const auto found = identify_by(peer, shuffled.u, shuffled.v);
    EXPECT_EQ(static_cast<bool>(found), !needs_order(peer));
    if (!found) {
      EXPECT_NE(found.error().find("in order of time"), std::string::npos);
    }
    EXPECT_EQ(static_cast<bool>(identify_by(peer, short_record.u, short_record.v)),
              !needs_order(peer));
  }
}

TEST(Peers, TheSeedDrawsTheBatchesAndNothingElse) {
  const TestSignal noisy = make_signal(table_1, 20000, 1, 1e-3);
  for (const Peer peer : all_peers) {
    if (needs_order(peer)) continue;
    SCOPED_TRACE(to_string(peer));
    const auto one = identify_by(peer, noisy.u, noisy.v, 1),
               again = identify_by(peer, noisy.u, noisy.v, 1),
               other = identify_by(peer, noisy.u, noisy.v, 2);
    ASSERT_TRUE(one && again && other);
    EXPECT_EQ(one.value().parameters.a1, again.value().parameters.a1);
    EXPECT_EQ(one.value().parameters.a1 == other.value().parameters.a1, peer == Peer::recursive);
    expect_near(one.value().parameters, other.value().parameters, 2e-3);
  }
}

TEST(Peers, SamplesThatAreNoEllipseAreAnError) {
  const Eigen::ArrayXd line = Eigen::ArrayXd::LinSpaced(1000, -1, 1);
  for (const Peer peer : all_peers) EXPECT_FALSE(identify_by(peer, line, line)) << to_string(peer);
}

}  // namespace
}  // namespace capsoc::identification
