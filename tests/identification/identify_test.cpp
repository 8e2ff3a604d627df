#include "identification/identify.h"

#include <gtest/gtest.h>

#include <limits>

#include "identification/distributions.h"
#include "identification/ellipse_fit.h"
#include "identification/uncertainty.h"
#include "signals.h"

namespace capsoc::identification {
namespace {

constexpr Method all_methods[] = {Method::distances, Method::adam,   Method::levenberg_marquardt,
                                  Method::heydemann, Method::taubin, Method::direct};

IdentifyOptions with(Method method) {
  IdentifyOptions options;
  options.method = method;
  return options;
}

Samples samples_of(const TestSignal& signal) {
  return {signal.u, signal.v};
}

/// 3.3 turns in order of time; beta as the sensor has it.
Samples sweep(const Parameters& p, Eigen::Index count, double origin = 0.3) {
  Samples samples{Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double theta = origin + 2 * pi * 3.3 * static_cast<double>(i) / count;
    samples.u[i] = p.a1 * std::sin(theta) + p.b1;
    samples.v[i] = p.a2 * std::cos(theta + p.beta) + p.b2;
  }
  return samples;
}

TEST(Identify, FindsTable1ToNineDigitsByEveryMethod) {
  const HarmonicSignal signal =
      make_harmonic_signal({table_1, {}, {}}, 10000, Angles::random, 0, 2018);
  Eigen::ArrayXd raw(10000);
  for (Eigen::Index i = 0; i < 10000; ++i) {
    raw[i] = uncalibrated_angle(signal.samples.u[i], signal.samples.v[i]);
  }
  const double before = peak_to_peak_error(raw, signal.theta) * 180 / pi;
  for (const Method method : all_methods) {
    const auto found = identify(signal.samples, with(method));
    ASSERT_TRUE(found) << found.error();
    const Identification& answer = found.value();
    const double after =
        peak_to_peak_error(answer.parameters, signal.clean_u, signal.clean_v, signal.theta) * 180 /
        pi * 3600;
    std::printf(
        "%-9s largest relative error %.1e, %.2f deg before, %.1e arc seconds after, %d "
        "iterations\n",
        to_string(method), relative_error(answer.parameters, table_1), before, after,
        answer.iterations);
    EXPECT_FALSE(answer.rejected()) << answer.rejection();
    EXPECT_EQ(answer.disagreement, "");
    EXPECT_LE(relative_error(answer.parameters, table_1), 1e-9);
    EXPECT_NEAR(before, 73.7, 0.5);
    EXPECT_LE(after, 1e-3);
  }
}

struct Count {
  int identified = 0, rejected = 0;
  double worst = 0;
};

/// Random amplitudes 0.02 .. 0.95, offsets up to 0.3, beta -1.2 .. 1.2, either handedness.
void try_random_sets(const IdentifyOptions& options, Count& count, int sets = 1000) {
  const uint64_t seed = 1000;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  Random random(seed);
  for (int set = 0; set < sets; ++set) {
    Parameters truth;
    truth.a1 = 0.02 + 0.93 * random.uniform();
    truth.a2 = 0.02 + 0.93 * random.uniform();
    truth.b1 = 0.6 * random.uniform() - 0.3;
    truth.b2 = 0.6 * random.uniform() - 0.3;
    truth.beta = 2.4 * random.uniform() - 1.2;
    const bool reversed = random.uniform() < 0.5;
    Parameters sensor = truth;
    if (reversed) sensor.beta = pi - truth.beta;
    const auto found = identify(sweep(sensor, 1000, 6 * random.uniform()), options);
    ASSERT_TRUE(found) << found.error();
    if (found.value().rejected()) {
      ++count.rejected;
      // A true reason: the training is not where the ellipse is.
      EXPECT_EQ(found.value().rejection().find("the training"), 0u) << found.value().rejection();
      const bool lost =
          found.value().iterations == 0 || difference(found.value().parameters, truth) > 1e-9;
      EXPECT_TRUE(lost) << "set " << set << " was right: " << found.value().rejection();
      continue;
    }
    ++count.identified;
    const double error = difference(found.value().parameters, truth);
    count.worst = std::max(count.worst, error);
    EXPECT_LE(error, 1e-9) << "set " << set << " beta " << truth.beta;
    EXPECT_EQ(found.value().handedness, reversed ? Handedness::reversed : Handedness::direct)
        << "set " << set;
  }
  std::printf("%s: %d identified, largest difference %.1e, %d rejected\n",
              to_string(options.method), count.identified, count.worst, count.rejected);
}

TEST(Identify, FindsAThousandRandomParameterSetsByLevenbergMarquardt) {
  Count count;
  try_random_sets(with(Method::levenberg_marquardt), count);
  EXPECT_EQ(count.identified, 1000);
}

TEST(Identify, FindsAThousandRandomParameterSetsByAdam) {
  Count count;
  try_random_sets(with(Method::adam), count);
  EXPECT_EQ(count.identified, 1000);
}

TEST(Identify, FindsRandomParameterSetsByAdamFromThePapersStartOrSaysWhyNot) {
  Count count;
  IdentifyOptions options = with(Method::adam);
  options.start = Start::paper;
  try_random_sets(options, count, 200);
  EXPECT_GT(count.identified, 100);
  EXPECT_EQ(count.identified + count.rejected, 200);
}

TEST(Identify, FindsAThousandRandomParameterSetsByTaubin) {
  Count count;
  try_random_sets(with(Method::taubin), count);
  EXPECT_EQ(count.identified, 1000);
}

TEST(Identify, ByLevenbergMarquardtWorksBeyondTheRangeOfThePapersStart) {
  for (const double beta : {-1.49, -1.4, -1.3, 1.3, 1.4, 1.49}) {
    Parameters truth = table_1;
    truth.beta = beta;
    const auto found = identify(sweep(truth, 2000), with(Method::levenberg_marquardt));
    EXPECT_FALSE(found.value().rejected()) << beta << ": " << found.value().rejection();
    EXPECT_LT(difference(found.value().parameters, truth), 1e-9) << beta;
  }
}

TEST(Identify, ReportsEveryReasonToStop) {
  const Samples samples = samples_of(make_signal(table_1, 2000, 3));
  IdentifyOptions options = with(Method::adam);
  options.start = Start::paper;
  EXPECT_EQ(identify(samples, options).value().stopped, StopReason::converged);
  options.adam.loss_target = 1e-10;
  EXPECT_EQ(identify(samples, options).value().stopped, StopReason::loss_reached);
  options.adam.loss_target = 0;
  options.adam.iterations = 30;
  const auto limited = identify(samples, options);
  EXPECT_EQ(limited.value().stopped, StopReason::iteration_limit);
  EXPECT_NE(limited.value().rejection().find("iteration limit"), std::string::npos);
  // Steps that are small while the undamped one is not: here because the limit is far too large.
  LevenbergMarquardtOptions loose;
  loose.convergence = 0.5;
  const auto stalled =
      train_levenberg_marquardt(samples.u, samples.v, paper_start(samples.u, samples.v), loose);
  EXPECT_EQ(stalled.value().stopped, StopReason::stalled);
  options = with(Method::levenberg_marquardt);
  EXPECT_EQ(identify(samples, options).value().stopped, StopReason::converged);
  options.levenberg_marquardt.loss_target = 1e-10;
  EXPECT_EQ(identify(samples, options).value().stopped, StopReason::loss_reached);
}

/// The name of the first gate that failed.
std::string failed(const Samples& samples, const IdentifyOptions& options = {}) {
  const auto found = identify(samples, options);
  EXPECT_TRUE(found) << found.error();
  for (const Gate& gate : found.value().gates) {
    if (gate.passed) continue;
    std::printf("%s: %s\n", gate.name.c_str(), gate.reason.c_str());
    EXPECT_FALSE(gate.reason.empty());
    return gate.name;
  }
  return "";
}

TEST(Gates, RefuseBadRecords) {
  EXPECT_EQ(failed({Eigen::ArrayXd(0), Eigen::ArrayXd(0)}), "samples");
  EXPECT_EQ(failed(samples_of(make_signal(table_1, 1, 1))), "samples");
  EXPECT_EQ(failed(samples_of(make_signal(table_1, 15, 1))), "samples");
  Samples samples = samples_of(make_signal(table_1, 1000, 1));
  EXPECT_EQ(failed(samples), "");
  Samples bad = samples;
  bad.u[500] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(failed(bad), "finite");
  bad.u[500] = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(failed(bad), "finite");
  EXPECT_EQ(failed({samples.u, 0.3 * samples.u}), "ellipse");
  EXPECT_EQ(failed({Eigen::ArrayXd::Constant(50, 0.1), Eigen::ArrayXd::Constant(50, 0.2)}),
            "ellipse");
  EXPECT_EQ(failed({samples.u.head(20), samples.v.head(19)}), "ellipse");
}

TEST(Gates, RefuseClippingWithAndWithoutAFullScale) {
  const Samples samples = samples_of(make_signal(table_1, 5000, 1));
  Samples clipped = {samples.u.min(table_1.b1 + 0.97 * table_1.a1), samples.v};
  EXPECT_EQ(failed(clipped), "clipping");
  clipped = {samples.u, samples.v.max(table_1.b2 - 0.9 * table_1.a2)};
  EXPECT_EQ(failed(clipped), "clipping");
  IdentifyOptions options;
  options.gates.full_scale = 0.39;
  EXPECT_EQ(failed(samples, options), "clipping");
  options.gates.full_scale = 1;
  EXPECT_EQ(failed(samples, options), "");
  // A converter's steps pile up a little at the peaks; that is no clipping. Nor are whole turns
  // whose samples repeat.
  for (const double steps : {64.0, 512.0, 2048.0}) {
    const Samples coarse = {(samples.u * steps).round() / steps,
                            (samples.v * steps).round() / steps};
    EXPECT_EQ(failed(coarse), "") << steps;
  }
  const Samples turn = sweep(table_1, 33);
  EXPECT_EQ(failed({turn.u.head(10).replicate(50, 1), turn.v.head(10).replicate(50, 1)}), "");
}

TEST(Gates, TellAFlatTopFromChanceWhenTheConverterIsKnown) {
  constexpr int records = 1000;
  int flat = 0, seen = 0, refused = 0;
  for (int seed = 1; seed <= records; ++seed) {
    IdentifyOptions options;
    options.step = std::ldexp(1.0, -9 - seed % 7);
    const auto rounded = [&](const Samples& samples) -> Samples {
      return {(samples.u / options.step).round() * options.step,
              (samples.v / options.step).round() * options.step};
    };
    const auto clipping = [&](const Samples& samples) {
      return !check_record(samples.u, samples.v, options.gates, options.step).back().passed;
    };
    Parameters p = {0.9, 0.6, 0.05, 0.02, 0.3};
    p.a1 -= 1e-3 * (seed % 7);
    const Samples samples = samples_of(make_signal(p, 600, seed, 1e-4));
    refused += clipping(rounded(samples)) ? 1 : 0;
    // Without what is known of converters eight samples and none a step below are a flat top.
    flat += check_record(rounded(samples).u, rounded(samples).v, {}).back().passed ? 0 : 1;
    const double level = p.b1 + 0.97 * p.a1;
    const Samples clipped = rounded({samples.u.min(level), samples.v});
    seen += clipping(clipped) || identify(clipped, options).value().rejected() ? 1 : 0;
  }
  std::printf("%d records: %d refused (%d by piles alone), %d of the clipped ones seen\n", records,
              refused, flat, seen);
  EXPECT_EQ(refused, 0);
  EXPECT_GT(flat, 0);
  EXPECT_EQ(seen, records);
}

TEST(Gates, RefuseWhatCoversTooLittleOfTheTurn) {
  EXPECT_EQ(failed(samples_of(make_signal(table_1, 2000, 1, 0, 0.75))), "");
  // No fixed part of the turn is needed: the bound decides.
  EXPECT_EQ(
      failed(samples_of(make_signal(table_1, 2000, 1, 0, 0.4)), with(Method::levenberg_marquardt)),
      "");
  EXPECT_NE(failed(samples_of(make_signal(table_1, 200, 1, 1e-3, 0.1))), "");
  IdentifyOptions options = with(Method::levenberg_marquardt);
  options.gates.gap = 60;
  EXPECT_EQ(failed(samples_of(make_signal(table_1, 2000, 1, 0, 0.75)), options), "gap");
  const auto quarter = identify(samples_of(make_signal(table_1, 20000, 1, 0, 0.75)));
  const Coverage coverage = coverage_of(make_signal(table_1, 20000, 1, 0, 0.75).u,
                                        make_signal(table_1, 20000, 1, 0, 0.75).v, table_1);
  EXPECT_NEAR(coverage.largest_gap, 90, 0.5);
  EXPECT_NEAR(coverage.part, 0.75, 0.005);
}

TEST(Gates, RefuseWhatIsNoEllipse) {
  Random random(6);
  Samples cloud{Eigen::ArrayXd(1000), Eigen::ArrayXd(1000)};
  for (Eigen::Index i = 0; i < 1000; ++i) {
    cloud.u[i] = random.uniform();
    cloud.v[i] = random.uniform();
  }
  EXPECT_NE(failed(cloud, with(Method::levenberg_marquardt)), "");
  EXPECT_NE(failed(cloud, with(Method::taubin)), "");
  EXPECT_NE(failed(cloud), "");
}

TEST(Identify, TellsHandednessOnlyFromTheOrderOfTime) {
  Parameters paper = {0.6093, 0.6224, 0.1277, 0.1807, 3.0796};
  const auto reversed = identify(sweep(paper, 5000), with(Method::levenberg_marquardt));
  EXPECT_EQ(reversed.value().handedness, Handedness::reversed);
  EXPECT_NEAR(reversed.value().parameters.beta, pi - 3.0796, 1e-12);
  paper.beta = pi - 3.0796;
  const auto direct = identify(sweep(paper, 5000), with(Method::levenberg_marquardt));
  EXPECT_EQ(direct.value().handedness, Handedness::direct);
  EXPECT_LT(difference(direct.value().parameters, reversed.value().parameters), 1e-12);
  const auto shuffled = identify(samples_of(make_signal(paper, 5000, 3)));
  EXPECT_EQ(shuffled.value().handedness, Handedness::unknown);
}

TEST(Identify, HasIntervalsThatAgreeWithABootstrapAndHoldTheTruth) {
  constexpr int resamples = 200;
  const TestSignal signal = make_signal(table_1, 1000, 17, 1e-3);
  const auto once = identify(samples_of(signal)).value();
  const double width = student_quantile(0.95, 995);
  const double errors[] = {once.intervals.a1, once.intervals.a2, once.intervals.b1,
                           once.intervals.b2, once.intervals.beta};
  Random random(18);
  Eigen::Array<double, resamples, 5> found;
  for (int run = 0; run < resamples; ++run) {
    TestSignal drawn{Eigen::ArrayXd(1000), Eigen::ArrayXd(1000)};
    for (Eigen::Index i = 0; i < 1000; ++i) {
      const Eigen::Index j = random.index(1000);
      drawn.u[i] = signal.u[j];
      drawn.v[i] = signal.v[j];
    }
    const DistanceFit fit = fit_distances(drawn.u, drawn.v, table_1);
    ASSERT_TRUE(fit.converged);
    const Parameters& p = fit.parameters;
    found.row(run) << p.a1, p.a2, p.b1, p.b2, p.beta;
  }
  for (int i = 0; i < 5; ++i) {
    const double spread = std::sqrt((found.col(i) - found.col(i).mean()).square().mean());
    std::printf("parameter %d: interval %.2e, bootstrap %.2e\n", i, errors[i], width * spread);
    EXPECT_NEAR(width * spread / errors[i], 1, 0.2);
  }
  int held = 0;
  constexpr int records = 200;
  for (int run = 0; run < records; ++run) {
    const Samples samples = samples_of(make_signal(table_1, 1000, 100 + run, 1e-3));
    const auto one = identify(samples).value();
    held += std::abs(one.parameters.beta - table_1.beta) < one.intervals.beta ? 1 : 0;
    held += std::abs(one.parameters.a1 - table_1.a1) < one.intervals.a1 ? 1 : 0;
  }
  std::printf("%.1f %% of 400 intervals of 95 %% hold the truth\n", 100.0 * held / (2 * records));
  EXPECT_GT(held, 0.9 * 2 * records);
  EXPECT_LT(held, 0.99 * 2 * records);
}

TEST(Distributions, AreTheTables) {
  EXPECT_NEAR(normal_quantile(0.95), 1.959963984540054, 1e-12);
  EXPECT_NEAR(normal_quantile(0.5), 0.674489750196082, 1e-12);
  EXPECT_NEAR(normal_quantile(0.9999), 3.890591886413, 1e-9);
  EXPECT_NEAR(student_quantile(0.95, 1), 12.7062047361747, 1e-8);
  EXPECT_NEAR(student_quantile(0.95, 15), 2.13144954555978, 1e-9);
  EXPECT_NEAR(student_quantile(0.99, 100), 2.62589052143, 1e-8);
  EXPECT_NEAR(f_quantile(0.05, 5, 15), 2.90129453628, 1e-8);
  EXPECT_NEAR(f_tail(2.90129453628, 5, 15), 0.05, 1e-9);
  EXPECT_EQ(f_tail(0, 5, 15), 1);
  EXPECT_NEAR(binomial_tail(2, 3, 0.5), 0.5, 1e-15);
  EXPECT_NEAR(binomial_tail(8, 10, 0.5), 56.0 / 1024, 1e-15);
  EXPECT_NEAR(binomial_tail(3, 3, 0.25), 1.0 / 64, 1e-15);
  EXPECT_EQ(binomial_tail(0, 3, 0.25), 1);
  EXPECT_EQ(binomial_tail(4, 3, 0.25), 0);
}

/// `disturbed` samples anywhere in the square of full scale.
Samples with_outliers(Eigen::Index count, Eigen::Index disturbed, uint64_t seed) {
  Samples samples = samples_of(make_signal(table_1, count, seed, 1e-3));
  Random random(seed + 1);
  for (Eigen::Index k = 0; k < disturbed; ++k) {
    const Eigen::Index i = k * (count / disturbed);
    samples.u[i] = 0.5 + 0.5 * random.uniform();  // outside, so that every one is seen
    samples.v[i] = 2 * random.uniform() - 1;
  }
  return samples;
}

TEST(Identify, LeavesOutliersOutAndNamesThem) {
  for (const Eigen::Index disturbed : {2, 25, 75}) {
    const auto found = identify(with_outliers(500, disturbed, 5)).value();
    ASSERT_FALSE(found.rejected()) << found.rejection();
    ASSERT_EQ(static_cast<Eigen::Index>(found.outliers.size()), disturbed);
    for (Eigen::Index k = 0; k < disturbed; ++k) {
      EXPECT_EQ(found.outliers[static_cast<std::size_t>(k)], k * (500 / disturbed));
    }
    EXPECT_LT(difference(found.parameters, table_1), 3e-3);
    EXPECT_GT(found.nearest_outlier, 5);
  }
  for (const Method method : all_methods) {
    const auto found = identify(with_outliers(500, 2, 5), with(method)).value();
    EXPECT_FALSE(found.rejected()) << to_string(method) << ": " << found.rejection();
    EXPECT_LT(difference(found.parameters, table_1), 3e-3) << to_string(method);
  }
  const auto many = identify(with_outliers(500, 150, 5)).value();
  EXPECT_NE(many.rejection().find("150 samples (30 % of them) lie off"), std::string::npos)
      << many.rejection();
  EXPECT_TRUE(identify(samples_of(make_signal(table_1, 500, 5, 1e-3))).value().outliers.empty());
}

TEST(Identify, TakesWhatThePapersStartCannot) {
  // 3 % noise, and few samples.
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Parameters p = {0.5, 0.6, 0.2, -0.1, 0.2};
    const auto found = identify(samples_of(make_signal(p, 200, seed, 0.015))).value();
    EXPECT_FALSE(found.rejected()) << found.rejection();
    EXPECT_LT(difference(found.parameters, p), 0.03);
  }
}

TEST(Identify, TakesTheBiasOfNoiseOff) {
  // 4.4 times the noise is the smaller half axis; the nearest ellipse is 0.03 too large.
  const Samples samples =
      make_harmonic_signal({table_1, {}, {}}, 20000, Angles::random, 0.03, 7).samples;
  const auto found = identify(samples).value();
  ASSERT_FALSE(found.rejected()) << found.rejection();
  EXPECT_NEAR(found.residuals.noise, 0.03, 5e-4);
  EXPECT_LT(std::abs(found.parameters.beta - table_1.beta), 2 * found.intervals.beta);
  EXPECT_LT(found.intervals.beta, 0.01);
  const auto network = identify(samples, with(Method::levenberg_marquardt)).value();
  EXPECT_GT(std::abs(network.parameters.beta - table_1.beta), 5 * found.intervals.beta);
  EXPECT_LT(std::abs(network.parameters.beta - table_1.beta), network.intervals.beta);
}

TEST(Identify, FindsUndeclaredHarmonicsAndWithdrawsItsBound) {
  for (const int order : {2, 3}) {
    SignalModel model;
    model.fundamental = table_1;
    model.u[static_cast<std::size_t>(order - 2)].cosine = 0.012;
    const Samples samples = make_harmonic_signal(model, 2000, Angles::random, 1e-3, 3).samples;
    const auto found = identify(samples).value();
    ASSERT_FALSE(found.rejected()) << found.rejection();
    EXPECT_FALSE(found.bound);
    EXPECT_NE(found.warning.find("use --harmonics"), std::string::npos) << found.warning;
    EXPECT_LT(std::abs(found.parameters.beta - table_1.beta), found.intervals.beta);
  }
  const Samples clean = samples_of(make_signal(table_1, 2000, 3, 1e-3));
  EXPECT_TRUE(identify(clean).value().bound);
  EXPECT_EQ(identify(clean).value().warning, "");
}

TEST(Identify, DoesNotClaimMoreThanItsArithmetic) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const auto found = identify(samples_of(make_signal(table_1, 1000, seed))).value();
    EXPECT_LE(std::abs(found.parameters.a1 - table_1.a1), found.intervals.a1);
    EXPECT_LE(std::abs(found.parameters.b1 - table_1.b1), found.intervals.b1);
    EXPECT_LE(std::abs(found.parameters.beta - table_1.beta), found.intervals.beta);
    EXPECT_LT(found.intervals.beta, 1e-13);
  }
  // The converter's step is a floor where its rounding leaves less.
  IdentifyOptions options;
  options.step = 0x1p-11;
  const auto found = identify(samples_of(make_signal(table_1, 1000, 1)), options).value();
  EXPECT_GT(found.intervals.a1, options.step / std::sqrt(12.0) / std::sqrt(1000.0));
}

TEST(Gates, SeeAFewClippedSamples) {
  Samples samples = sweep(table_1, 29);
  const double level = table_1.b1 + 0.9 * table_1.a1;
  ASSERT_GE((samples.u > level).count(), 3);
  samples.u = samples.u.min(level);
  EXPECT_EQ(failed(samples), "plateau");
  samples = sweep(table_1, 29);
  samples.v = samples.v.max(table_1.b2 - 0.85 * table_1.a2);
  EXPECT_EQ(failed(samples), "plateau");
  EXPECT_EQ(failed(sweep(table_1, 29)), "");
}

TEST(Identify, SaysWhyTheFitsDisagree) {
  const auto reason = [](const Samples& samples, IdentifyOptions options = {}) {
    const std::string text = identify(samples, options).value().disagreement;
    std::printf("%s\n", text.c_str());
    return text;
  };
  const auto contains = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(contains(
      reason(samples_of(make_signal(table_1, 10000, 3, 1e-2)), with(Method::levenberg_marquardt)),
      "noise of"));
  EXPECT_TRUE(contains(reason(samples_of(make_signal(table_1, 10000, 3, 1e-2, 0.75)),
                              with(Method::levenberg_marquardt)),
                       "partial arc"));
  SignalModel model;
  model.fundamental = table_1;
  model.u[1].sine = model.v[1].cosine = 0.05;
  const HarmonicSignal third = make_harmonic_signal(model, 10000, Angles::random, 0, 3);
  EXPECT_TRUE(contains(reason(third.samples, with(Method::levenberg_marquardt)), "harmonics"));
  const std::string stochastic =
      reason(samples_of(make_signal(table_1, 100000, 3, 1e-4)), with(Method::adam));
  EXPECT_TRUE(stochastic.empty() || contains(stochastic, "not settled")) << stochastic;
  IdentifyOptions few = with(Method::adam);
  few.start = Start::paper;
  few.adam.iterations = 100;
  EXPECT_TRUE(contains(reason(samples_of(make_signal(table_1, 1000, 3)), few), "not at its end"));
}

TEST(Identify, TakesTheHarmonicsIntoTheAnswer) {
  SignalModel model;
  model.fundamental = table_1;
  model.u[1].sine = model.v[1].cosine = 0.01;
  const HarmonicSignal signal = make_harmonic_signal(model, 4000, Angles::constant_speed, 0, 3);
  IdentifyOptions options = with(Method::adam);
  options.harmonics.highest = 3;
  const auto found = identify(signal.samples, options);
  EXPECT_TRUE(found.value().harmonics.identified);
  EXPECT_LT(difference(found.value().parameters, table_1), 1e-9);
  EXPECT_GT(difference(found.value().network_parameters, table_1), 1e-3);
}

TEST(Identify, RefusesOptionsOutOfRange) {
  const Samples samples = samples_of(make_signal(table_1, 100, 3));
  IdentifyOptions options;
  options.confidence = 1;
  EXPECT_FALSE(identify(samples, options));
  options = {};
  options.harmonics.highest = 4;
  EXPECT_FALSE(identify(samples, options));
  options = {};
  options.adam.batch = 0;
  EXPECT_FALSE(identify(samples, options));
}

TEST(Identify, TracesTheConvergenceAndRepeatsItsDigits) {
  const Samples samples = samples_of(make_signal(table_1, 10000, 3, 1e-3));
  IdentifyOptions options = with(Method::adam);
  options.trace = true;
  const auto one = identify(samples, options).value();
  const auto two = identify(samples, options).value();
  ASSERT_EQ(one.convergence.size(), 500u);
  EXPECT_EQ(one.convergence.back().iteration, 20000);
  EXPECT_LT(one.convergence.back().loss, one.convergence.front().loss);
  EXPECT_EQ(difference(one.parameters, two.parameters), 0);
  options.method = Method::levenberg_marquardt;
  EXPECT_GE(identify(samples, options).value().convergence.size(), 2u);
}

TEST(Identify, KnowsItsMethodsByName) {
  for (const Method method : all_methods) EXPECT_EQ(method_from(to_string(method)), method);
  EXPECT_FALSE(method_from("newton"));
}

}  // namespace
}  // namespace capsoc::identification
