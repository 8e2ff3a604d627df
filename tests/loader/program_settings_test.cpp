#include "loader/program_settings.h"

#include <gtest/gtest.h>

namespace capsoc::loader {
namespace {

ElfImage selfcal() {
  auto image = load_elf(SELFCAL_ELF);
  EXPECT_TRUE(image) << image.error();
  return image ? std::move(image.value()) : ElfImage();
}

/// What a later reader of the image sees.
std::string value_in(const ElfImage& image, const std::string& name) {
  const auto settings = ProgramSettings::read(image);
  EXPECT_TRUE(settings) << settings.error();
  return settings.value().value(*settings.value().find(name));
}

TEST(ProgramSettings, AProgramDescribesItsOwn) {
  const auto settings = ProgramSettings::read(selfcal());
  ASSERT_TRUE(settings) << settings.error();
  const ProgramSetting* rate = settings.value().find("rate_hz");
  ASSERT_NE(rate, nullptr);
  EXPECT_EQ(rate->unit, "Hz");
  EXPECT_EQ(rate->size, 4U);
  EXPECT_EQ(rate->kind, ProgramSetting::Kind::unsigned_number);
  EXPECT_EQ(settings.value().value(*rate), "250");
  EXPECT_EQ(settings.value().range(*rate), "1 .. 100000");
  const ProgramSetting* frequency = settings.value().find("frequency_hz");
  ASSERT_NE(frequency, nullptr);
  EXPECT_EQ(frequency->kind, ProgramSetting::Kind::signed_number);
  EXPECT_EQ(settings.value().value(*frequency), "0.05") << "as short as the word allows";
  EXPECT_EQ(settings.value().range(*frequency), "-10000 .. 10000");
  EXPECT_EQ(settings.value().value(*settings.value().find("step")), "0.00062832");
}

TEST(ProgramSettings, AProgramWithoutHasNone) {
  auto image = load_elf(HELLO_ELF);
  ASSERT_TRUE(image) << image.error();
  const auto settings = ProgramSettings::read(image.value());
  ASSERT_TRUE(settings) << settings.error();
  EXPECT_TRUE(settings.value().all().empty());
}

TEST(ProgramSettings, ValuesAreWrittenInTheImage) {
  ElfImage image = selfcal();
  auto settings = ProgramSettings::read(image);
  ASSERT_TRUE(settings) << settings.error();
  ProgramSettings& program = settings.value();
  EXPECT_FALSE(program.set(*program.find("rate_hz"), "500", "-P"));
  EXPECT_FALSE(program.set(*program.find("frequency_hz"), "-0.25", "-P"));
  EXPECT_FALSE(program.set(*program.find("demodulation_samples"), "2e4", "-P"));
  program.write(image);
  EXPECT_EQ(value_in(image, "rate_hz"), "500");
  EXPECT_EQ(value_in(image, "frequency_hz"), "-0.25");
  EXPECT_EQ(value_in(image, "demodulation_samples"), "20000");
  EXPECT_EQ(value_in(image, "step"), "0.00062832");
}

TEST(ProgramSettings, WhatDoesNotFitIsASentenceAndChangesNothing) {
  const ElfImage image = selfcal();
  auto settings = ProgramSettings::read(image);
  ASSERT_TRUE(settings) << settings.error();
  ProgramSettings& program = settings.value();
  const auto refused = [&](const char* name, const char* value, const char* expected) {
    const auto error = program.set(*program.find(name), value, "-P x");
    ASSERT_TRUE(error) << name << " = " << value;
    EXPECT_EQ(error->text.rfind("-P x: ", 0), 0U) << error->text;
    EXPECT_NE(error->text.find(expected), std::string::npos) << error->text;
  };
  refused("rate_hz", "0", "give 1 .. 100000 Hz");
  refused("rate_hz", "100001", "out of range");
  refused("rate_hz", "99999999999999999999", "out of range");
  refused("rate_hz", "-1", "out of range");
  for (const char* value : {"fast", "", "1 ", "2.5", "nan", "inf", "0x", "0x-1"})
    refused("rate_hz", value, "whole number in Hz");
  refused("frequency_hz", "10001", "out of range");
  refused("frequency_hz", "1e300", "out of range");
  refused("frequency_hz", "fast", "cannot be 'fast'");
  refused("step", "1e-12", "would become 0");
  EXPECT_EQ(program.value(*program.find("rate_hz")), "250");
  EXPECT_EQ(program.value(*program.find("frequency_hz")), "0.05");
}

/// An image whose object `program_settings` is made here.
class Hostile : public testing::Test {
 protected:
  static constexpr std::size_t values_at = 8 + 160, object_size = values_at + 16;

  Hostile() : bytes_(object_size) {
    put(0, 0x31544553, 4);
    put(4, 1, 4);
    name("greeting");
    put(8 + 128, values_at, 4);
    put(8 + 132, 16, 2);
    put(8 + 134, 2, 1);
  }
  void put(std::size_t at, uint64_t value, unsigned size) {
    for (unsigned i = 0; i < size; ++i) bytes_[at + i] = static_cast<uint8_t>(value >> (8 * i));
  }
  void name(const std::string& text) {
    for (std::size_t i = 0; i < 32; ++i)
      bytes_[8 + i] = i < text.size() ? static_cast<uint8_t>(text[i]) : 0;
  }
  void number(uint64_t size, int64_t least, int64_t greatest) {
    put(8 + 132, size, 2);
    put(8 + 134, 1, 1);
    put(8 + 136, 1, 8);
    put(8 + 144, static_cast<uint64_t>(least), 8);
    put(8 + 152, static_cast<uint64_t>(greatest), 8);
  }
  ElfImage image() const {
    ElfImage image;
    image.path = "hostile.elf";
    image.segments.push_back({0x100, bytes_, static_cast<uint32_t>(bytes_.size())});
    image.symbols.push_back({0x100, static_cast<uint32_t>(bytes_.size()), "program_settings"});
    return image;
  }
  void refused(const std::string& expected) const {
    const auto settings = ProgramSettings::read(image());
    ASSERT_FALSE(settings) << expected;
    EXPECT_EQ(settings.error().rfind("hostile.elf: ", 0), 0U) << settings.error();
    EXPECT_NE(settings.error().find(expected), std::string::npos) << settings.error();
  }

  std::vector<uint8_t> bytes_;
};

TEST_F(Hostile, ATextFitsOrIsRefused) {
  ElfImage whole = image();
  auto settings = ProgramSettings::read(whole);
  ASSERT_TRUE(settings) << settings.error();
  ProgramSettings& program = settings.value();
  const ProgramSetting& greeting = program.all().front();
  EXPECT_FALSE(program.set(greeting, "fifteen letters", "-P"));
  program.write(whole);
  EXPECT_EQ(value_in(whole, "greeting"), "fifteen letters");
  EXPECT_FALSE(program.set(greeting, "short", "-P"));
  EXPECT_EQ(program.value(greeting), "short");
  const auto error = program.set(greeting, "sixteen letters!", "-P");
  ASSERT_TRUE(error);
  EXPECT_NE(error->text.find("too long; give at most 15 bytes"), std::string::npos) << error->text;
  EXPECT_EQ(program.value(greeting), "short");
}

TEST_F(Hostile, AnotherObjectOfThatNameIsNone) {
  put(0, 0x31544554, 4);
  const auto settings = ProgramSettings::read(image());
  ASSERT_TRUE(settings) << settings.error();
  EXPECT_TRUE(settings.value().all().empty());
}

TEST_F(Hostile, ValuesOutsideTheObjectAreRefused) {
  for (const uint64_t offset : {uint64_t{values_at + 1}, uint64_t{object_size},
                                uint64_t{0xFFFFFFF8}, uint64_t{values_at - 1}, uint64_t{0}}) {
    put(8 + 128, offset, 4);
    refused("outside");
  }
  put(8 + 128, values_at, 4);
  put(8 + 132, 0xFFFF, 2);
  refused("outside");
}

TEST_F(Hostile, MoreDescriptionsThanTheObjectHolds) {
  for (const uint64_t count : {2, 1000, 0x7FFFFFFF, -1}) {
    put(4, count, 4);
    refused("end after");
  }
}

TEST_F(Hostile, NamesKindsAndRangesHaveToMakeSense) {
  for (const char* text :
       {"", "Greeting", "a b", "a\x1b[2J", "1st", "a_name_without_a_zero_behind_it_"}) {
    name(text);
    refused("no legal name");
  }
  name("n");
  put(8 + 134, 3, 1);
  refused("unknown kind");
  number(3, 0, 1);
  refused("neither 1, 2, 4 nor 8");
  number(2, -32769, 0);
  refused("range does not fit");
  number(2, 0, 32768);
  refused("range does not fit");
  number(2, 5, 4);
  refused("range does not fit");
  number(2, 0, 5);
  put(8 + 136, 0, 8);
  refused("not positive");
}

}  // namespace
}  // namespace capsoc::loader
