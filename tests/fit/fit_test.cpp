#include "fit/fit.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <sstream>

#include "base/constants.h"
#include "fit/report.h"
#include "golden/golden.h"
#include "identification/calibration.h"
#include "metrics/begin_recording.h"
#include "metrics/sample_record.h"

namespace capsoc::fit {
namespace {

/// A file that lives as long as a test.
class Trace {
 public:
  explicit Trace(const std::string& text)
      : path_(testing::TempDir() + std::to_string(getpid()) + "fit_test.csv") {
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~Trace() { std::remove(path_.c_str()); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

std::string to_recording(const metrics::SampleRecord& samples) {
  const std::string path = testing::TempDir() + std::to_string(getpid()) + "fit_test_recording.csv";
  auto writer = metrics::begin_recording({path, "test", metrics::record_columns("", "").value()});
  for (const metrics::RecordedSample& sample : samples) writer.value()->add(sample);
  EXPECT_FALSE(writer.value()->finish());
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  std::remove(path.c_str());
  return text.str();
}

metrics::SampleRecord one_turn(const identification::Parameters& p, int count) {
  metrics::SampleRecord samples;
  for (int i = 0; i < count; ++i) {
    const double turns = static_cast<double>(i) / count, theta = 2 * pi * turns;
    const double u = p.a1 * std::sin(theta) + p.b1, v = p.a2 * std::cos(theta + p.beta) + p.b2;
    samples.push_back({i / 250.0, static_cast<int32_t>(std::lround(u * 0x1p31)),
                       static_cast<int32_t>(std::lround(v * 0x1p31)), turns, true});
  }
  return samples;
}

const identification::Parameters sensor{0.6, 0.5, 0.1, -0.1, 0.3};

TEST(Record, ARecordingComesBackAsTheSameWords) {
  const auto samples = one_turn(sensor, 1000);
  const Trace trace(to_recording(samples));
  const auto record = read_record(trace.path());
  ASSERT_TRUE(record) << record.error();
  ASSERT_EQ(record.value().samples.u.size(), 1000);
  for (Eigen::Index i = 0; i < 1000; ++i) {
    const auto& sample = samples[static_cast<std::size_t>(i)];
    EXPECT_EQ(record.value().samples.u[i] * 0x1p31, sample.u);
    EXPECT_EQ(record.value().samples.v[i] * 0x1p31, sample.v);
    EXPECT_NEAR(record.value().angle[i], 2 * pi * sample.angle_turns, 1e-14);
  }
  EXPECT_NEAR(*record.value().description.sample_rate_hz, 250, 1e-9);
}

TEST(Record, WithoutATruthThereIsNoAngleColumn) {
  auto samples = one_turn(sensor, 100);
  samples[50].has_truth = false;
  const Trace trace(to_recording(samples));
  const auto record = read_record(trace.path());
  ASSERT_TRUE(record) << record.error();
  EXPECT_EQ(record.value().angle.size(), 0);
}

TEST(Record, BadInputIsASentenceWithFileAndLine) {
  const auto refused = [](const std::string& text, const std::string& line,
                          const std::string& what) {
    const Trace trace(text);
    const auto record = read_record(trace.path());
    ASSERT_FALSE(record) << text;
    EXPECT_EQ(record.error().rfind(trace.path() + line, 0), 0u) << record.error();
    EXPECT_NE(record.error().find(what), std::string::npos) << record.error();
  };
  refused("", ": ", "empty");
  refused("u,v\n", ":1: ", "no row");
  refused("u,v\n0.1,0.2\nnan,0.1\n", ":3: ", "finite");
  refused("u,v\n0.1,0.2\n0.1,zero\n", ":3: ", "not a number");
}

TEST(Fit, SamplesOfNoEllipseAreRejectedAndNoError) {
  const auto rejected = [](const std::string& rows, const std::string& what) {
    const Trace trace("u,v\n" + rows);
    const auto fitted = fit(trace.path(), {});
    ASSERT_TRUE(fitted) << fitted.error();
    EXPECT_NE(fitted.value().rejection.find(what), std::string::npos) << fitted.value().rejection;
  };
  std::string line, point, four;
  for (int i = 0; i < 50; ++i) {
    line += std::to_string(0.01 * i) + "," + std::to_string(0.005 * i) + "\n";
    point += "0.1,0.2\n";
    four += "0.1,0.2\n0.3,0.1\n-0.2,0.3\n0.1,-0.3\n";
  }
  rejected("0.1,0.2\n", "too few");
  rejected(line, "straight line");
  rejected(point, "single point");
  rejected(four, "five different points");
}

TEST(Record, AnEndlessTraceGivesTheMainJobsLength) {
  RecordOptions options;
  const auto whole = read_record("traces/soc_eq21.toml", options);
  ASSERT_TRUE(whole) << whole.error();
  EXPECT_EQ(whole.value().samples.u.size(), 100'000);
  options.samples = 5000;
  options.adc_bits = 12;
  const auto part = read_record("traces/soc_eq21.toml", options);
  ASSERT_TRUE(part) << part.error();
  EXPECT_EQ(part.value().samples.u.size(), 5000);
  const double word = part.value().samples.u[17] * 2048;
  EXPECT_EQ(word, std::round(word));
}

TEST(Fit, TheCalibrationHasWordsValuesAndChecksums) {
  const Trace trace(to_recording(one_turn(sensor, 2000)));
  const auto fitted = fit(trace.path(), {});
  ASSERT_TRUE(fitted) << fitted.error();
  ASSERT_EQ(fitted.value().rejection, "");
  const auto j = to_json(fitted.value(), {}, "capsoc fit x");
  EXPECT_NEAR(j["parameters"]["a1"]["value"].get<double>(), sensor.a1, 1e-9);
  EXPECT_NEAR(j["parameters"]["beta"]["value"].get<double>(), sensor.beta, 1e-9);
  EXPECT_EQ(j["parameters"]["phi"]["word"], 0);
  EXPECT_EQ(j["inputs"][0]["sha256"].get<std::string>().size(), 64u);
  for (const char* key : {"seed", "method", "stop_reason", "gates", "residuals", "confidence"})
    EXPECT_TRUE(j.contains(key)) << key;
  const std::string header = to_header(fitted.value());
  EXPECT_NE(header.find("#define CALIBRATION_A1 (" + std::to_string(fitted.value().words.a1) + ")"),
            std::string::npos)
      << header;
  EXPECT_EQ(header.find(testing::TempDir()), std::string::npos) << "no path of this machine";
}

/// What the noise of one sample makes of its angle is what the angles of the samples show: by the
/// arctangent, not by the formula.
TEST(Fit, TheNoiseOfOneSampleIsStatedBesideTheBound) {
  const identification::Parameters p{0.6, 0.2, 0.1, -0.1, 0.9};
  auto samples = one_turn(p, 4000);
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0, 1e-3 * 0x1p31);
  double squares = 0;
  for (auto& sample : samples) {
    sample.u += static_cast<int32_t>(noise(generator));
    sample.v += static_cast<int32_t>(noise(generator));
    const double sine = (sample.u * 0x1p-31 - p.b1) / p.a1;
    const double cosine = ((sample.v * 0x1p-31 - p.b2) / p.a2 + std::sin(p.beta) * sine);
    const double error = std::atan2(sine, cosine / std::cos(p.beta)) - 2 * pi * sample.angle_turns;
    squares += std::pow(std::remainder(error, 2 * pi), 2);
  }
  const Trace trace(to_recording(samples));
  const auto fitted = fit(trace.path(), {});
  ASSERT_TRUE(fitted) << fitted.error();
  const double expected = std::sqrt(squares / 4000) * 180 / pi;
  const auto j = to_json(fitted.value(), {}, "capsoc fit x");
  EXPECT_NEAR(j["residuals"]["angle_deg"].get<double>(), expected, 0.05 * expected);
  EXPECT_NE(to_table(fitted.value()).find("not in it: what disturbs one sample (0.34 deg rms"),
            std::string::npos)
      << expected << "\n"
      << to_table(fitted.value());
}

TEST(Fit, AnArcIsJudgedByItsBound) {
  metrics::SampleRecord arc = one_turn(sensor, 1000);
  arc.resize(150);
  const Trace clean(to_recording(arc));
  const auto fitted = fit(clean.path(), {});
  ASSERT_TRUE(fitted) << fitted.error();
  ASSERT_EQ(fitted.value().rejection, "");
  const auto j = to_json(fitted.value(), {}, "capsoc fit x");
  EXPECT_NEAR(j["angle_bound_deg"]["arc_degrees"].get<double>(), 54, 2);
  EXPECT_LE(j["angle_bound_deg"]["arc"]["total"], j["angle_bound_deg"]["total"]);
  EXPECT_NE(to_table(fitted.value()).find("degrees that the samples cover"), std::string::npos);
  arc.resize(25);
  const Trace coarse(to_recording(arc));
  FitOptions options;
  options.record.adc_bits = 12;
  const auto rejected = fit(coarse.path(), options);
  ASSERT_TRUE(rejected) << rejected.error();
  EXPECT_NE(rejected.value().rejection, "");
}

TEST(Fit, AColumnThatIsNoAngleIsNamed) {
  const auto said = [](double factor) {
    std::string rows = "t,u,v,angle_deg\n";
    for (int i = 0; i < 500; ++i) {
      const double turns = 3.2 * i / 500, theta = 2 * pi * turns;
      const identification::Point at = identification::point_at({sensor, {}, {}}, theta);
      rows += std::to_string(i / 250.0) + "," + std::to_string(at.u) + "," + std::to_string(at.v) +
              "," + std::to_string(factor * 360 * (turns - std::floor(turns))) + "\n";
    }
    const Trace trace(rows);
    const auto fitted = fit(trace.path(), {});
    EXPECT_TRUE(fitted) << fitted.error();
    return fitted.value().angle_column;
  };
  EXPECT_EQ(said(1), "");
  EXPECT_NE(said(radians_per_degree).find("radians"), std::string::npos);
  EXPECT_NE(said(1 / 360.0).find("turns"), std::string::npos);
  // The recording's reader folds angles into one turn, so what counts beyond 360 is named as no
  // angle.
  EXPECT_NE(said(4096 / 360.0).find("does not turn with the signals"), std::string::npos);
}

TEST(Fit, AllMethodsAgreeOnCleanSamples) {
  const Trace trace(to_recording(one_turn(sensor, 2000)));
  FitOptions options;
  options.all_methods = true;
  const auto fitted = fit(trace.path(), options);
  ASSERT_TRUE(fitted) << fitted.error();
  // Those that need the motion (fourier, observer, two-step) ask for three turns in order.
  const std::vector<Attempt>& attempts = fitted.value().attempts;
  ASSERT_EQ(attempts.size(), 12u);
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    const Attempt& attempt = attempts[i];
    ASSERT_EQ(attempt.parameters.has_value(), i < 9) << attempt.method << attempt.error;
    EXPECT_EQ(attempt.error.empty(), i < 9) << attempt.method;
    if (!attempt.parameters) continue;
    EXPECT_LT(attempt.difference, 1e-8) << attempt.method;
    EXPECT_LT(*attempt.angle_error_deg, 1e-6) << attempt.method;
  }
}

TEST(Golden, EqualAnswersDifferByNothing) {
  const auto words =
      metrics::to_words({sensor.a1, sensor.a2, sensor.b1, sensor.b2, sensor.beta, 1.0});
  const golden::Golden golden = golden::compare(one_turn(sensor, 5000), *words, {});
  ASSERT_EQ(golden.rejection, "");
  ASSERT_EQ(golden.rows.size(), 5u);
  for (const golden::GoldenRow& row : golden.rows)
    EXPECT_LE(std::abs(row.difference), 1) << row.name;
  EXPECT_LT(*golden.angle_difference, 3);
}

TEST(Golden, ADifferenceIsCountedInUnitsOfTheLastPlace) {
  auto words = metrics::to_words({sensor.a1, sensor.a2, sensor.b1, sensor.b2, sensor.beta, 0});
  words->a2 += 1000;
  words->beta -= 500;
  const golden::Golden golden = golden::compare(one_turn(sensor, 5000), *words, {});
  EXPECT_NEAR(static_cast<double>(golden.rows[1].difference), 1000, 1);
  EXPECT_NEAR(static_cast<double>(golden.rows[4].difference), -500, 1);
}

TEST(Golden, AReversedAnswerIsTheSameSensor) {
  const auto words =
      metrics::to_words({sensor.a1, sensor.a2, sensor.b1, sensor.b2, pi - sensor.beta, 0});
  const golden::Golden golden = golden::compare(one_turn(sensor, 5000), *words, {});
  for (const golden::GoldenRow& row : golden.rows)
    EXPECT_LE(std::abs(row.difference), 1) << row.name;
}

TEST(Golden, TooFewSamplesHaveAReason) {
  const golden::Golden golden = golden::compare(one_turn(sensor, 4), {}, {});
  EXPECT_NE(golden.rejection, "");
  EXPECT_TRUE(to_json(golden).contains("rejection"));
  EXPECT_EQ(to_json(golden)["angle"]["verdict"], "not compared");
}

/// A turn in calibration mode by a coprocessor that knows the sensor; its angle is `wrong` radians
/// off.
metrics::SampleRecord calibrated_turn(const identification::Parameters& p, double wrong = 0) {
  const auto words = metrics::to_words({p.a1, p.a2, p.b1, p.b2, p.beta, 0});
  auto samples = one_turn(p, 5000);
  for (metrics::RecordedSample& sample : samples) {
    sample.result.emplace();
    sample.result->angle =
        static_cast<uint32_t>(std::llround((sample.angle_turns + wrong / two_pi) * q32));
    sample.result->words = *words;
    sample.result->angle_valid = true;
  }
  return samples;
}

golden::AngleCheck check_of(const metrics::SampleRecord& samples) {
  return golden::compare(samples, samples.back().result->words, {}).angle;
}

using Verdict = golden::AngleCheck::Verdict;

TEST(GoldenAngle, ARightAngleAgrees) {
  const golden::AngleCheck check = check_of(calibrated_turn(sensor));
  EXPECT_EQ(check.verdict, Verdict::agrees) << check.reason;
  EXPECT_EQ(check.samples, 5000u);
  EXPECT_FALSE(check.demodulating);
  EXPECT_LT(check.bound->total(), 1e-6);
  EXPECT_EQ(check.bound->wander, 0);
}

TEST(GoldenAngle, OneDegreeIsADisagreementThoughTheParametersAreRight) {
  const golden::AngleCheck check = check_of(calibrated_turn(sensor, pi / 180));
  EXPECT_EQ(check.verdict, Verdict::disagrees);
  EXPECT_NEAR(*check.difference, 1, 1e-5);
  EXPECT_NE(check.reason.find("1 deg"), std::string::npos) << check.reason;
}

TEST(GoldenAngle, HalfATurnIsNotForgiven) {
  EXPECT_EQ(check_of(calibrated_turn(sensor, pi)).verdict, Verdict::disagrees);
}

TEST(GoldenAngle, TheDirectionIsTheOneOfTheCoprocessorsBeta) {
  identification::Parameters reversed = sensor;
  reversed.beta = pi - sensor.beta;
  EXPECT_EQ(check_of(calibrated_turn(reversed)).verdict, Verdict::agrees);
  // Its angle is pi minus that of the direct one.
  auto samples = calibrated_turn(reversed);
  for (metrics::RecordedSample& sample : samples)
    sample.result->angle = 0x80000000u - sample.result->angle;
  EXPECT_EQ(check_of(samples).verdict, Verdict::disagrees);
}

TEST(GoldenAngle, WrongParametersHaveTheirOwnWrongAngle) {
  auto samples = calibrated_turn(sensor);
  identification::Parameters wrong = sensor;
  wrong.beta += 0.01;
  for (metrics::RecordedSample& sample : samples)
    sample.result->angle = static_cast<uint32_t>(std::llround(
        identification::angle_of(wrong, sample.u / q31, sample.v / q31) / two_pi * q32));
  const golden::AngleCheck check = check_of(samples);
  EXPECT_EQ(check.verdict, Verdict::disagrees);
  EXPECT_NEAR(*check.difference, 0.01 * 180 / pi, 0.02);
}

TEST(GoldenAngle, OnlyTheWordsOfTheEndAreJudged) {
  auto samples = calibrated_turn(sensor);
  for (std::size_t k = 0; k < 3000; ++k) {
    samples[k].result->angle += 0x10000000u;
    samples[k].result->words.phi = 7;
  }
  const golden::AngleCheck check = check_of(samples);
  EXPECT_EQ(check.verdict, Verdict::agrees) << check.reason;
  EXPECT_EQ(check.samples, 2000u);
}

TEST(GoldenAngle, WithoutAValidAngleThereIsNothingToCompare) {
  auto samples = calibrated_turn(sensor);
  for (metrics::RecordedSample& sample : samples) sample.result->angle_valid = false;
  const golden::AngleCheck check = check_of(samples);
  EXPECT_EQ(check.verdict, Verdict::not_compared);
  EXPECT_NE(check.reason.find("no angle"), std::string::npos) << check.reason;
}

TEST(GoldenAngle, ParametersThatWanderWidenTheBoundOfDemodulation) {
  auto samples = calibrated_turn(sensor);
  for (metrics::RecordedSample& sample : samples) sample.result->demodulating = true;
  for (std::size_t k = 0; k < samples.size(); k += 2)
    samples[k].result->words.beta += static_cast<uint32_t>(q32 / 3600);  // 0.1 deg
  golden::AngleCheck check = check_of(samples);
  EXPECT_EQ(check.verdict, Verdict::agrees) << check.reason;
  EXPECT_EQ(check.bound->wander, 0) << "nothing is learnt with steps of 0";
  const golden::GoldenSettings settings{false, 1e-3, 1e-3, 0};
  check = golden::compare(samples, samples.back().result->words, settings).angle;
  EXPECT_TRUE(check.demodulating);
  EXPECT_NEAR(check.bound->wander, 0.2, 0.02);
  for (std::size_t k = 0; k < samples.size(); k += 2)
    samples[k].result->words.beta += static_cast<uint32_t>(q32 / 36);  // and 10 deg
  check = golden::compare(samples, samples.back().result->words, settings).angle;
  EXPECT_EQ(check.verdict, Verdict::not_compared) << "a bound that vouches for nothing";
}

}  // namespace
}  // namespace capsoc::fit
