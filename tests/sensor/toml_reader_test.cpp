#include "sensor/toml_reader.h"

#include <gtest/gtest.h>

namespace capsoc::sensor {
namespace {

// Line numbers: name 1, sampling 2-5, signal 6-12, motion 13-15.
const std::string minimal = R"(name = "x"
[sampling]
rate_hz = 500
samples = 10
adc_bits = 16
[signal]
a1 = 0.5
a2 = 0.6
b1 = 0.1
b2 = -0.1
beta_rad = 0.06
phi_rad = 0.08
[motion]
kind = "constant"
frequency_hz = -2
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  return text.replace(place, from.size(), to);
}

std::string error_of(const std::string& text) {
  const Result<SignalConfig> result = read_signal_toml(text, "s.toml");
  return result ? "no error" : result.error();
}

std::string error_with(const std::string& from, const std::string& to) {
  return error_of(replaced(minimal, from, to));
}

TEST(TomlReader, TakesOverEveryValue) {
  const Result<SignalConfig> result = read_signal_toml(minimal + R"([noise]
peak = 1e-3
record_samples = 99
seed = 7
[speed_disturbance]
scale = 1e-2
record_samples = 98
seed = 8
[[harmonics]]
channel = "v"
order = 3
amplitude = 0.01
phase_rad = -0.5
)",
                                                       "s.toml");
  ASSERT_TRUE(result) << result.error();
  const SignalConfig& config = result.value();
  EXPECT_EQ(config.name, "x");
  EXPECT_EQ(config.sample_rate_hz, 500.0);
  EXPECT_EQ(config.samples, 10u);
  EXPECT_EQ(config.adc_bits, 16);
  EXPECT_EQ(config.a1, 0.5);
  EXPECT_EQ(config.a2, 0.6);
  EXPECT_EQ(config.b1, 0.1);
  EXPECT_EQ(config.b2, -0.1);
  EXPECT_EQ(config.beta, 0.06);
  EXPECT_EQ(config.phi, 0.08);
  EXPECT_EQ(config.motion.frequency_hz, -2.0);
  EXPECT_FALSE(config.motion.reference_hz);
  EXPECT_EQ(config.noise.peak, 1e-3);
  EXPECT_EQ(config.noise.record_samples, 99u);
  EXPECT_EQ(config.noise.seed, 7u);
  EXPECT_EQ(config.speed_disturbance.scale, 1e-2);
  EXPECT_EQ(config.speed_disturbance.record_samples, 98u);
  EXPECT_EQ(config.speed_disturbance.seed, 8u);
  ASSERT_EQ(config.harmonics.size(), 1u);
  EXPECT_EQ(config.harmonics[0].channel, Channel::v);
  EXPECT_EQ(config.harmonics[0].order, 3);
  EXPECT_EQ(config.harmonics[0].amplitude, 0.01);
  EXPECT_EQ(config.harmonics[0].phase_rad, -0.5);
}

TEST(TomlReader, ReadsEveryKindOfMotion) {
  const std::string old = "kind = \"constant\"\nfrequency_hz = -2";
  const auto motion = [&](const std::string& text) {
    const Result<SignalConfig> result = read_signal_toml(replaced(minimal, old, text), "s.toml");
    EXPECT_TRUE(result) << result.error();
    return result ? result.value().motion : MotionConfig();
  };
  const MotionConfig ripple = motion(
      "kind = \"ripple\"\nfrequency_hz = 1\nreference_hz = 2\nreverse_at_s = 3\n"
      "ripple_amplitude = 0.5\nripple_hz = 4");
  EXPECT_EQ(ripple.kind, MotionKind::ripple);
  EXPECT_EQ(ripple.reference_hz, 2.0);
  EXPECT_EQ(ripple.reverse_at_s, 3.0);
  EXPECT_EQ(ripple.ripple_amplitude, 0.5);
  EXPECT_EQ(ripple.ripple_hz, 4.0);
  EXPECT_EQ(motion("kind = \"shuffled\"\nseed = 3").seed, 3u);
  EXPECT_EQ(motion("kind = \"walk\"\nseed = 3\nstep_turns = 0.25").step_turns, 0.25);
  const MotionConfig swing =
      motion("kind = \"swing\"\nswing_hz = 1\ncentre_turns = 0.5\namplitude_turns = 0.2");
  EXPECT_EQ(swing.kind, MotionKind::swing);
  EXPECT_EQ(swing.centre_turns, 0.5);
  EXPECT_EQ(swing.amplitude_turns, 0.2);
}

const std::string constant_motion = "kind = \"constant\"\nfrequency_hz = -2";

std::string profile_error(const std::string& speeds) {
  return error_with(constant_motion, "kind = \"profile\"\nspeeds = " + speeds);
}

TEST(TomlReader, ReadsASpeedProfile) {
  const Result<SignalConfig> result = read_signal_toml(
      replaced(minimal, constant_motion,
               "kind = \"profile\"\nspeeds = [\n[0, 1], # comment\n[2.5, -100.0],\n]"),
      "s.toml");
  ASSERT_TRUE(result) << result.error();
  const MotionConfig& motion = result.value().motion;
  EXPECT_EQ(motion.kind, MotionKind::profile);
  ASSERT_EQ(motion.speeds.size(), 2u);
  EXPECT_EQ(motion.speeds[0].time_s, 0.0);
  EXPECT_EQ(motion.speeds[0].speed_hz, 1.0);
  EXPECT_EQ(motion.speeds[1].time_s, 2.5);
  EXPECT_EQ(motion.speeds[1].speed_hz, -100.0);
}

TEST(TomlReader, SaysWhatIsWrongWithASpeedProfileInTheLineOfItsPoint) {
  EXPECT_EQ(error_with(constant_motion, "kind = \"profile\""),
            "s.toml:13: 'speeds' is missing in [motion]; add it");
  for (const char* none : {"3", "[]", "\"fast\"", "{}"})
    EXPECT_EQ(profile_error(none),
              "s.toml:15: 'speeds' in [motion] is not a list of [seconds, Hz]; write [[0, 1], [5, "
              "100]]");
  for (const char* point : {"3", "[3]", "[3, 4, 5]", "[3, \"4\"]", "[true, 4]"})
    EXPECT_EQ(profile_error("[\n[0, 1],\n" + std::string(point) + "]"),
              "s.toml:17: 'speeds' in [motion] has a point that is not two numbers; write "
              "[seconds, Hz]");
  EXPECT_EQ(profile_error("[[1, 1]]"),
            "s.toml:15: 'speeds' in [motion] begins at 1 s; let its first point be at 0 s");
  EXPECT_EQ(profile_error("[[0, 1],\n[2, 1],\n[2, 3]]"),
            "s.toml:17: 'speeds' in [motion] has 2 s behind 2 s; put the points in order of time");
  EXPECT_EQ(profile_error("[[0, 1e7]]"),
            "s.toml:15: 'speeds' in [motion] has a point [0, 10000000] that is out of range; times "
            "must lie between 0 and 1000000000, speeds between -1000000 and 1000000");
  EXPECT_NE(profile_error("[[0, nan]]").find("out of range"), std::string::npos);
  EXPECT_NE(profile_error("[[0, 1], [-1, 1]]").find("out of range"), std::string::npos);
}

TEST(TomlReader, ReadsADrift) {
  const Result<SignalConfig> result = read_signal_toml(
      minimal +
          "[drift]\na1_per_s = 1e-3\na2_per_s = -2e-3\nb1_per_s = 3e-3\nb2_per_s = -4e-3\n"
          "beta_rad_per_s = 5e-3\nuntil_s = 60\n",
      "s.toml");
  ASSERT_TRUE(result) << result.error();
  const DriftConfig& drift = result.value().drift;
  EXPECT_EQ(drift.a1, 1e-3);
  EXPECT_EQ(drift.a2, -2e-3);
  EXPECT_EQ(drift.b1, 3e-3);
  EXPECT_EQ(drift.b2, -4e-3);
  EXPECT_EQ(drift.beta, 5e-3);
  EXPECT_EQ(drift.until_s, 60.0);
  EXPECT_FALSE(drift.period_s);
}

TEST(TomlReader, SaysWhatIsWrongWithADrift) {
  const auto drift = [](const std::string& text) { return error_of(minimal + "[drift]\n" + text); };
  EXPECT_EQ(drift("a1_per_s = 1e-3\n"),
            "s.toml:16: 'until_s' or 'period_s' is missing in [drift]; add one of them");
  EXPECT_EQ(drift("until_s = 1\nperiod_s = 1\n"),
            "s.toml:18: 'period_s' in [drift] stands beside 'until_s'; keep one of the two");
  EXPECT_EQ(drift("until_s = 1\na1_per_s = 2\n"),
            "s.toml:18: 'a1_per_s' in [drift] = 2 is out of range; it must lie between -1 and 1");
  EXPECT_EQ(drift("period_s = 0\n"),
            "s.toml:17: 'period_s' in [drift] = 0 is out of range; it must lie between 0.001 and "
            "1000000000");
  EXPECT_EQ(drift("until_s = 100\na2_per_s = -0.01\n"),
            "s.toml:18: 'a2_per_s' in [drift] = -0.01 leaves nothing of the amplitude; make it "
            "slower or its course shorter");
  EXPECT_EQ(drift("until_s = 100\na2_per_s = 0.01\n"), "no error");
  // A sine goes 10 / (2 pi) s both ways.
  EXPECT_NE(drift("period_s = 10\na1_per_s = 0.629\n").find("leaves nothing"), std::string::npos);
  EXPECT_EQ(drift("period_s = 10\na1_per_s = 0.628\n"), "no error");
  EXPECT_NE(drift("period_s = 10\nc1_per_s = 0.6\n").find("s.toml:18: unknown key 'c1_per_s'"),
            std::string::npos);
}

TEST(TomlReader, NamesTheNearestKeysOfAnUnknownOne) {
  EXPECT_EQ(
      error_with("beta_rad", "betta_rad"),
      "s.toml:11: unknown key 'betta_rad' in [signal]; the nearest known are beta_rad or phi_rad "
      "or a1");
  EXPECT_NE(error_with("[sampling]", "[sampled]")
                .find("s.toml:2: unknown key 'sampled' in the top level"),
            std::string::npos);
  EXPECT_NE(error_with("frequency_hz", "ripple_hz")
                .find("s.toml:15: unknown key 'ripple_hz' in [motion]"),
            std::string::npos);
}

TEST(TomlReader, SaysWhatIsMissing) {
  EXPECT_EQ(error_with("b2 = -0.1\n", ""), "s.toml:6: 'b2' is missing in [signal]; add it");
  EXPECT_EQ(error_with("name = \"x\"\n", ""),
            "s.toml:1: 'name' is missing in the top level; add it");
  EXPECT_EQ(error_of(""), "s.toml:1: 'name' is missing in the top level; add it");
  EXPECT_EQ(error_with("frequency_hz = -2\n", ""),
            "s.toml:13: 'frequency_hz' is missing in [motion]; add it");
  EXPECT_EQ(error_with("kind = \"constant\"\n", ""),
            "s.toml:13: 'kind' is missing in [motion]; add it");
  EXPECT_EQ(error_of(minimal + "[noise]\nseed = 1\n"),
            "s.toml:16: 'sigma' is missing in [noise]; add it");
  EXPECT_EQ(error_of(minimal + "[noise]\npeak = 1\nseed = 1\n"),
            "s.toml:16: 'record_samples' is missing in [noise]; add it");
}

TEST(TomlReader, ChecksRangesAndKinds) {
  EXPECT_EQ(error_with("a1 = 0.5", "a1 = -0.5"),
            "s.toml:7: 'a1' in [signal] = -0.5 is out of range; it must lie between 1e-06 and 10");
  EXPECT_EQ(error_with("a1 = 0.5", "a1 = nan"),
            "s.toml:7: 'a1' in [signal] is not finite; write a finite number");
  EXPECT_EQ(error_with("b1 = 0.1", "b1 = -inf"),
            "s.toml:9: 'b1' in [signal] is not finite; write a finite number");
  EXPECT_EQ(error_with("a2 = 0.6", "a2 = \"0.6\""),
            "s.toml:8: 'a2' in [signal] is not a number; write a number");
  EXPECT_EQ(error_with("a2 = 0.6", "a2 = true"),
            "s.toml:8: 'a2' in [signal] is not a number; write a number");
  EXPECT_EQ(
      error_with("adc_bits = 16", "adc_bits = 11"),
      "s.toml:5: 'adc_bits' in [sampling] = 11 is out of range; it must lie between 12 and 32");
  EXPECT_EQ(error_with("adc_bits = 16", "adc_bits = 16.0"),
            "s.toml:5: 'adc_bits' in [sampling] is not an integer; write a whole number");
  EXPECT_EQ(error_with("samples = 10", "samples = 0"),
            "s.toml:4: 'samples' in [sampling] = 0 is out of range; it must lie between 1 and "
            "1000000000000");
  EXPECT_EQ(error_with("name = \"x\"", "name = 1"),
            "s.toml:1: 'name' in the top level is not a text; put it in quotes");
  EXPECT_EQ(
      error_with("\"constant\"", "\"constent\""),
      "s.toml:14: 'kind' in [motion] = 'constent' is not known; the nearest known are constant or "
      "swing or ripple");
  EXPECT_EQ(error_of(replaced(minimal, "[sampling]\nrate_hz = 500\nsamples = 10\nadc_bits = 16\n",
                              "sampling = 3\n")),
            "s.toml:2: 'sampling' in the top level is not a table; write [sampling]");
  EXPECT_EQ(error_of(minimal + "[harmonics]\norder = 3\n"),
            "s.toml:16: 'harmonics' in the top level is not a list of tables; write [[harmonics]]");
  EXPECT_EQ(error_of(minimal + "[[harmonics]]\nchannel = \"w\"\norder = 3\namplitude = 0.1\n"),
            "s.toml:17: 'channel' in [harmonics] = 'w' is not known; write \"u\" or \"v\"");
  EXPECT_EQ(
      error_of(minimal + "[[harmonics]]\nchannel = \"u\"\norder = 3\namplitude = -0.1\n"),
      "s.toml:19: 'amplitude' in [harmonics] = -0.1 is out of range; it must lie between 0 and 10");
}

TEST(TomlReader, RefusesCombinationsThatMeanNothing) {
  EXPECT_EQ(error_of(minimal + "[noise]\nsigma = 1\npeak = 1\nseed = 1\n"),
            "s.toml:18: 'peak' in [noise] stands beside 'sigma'; keep one of the two");
  EXPECT_EQ(error_of(minimal + "[noise]\nsigma = 1\nseed = 1\nrecord_samples = 5\n"),
            "s.toml:19: 'record_samples' in [noise] only belongs to 'peak'; remove it");
  const std::string shuffled =
      replaced(minimal, "kind = \"constant\"\nfrequency_hz = -2", "kind = \"shuffled\"\nseed = 1");
  EXPECT_EQ(error_of(shuffled + "[speed_disturbance]\nscale = 0.1\nrecord_samples = 9\nseed = 1\n"),
            "s.toml:17: 'scale' in [speed_disturbance] needs motion of kind 'constant'; change the "
            "motion "
            "or remove this table");
}

TEST(TomlReader, ReportsTheLineOfInvalidToml) {
  const std::string error = error_with("b1 = 0.1", "b1 = = 0.1");
  EXPECT_EQ(error.rfind("s.toml:9: not valid TOML (", 0), 0u) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos);
}

/// Result of the minimal description with additional keys.
Result<SignalConfig> overlaid(const std::vector<KeyValue>& keys, const std::string& more = "") {
  return read_signal_toml(minimal + more, "s.toml", keys);
}

std::string overlaid_error(const std::vector<KeyValue>& keys, const std::string& more = "") {
  const auto result = overlaid(keys, more);
  return result ? "no error" : result.error();
}

TEST(TomlReader, KeysFromOutsideLieOverTheFile) {
  const auto result = overlaid({{"a1", "0.25", "-C a"},
                                {"motion.frequency_hz", "-1e-1", "-C b"},
                                {"samples", "1e3", "-C c"},
                                {"name", "5", "-C d"},
                                {"noise.sigma", "0.5", "-C e"},
                                {"noise.seed", "9", "-C f"},
                                {"harmonics.v12_amplitude", "0.125", "-C g"}});
  ASSERT_TRUE(result) << result.error();
  EXPECT_EQ(result.value().a1, 0.25);
  EXPECT_EQ(result.value().a2, 0.6);
  EXPECT_EQ(result.value().motion.frequency_hz, -0.1);
  EXPECT_EQ(result.value().samples, 1000U);
  EXPECT_EQ(result.value().name, "5");
  EXPECT_EQ(result.value().noise.sigma, 0.5);
  EXPECT_EQ(result.value().noise.seed, 9U);
  ASSERT_EQ(result.value().harmonics.size(), 1U);
  EXPECT_EQ(result.value().harmonics[0].channel, Channel::v);
  EXPECT_EQ(result.value().harmonics[0].order, 12);
  EXPECT_EQ(result.value().harmonics[0].amplitude, 0.125);
}

TEST(TomlReader, EveryKeyOfItsListIsOneOfADescription) {
  for (const DescriptionKey& key : description_keys()) {
    const bool text = key.kind == DescriptionKey::Kind::text;
    // A drift needs a course.
    std::vector<KeyValue> keys = {{key.name(), text ? "constant" : "1", "-C x"}};
    if (std::string(key.table) == "drift") keys.push_back({"drift.until_s", "0.5", "-C y"});
    const std::string error = overlaid_error(keys);
    // For another kind of motion it may be unknown, but it is none that no motion has.
    const bool unknown = error.find("unknown key") != std::string::npos;
    EXPECT_EQ(unknown && std::string(key.table) != "motion", false) << error;
  }
  for (const MotionKind kind : {MotionKind::constant, MotionKind::ripple, MotionKind::shuffled,
                                MotionKind::walk, MotionKind::swing, MotionKind::profile}) {
    std::vector<KeyValue> keys = {{"motion.kind", name_of(kind), "-C kind"}};
    for (const std::string& key : motion_keys(kind))
      if (key != "kind")
        keys.push_back({"motion." + key, key == "speeds" ? "[[0, 1]]" : "1", "-C " + key});
    EXPECT_EQ(overlaid_error(keys), "no error") << name_of(kind);
  }
}

TEST(TomlReader, AListFromOutsideIsReadAsInAFile) {
  const auto result = overlaid(
      {{"motion.kind", "profile", "-C x"}, {"motion.speeds", "[[0, 1], [5, -1e2]]", "-C y"}});
  ASSERT_TRUE(result) << result.error();
  ASSERT_EQ(result.value().motion.speeds.size(), 2u);
  EXPECT_EQ(result.value().motion.speeds[1].speed_hz, -100.0);
  for (const char* wrong : {"fast", "[[0, 1]", "[[0, 1]]\nother = 3", "1"})
    EXPECT_EQ(
        overlaid_error({{"motion.kind", "profile", "-C x"}, {"motion.speeds", wrong, "-C y"}}),
        "-C y: 'speeds' in [motion] is not a list of [seconds, Hz]; write [[0, 1], [5, 100]]");
  EXPECT_EQ(
      overlaid_error({{"motion.kind", "profile", "-C x"}, {"motion.speeds", "[[1, 1]]", "-C y"}}),
      "-C y: 'speeds' in [motion] begins at 1 s; let its first point be at 0 s");
}

TEST(TomlReader, WhatIsWrongWithAKeyFromOutsideNamesItsOrigin) {
  EXPECT_EQ(overlaid_error({{"a1", "0", "-C sensor.a1=0"}}),
            "-C sensor.a1=0: 'a1' in [signal] = 0 is out of range; it must lie between 1e-06 and "
            "10");
  EXPECT_EQ(overlaid_error({{"b1", "nan", "-C x"}}),
            "-C x: 'b1' in [signal] is not finite; write a finite number");
  EXPECT_EQ(overlaid_error({{"noise.peak", "0.1", "-C x"}}),
            "-C x: 'seed' is missing in [noise]; add it");
  EXPECT_EQ(overlaid_error({{"motion.seed", "1", "-C x"}}).rfind("-C x: unknown key 'seed'", 0),
            0U);
  EXPECT_EQ(overlaid_error({{"a1", "", "-C x"}}), "s.toml:6: 'a1' is missing in [signal]; add it");
  EXPECT_EQ(overlaid_error({{"signal", "1", "-C x"}}).rfind("-C x: a description has no key", 0),
            0U);
  const std::string twice =
      "[[harmonics]]\nchannel = \"u\"\norder = 3\namplitude = 0.1\n"
      "[[harmonics]]\nchannel = \"u\"\norder = 3\namplitude = 0.2\n";
  EXPECT_EQ(overlaid_error({{"harmonics.u3_amplitude", "1", "-C x"}}, twice),
            "-C x: the description has more than one harmonic of this channel and order; edit it");
  // Not in the way of what is wrong in the file.
  EXPECT_EQ(overlaid_error({{"a1", "0.5", "-C x"}}, "[noise]\nsigma = -1\nseed = 1\n"),
            "s.toml:17: 'sigma' in [noise] = -1 is out of range; it must lie between 0 and 10");
}

TEST(TomlReader, AKeyThatBelongsToTheOtherKindGoesWithIt) {
  const std::string peak = "[noise]\npeak = 0.1\nrecord_samples = 5\nseed = 1\n";
  EXPECT_EQ(overlaid({{"noise.sigma", "0.2", "-C x"}}, peak).value().noise.peak, 0.0);
  const std::string sigma = "[noise]\nsigma = 0.1\nseed = 1\n";
  EXPECT_EQ(
      overlaid_error({{"noise.peak", "0.2", "-C x"}, {"noise.record_samples", "7", "-C y"}}, sigma),
      "no error");
  EXPECT_EQ(overlaid_error({{"motion.kind", "shuffled", "-C x"}, {"motion.seed", "7", "-C y"}}),
            "no error");
  const std::string drift = "[drift]\nb1_per_s = 0.1\nuntil_s = 5\n";
  const auto sine = overlaid({{"drift.period_s", "7", "-C x"}}, drift);
  ASSERT_TRUE(sine) << sine.error();
  EXPECT_EQ(sine.value().drift.period_s, 7.0);
  EXPECT_FALSE(sine.value().drift.until_s);
  EXPECT_EQ(overlaid({{"noise.sigma", "", "-C x"}, {"noise.seed", "", "-C y"}}, sigma)
                .value()
                .noise.sigma,
            0.0);
}

}  // namespace
}  // namespace capsoc::sensor
