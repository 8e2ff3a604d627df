#include "identification/ellipse_fit.h"

#include <gtest/gtest.h>

#include "signals.h"

namespace capsoc::identification {
namespace {

constexpr uint64_t ellipse_seed = 21;

TEST(EllipseFit, IsExactOnCleanSamplesByAllThreeMethods) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(ellipse_seed));
  const TestSignal signal = make_signal(table_1, 10000, ellipse_seed);
  const Result<Parameters> fits[] = {fit_heydemann(signal.u, signal.v),
                                     fit_taubin(signal.u, signal.v),
                                     fit_direct(signal.u, signal.v)};
  const char* const names[] = {"Heydemann", "Taubin", "direct"};
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(fits[i]) << names[i] << ": " << fits[i].error();
    const double error = relative_error(fits[i].value(), table_1);
    std::printf("%-9s largest relative error %.1e\n", names[i], error);
    EXPECT_LT(error, 1e-11) << names[i];
  }
}

TEST(EllipseFit, OfTaubinIsTheLeastBiasedUnderNoise) {
  double heydemann = 0, taubin = 0, direct = 0;
  for (uint64_t run = 0; run < 10; ++run) {  // the mean of runs shows the bias, one run may not
    const TestSignal signal = make_signal(table_1, 10000, ellipse_seed + run, 0.01);
    heydemann += difference(fit_heydemann(signal.u, signal.v).value(), table_1) / 10;
    taubin += difference(fit_taubin(signal.u, signal.v).value(), table_1) / 10;
    direct += difference(fit_direct(signal.u, signal.v).value(), table_1) / 10;
  }
  std::printf("noise 0.01: Heydemann %.1e, Taubin %.1e, direct %.1e\n", heydemann, taubin, direct);
  EXPECT_LT(taubin, heydemann / 2);
  EXPECT_LT(taubin, direct / 2);
}

TEST(EllipseFit, IsExactOnThreeQuartersOfATurn) {
  const TestSignal signal = make_signal(table_1, 1000, ellipse_seed, 0, 0.75);
  EXPECT_LT(difference(fit_heydemann(signal.u, signal.v).value(), table_1), 1e-11);
  EXPECT_LT(difference(fit_taubin(signal.u, signal.v).value(), table_1), 1e-11);
  EXPECT_LT(difference(fit_direct(signal.u, signal.v).value(), table_1), 1e-11);
}

}  // namespace
}  // namespace capsoc::identification
