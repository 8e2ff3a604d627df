#include "identification/samples.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "identification/ellipse_fit.h"
#include "identification/training.h"
#include "signals.h"

namespace capsoc::identification {
namespace {

/// Every identifier must refuse the samples with a sentence that contains `part`.
void expect_refused(const TestSignal& signal, const std::string& part) {
  const Channel u = signal.u;
  const Channel v = signal.v;
  const Parameters start = {1, 1, 0, 0, 0};
  const auto check = [&part](const auto& result) {
    ASSERT_FALSE(result) << "accepted, expected: " << part;
    EXPECT_NE(result.error().find(part), std::string::npos) << result.error();
  };
  check(fit_heydemann(u, v));
  check(fit_taubin(u, v));
  check(fit_direct(u, v));
  check(train_adam(u, v, start));
  check(train_levenberg_marquardt(u, v, start));
}

TEST(Samples, ThatAreTooFewAreRefused) {
  expect_refused({Eigen::ArrayXd(0), Eigen::ArrayXd(0)}, "too few");
  expect_refused(make_signal(table_1, 1, 1), "too few");
  expect_refused(make_signal(table_1, 4, 1), "too few");
}

TEST(Samples, OfDifferentLengthsAreRefused) {
  TestSignal signal = make_signal(table_1, 10, 1);
  signal.v.conservativeResize(9);
  expect_refused(signal, "10 and 9");
}

TEST(Samples, ThatAreNotFiniteAreRefusedWithTheirIndex) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    TestSignal signal = make_signal(table_1, 100, 1);
    signal.v[42] = bad;
    expect_refused(signal, "sample 42 is not a finite number");
  }
}

TEST(Samples, OfASinglePointAreRefused) {
  expect_refused({Eigen::ArrayXd::Constant(100, 0.3), Eigen::ArrayXd::Constant(100, -0.1)},
                 "single point");
  expect_refused({Eigen::ArrayXd::Zero(100), Eigen::ArrayXd::Zero(100)}, "single point");
}

TEST(Samples, OnAStraightLineAreRefused) {
  TestSignal signal = make_signal(table_1, 100, 1);
  expect_refused({signal.u, 0.3 * signal.u + 0.1}, "straight line");
  expect_refused({signal.u, -signal.u}, "straight line");
  expect_refused({signal.u, Eigen::ArrayXd::Constant(100, 0.2)}, "channel V is constant");
  expect_refused({Eigen::ArrayXd::Constant(100, 0.2), signal.v}, "channel U is constant");
}

TEST(Samples, OfFewerThanFiveDifferentPointsAreRefused) {
  const TestSignal four = make_signal(table_1, 4, 9);
  const TestSignal repeated{four.u.replicate(25, 1), four.v.replicate(25, 1)};
  expect_refused(repeated, "five different points");
}

TEST(Samples, OfFiveDifferentPointsAreEnough) {
  TestSignal signal{Eigen::ArrayXd(5), Eigen::ArrayXd(5)};
  for (int i = 0; i < 5; ++i) {
    signal.u[i] = table_1.a1 * std::sin(2 * pi * i / 5) + table_1.b1;
    signal.v[i] = table_1.a2 * std::cos(2 * pi * i / 5 + table_1.beta) + table_1.b2;
  }
  const auto fit = fit_taubin(signal.u, signal.v);
  ASSERT_TRUE(fit) << fit.error();
  EXPECT_LT(difference(fit.value(), table_1), 1e-12);
}

}  // namespace
}  // namespace capsoc::identification
