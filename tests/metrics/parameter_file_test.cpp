#include "metrics/parameter_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

namespace capsoc::run {
namespace {

using nlohmann::json;

const metrics::Parameters values{0.6079, 0.6228, 0.1336, -0.1831, -0.0629, 3.1};

json example() {
  const metrics::ParameterWords words = metrics::to_words(values).value();
  json j;
  j["parameters"] = {{"a1", {{"word", words.a1}, {"value", values.a1}}},
                     {"a2", {{"word", words.a2}, {"value", values.a2}}},
                     {"b1", {{"word", words.b1}, {"value", values.b1}}},
                     {"b2", {{"word", words.b2}, {"value", values.b2}}},
                     {"beta", {{"word", words.beta}, {"value", values.beta}}},
                     {"phi", {{"word", words.phi}, {"value", values.phi}}}};
  return j;
}

Result<metrics::ParameterWords> read_text(const std::string& text) {
  const std::string path = testing::TempDir() + std::to_string(getpid()) + "parameters.json";
  std::ofstream(path, std::ios::binary) << text;
  auto result = metrics::read_parameters(path);
  std::remove(path.c_str());
  if (!result) {
    EXPECT_EQ(result.error().rfind(path, 0), 0u) << result.error();
    EXPECT_EQ(result.error().find('\n'), std::string::npos) << result.error();
  }
  return result;
}

void refused(const json& j, const std::string& expected) {
  const auto result = read_text(j.dump());
  ASSERT_FALSE(result) << expected;
  EXPECT_NE(result.error().find(expected), std::string::npos) << result.error();
}

TEST(ParameterWords, AreNumbersRoundedToTheNearest) {
  const auto words =
      metrics::to_words({0.5, 0.25, -1, 0.75 * 0x1p-31, std::acos(-1.0), -std::acos(0.0)});
  ASSERT_TRUE(words);
  EXPECT_EQ(words->a1, 1 << 30);
  EXPECT_EQ(words->b1, INT32_MIN);
  EXPECT_EQ(words->b2, 1);
  EXPECT_EQ(words->beta, 0x80000000u);
  EXPECT_EQ(words->phi, 0xC0000000u);
}

TEST(ParameterWords, WhatDoesNotFitHasNone) {
  EXPECT_FALSE(metrics::to_words({1, 0.5, 0, 0, 0, 0}));
  EXPECT_FALSE(metrics::to_words({0.5, 0, 0, 0, 0, 0}));
  EXPECT_FALSE(metrics::to_words({0.5, 0.5, 1, 0, 0, 0}));
  EXPECT_FALSE(metrics::to_words({0.5, 0.5, 0, std::nan(""), 0, 0}));
  EXPECT_FALSE(metrics::to_words({0.5, 0.5, 0, 0, INFINITY, 0}));
}

TEST(ParameterFile, WordsAreRead) {
  const auto words = read_text(example().dump());
  ASSERT_TRUE(words) << words.error();
  EXPECT_EQ(words.value().a1, metrics::to_words(values)->a1);
  EXPECT_EQ(words.value().b2, metrics::to_words(values)->b2);
  EXPECT_EQ(words.value().beta, metrics::to_words(values)->beta);
  EXPECT_EQ(words.value().phi, metrics::to_words(values)->phi);
}

TEST(ParameterFile, AnAngleMayBeASignedWordAndAnyBranch) {
  json j = example();
  j["parameters"]["beta"]["word"] = static_cast<int32_t>(metrics::to_words(values)->beta);
  j["parameters"]["beta"]["value"] = values.beta + 4 * std::acos(-1.0);
  const auto words = read_text(j.dump());
  ASSERT_TRUE(words) << words.error();
  EXPECT_EQ(words.value().beta, metrics::to_words(values)->beta);
}

TEST(ParameterFile, WhatIsMissingIsNamed) {
  for (const char* name : {"a1", "a2", "b1", "b2", "beta", "phi"}) {
    json j = example();
    j["parameters"].erase(name);
    refused(j, std::string("parameters.") + name);
    j = example();
    j["parameters"][name].erase("word");
    refused(j, std::string("parameters.") + name + ".word");
    j = example();
    j["parameters"][name]["value"] = nullptr;
    refused(j, std::string("parameters.") + name + ".value");
  }
  refused(json::object(), "no parameters");
  refused(json::array({1}), "no parameters");
}

TEST(ParameterFile, AWordThatDisagreesWithItsValueIsRefused) {
  for (const char* name : {"a1", "a2", "b1", "b2", "beta", "phi"}) {
    json j = example();
    json& word = j["parameters"][name]["word"];
    word = word.get<int64_t>() + 2;
    refused(j, "disagree");
  }
}

TEST(ParameterFile, AWordOutOfRangeIsRefused) {
  json j = example();
  j["parameters"]["a1"]["word"] = int64_t{1} << 31;
  refused(j, "out of range");
  j["parameters"]["a1"]["word"] = 0;
  refused(j, "out of range");
  j["parameters"]["a1"]["word"] = UINT64_MAX;
  refused(j, "out of range");
  j["parameters"]["a1"]["word"] = 0.5;
  refused(j, "whole number");
}

TEST(ParameterFile, AnErrorTableIsReadOrRefused) {
  const auto read = [](const json& j) {
    const std::string path = testing::TempDir() + std::to_string(getpid()) + "table.json";
    std::ofstream(path, std::ios::binary) << j.dump();
    auto table = metrics::read_error_table(path);
    std::remove(path.c_str());
    return table;
  };
  json j = example();
  EXPECT_FALSE(read(j).value());
  j["error_table"] = {{"identified", false}};
  EXPECT_FALSE(read(j).value());
  std::vector<int> nodes(128, -7);
  nodes[127] = -(1 << 19);
  j["error_table"]["nodes"] = nodes;
  const auto table = read(j);
  ASSERT_TRUE(table) << table.error();
  EXPECT_EQ(table.value()->at(0), -7);
  EXPECT_EQ(table.value()->at(127), -(1 << 19));
  for (const json& bad : {json(1 << 19), json(0.5), json("x"), json(UINT64_MAX)}) {
    j["error_table"]["nodes"][3] = bad;
    ASSERT_FALSE(read(j)) << bad;
    EXPECT_NE(read(j).error().find("error_table.nodes[3] = "), std::string::npos);
  }
  nodes.pop_back();
  j["error_table"]["nodes"] = nodes;
  EXPECT_NE(read(j).error().find("list of 128"), std::string::npos);
  j["error_table"] = 3;
  EXPECT_FALSE(read(j));
}

TEST(ParameterFile, DamageIsASentenceWithTheLine) {
  const auto broken = read_text("{\n\"parameters\": {\n\"a1\": }\n}");
  ASSERT_FALSE(broken);
  EXPECT_NE(broken.error().find(":3: "), std::string::npos) << broken.error();
  EXPECT_FALSE(read_text(""));
  EXPECT_FALSE(read_text("{\"x\": 1e999}"));
  EXPECT_FALSE(metrics::read_parameters("/nonexistent/parameters.json"));
}

TEST(ParameterFile, DamagedBytesAreRefusedOrReadButNeverCrash) {
  const std::string whole = example().dump(1);
  constexpr unsigned seed = 20191108;
  std::mt19937 random(seed);
  int refusals = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = whole;
    damaged[random() % damaged.size()] = static_cast<char>(random());
    if (round % 4 == 0) damaged.resize(random() % damaged.size());
    if (!read_text(damaged)) ++refusals;
  }
  EXPECT_GT(refusals, 1000) << "seed " << seed;
}

TEST(ParameterFile, AProgramWithoutAPlaceForThemIsRefused) {
  auto image = loader::load_elf(HELLO_ELF);
  ASSERT_TRUE(image) << image.error();
  const auto error = metrics::write_in_program(image.value(), metrics::to_words(values).value());
  ASSERT_TRUE(error);
  EXPECT_NE(error->text.find("calibration_parameters"), std::string::npos) << error->text;
}

TEST(ParameterFile, TheWordsAreWrittenWhereTheProgramHasThem) {
  auto image = loader::load_elf(CALIBRATE_ELF);
  ASSERT_TRUE(image) << image.error();
  const metrics::ParameterWords words = metrics::to_words(values).value();
  ASSERT_FALSE(metrics::write_in_program(image.value(), words));
  const uint32_t address = image.value().address_of("calibration_parameters").value();
  const auto word_at = [&](uint32_t at) -> uint32_t {
    for (const loader::Segment& segment : image.value().segments) {
      if (at < segment.address || at + 4 > segment.address + segment.bytes.size()) continue;
      const uint8_t* bytes = &segment.bytes[at - segment.address];
      return bytes[0] | bytes[1] << 8 | bytes[2] << 16 | static_cast<uint32_t>(bytes[3]) << 24;
    }
    return 0;
  };
  EXPECT_EQ(word_at(address), 0x43414C31u);
  EXPECT_EQ(word_at(address + 4), static_cast<uint32_t>(words.a1));
  EXPECT_EQ(word_at(address + 16), static_cast<uint32_t>(words.b2));
  EXPECT_EQ(word_at(address + 24), words.phi);
}

}  // namespace
}  // namespace capsoc::run
