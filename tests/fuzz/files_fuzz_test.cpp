// Damaged files of every kind that a user hands to the program: whatever the bytes, reading ends
// with a value or with one sentence that names the file. The numbers are the seeds, so a failure
// repeats. CAPSOC_FUZZ_FILES sets how many of each kind; a build of the preset `sanitize` sees
// reads outside them, too.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "damage.h"
#include "loader/elf_image.h"
#include "loader/program_file.h"
#include "loader/program_settings.h"
#include "metrics/parameter_file.h"
#include "sensor/described_source.h"
#include "sensor/recorded_source.h"
#include "sensor/toml_reader.h"
#include "serial/pin_line.h"
#include "support/setting_fields.h"
#include "tally.h"
#include "trace/coverage_file.h"

namespace capsoc::test {
namespace {

TEST(FileFuzz, DamagedProgramSettings) {
  const auto whole = loader::load_elf(SELFCAL_ELF);
  ASSERT_TRUE(whole) << whole.error();
  const auto object = whole.value().contents("program_settings");
  ASSERT_TRUE(object);
  const std::string bytes(object->begin(), object->end());
  const uint64_t count = file_count(4000);
  Tally tally("program settings", count);
  for (uint64_t number = 0; number < count; ++number) {
    const std::string damaged = Damage(number).binary(bytes, 200, 160);
    loader::ElfImage image;
    image.path = "f.elf";
    image.segments.push_back({0, {damaged.begin(), damaged.end()}, 1U << 20U});
    image.symbols.push_back({0, static_cast<uint32_t>(damaged.size()), "program_settings"});
    auto settings = loader::ProgramSettings::read(image);
    if (!settings) {
      tally.refuse(settings.error(), image.path, number);
      continue;
    }
    tally.accept();
    for (const loader::ProgramSetting& setting : settings.value().all()) {
      settings.value().value(setting);
      settings.value().range(setting);
      for (const char* value : {"0", "-1", "4e9", "0.3", "x"})
        settings.value().set(setting, value, "-P");
    }
    settings.value().write(image);
    EXPECT_EQ(image.segments.front().bytes.size(), damaged.size()) << number;
  }
}

/// Intel HEX of a program; `line` may be damaged before its checksum is made, so that damage gets
/// past it.
std::string hex_record(uint8_t type, uint16_t address, const std::string& data) {
  std::string line = fmt::format(":{:02X}{:04X}{:02X}", data.size(), address, type);
  unsigned sum = static_cast<unsigned>(data.size()) + (address >> 8U) + (address & 0xFFU) + type;
  for (const char c : data) {
    line += fmt::format("{:02X}", static_cast<uint8_t>(c));
    sum += static_cast<uint8_t>(c);
  }
  return line + fmt::format("{:02X}\n", static_cast<uint8_t>(-sum));
}

std::string hex_file(Damage& damage) {
  std::string text = hex_record(4, 0, std::string("\x20\x00", 2));
  for (uint64_t records = 4 + damage.below(12); records > 0; --records) {
    const bool odd = damage.below(16) == 0;
    const auto type = static_cast<uint8_t>(odd ? damage.below(8) : 0);
    const auto address = static_cast<uint16_t>(odd ? damage.below(65536) : 16 * records);
    text += hex_record(type, address, std::string(odd ? damage.below(6) : 16, 'x'));
  }
  return text + hex_record(5, 0, std::string("\0\0\0\x09", 4)) + hex_record(1, 0, "");
}

TEST(FileFuzz, DamagedHex) {
  const uint64_t count = file_count(4000);
  Tally tally("HEX", count);
  for (uint64_t number = 0; number < count; ++number) {
    Damage damage(number);
    std::string text = hex_file(damage);
    if (damage.below(2) != 0) text = damage.text(text);
    const auto image = loader::parse_hex("f.hex", text);
    if (!image) {
      tally.refuse(image.error(), "f.hex", number);
      continue;
    }
    tally.accept();
    for (const loader::Segment& segment : image.value().segments)
      ASSERT_LE(uint64_t{segment.address} + segment.memory_size, uint64_t{1} << 32U) << number;
  }
}

/// A record of an S type and the width of its address in bytes, with a right checksum.
std::string s_record(char type, unsigned width, uint32_t address, const std::string& data) {
  std::string bytes(1, static_cast<char>(width + data.size() + 1));
  for (unsigned i = width; i > 0; --i) bytes += static_cast<char>(address >> (8 * (i - 1)));
  bytes += data;
  unsigned sum = 0;
  std::string line = fmt::format("S{}", type);
  for (const char c : bytes) {
    line += fmt::format("{:02X}", static_cast<uint8_t>(c));
    sum += static_cast<uint8_t>(c);
  }
  return line + fmt::format("{:02X}\n", ~sum & 0xFF);
}

/// The kinds of damage that pass the checksum come from here, the others from Damage.
std::string s_record_file(Damage& damage) {
  std::string text = s_record('0', 2, 0, "f");
  const uint64_t count = 4 + damage.below(12);
  for (uint64_t record = 0; record < count; ++record) {
    const bool odd = damage.below(16) == 0;
    const char type = static_cast<char>('0' + (odd ? damage.below(10) : 3));
    const auto address =
        static_cast<uint32_t>(odd ? damage.below(uint64_t{1} << 32U) : 0x20000000 + 16 * record);
    text += s_record(type, odd ? static_cast<unsigned>(damage.below(5)) : 4, address,
                     std::string(odd ? damage.below(6) : 16, 'x'));
  }
  if (damage.below(4) == 0) text += s_record('5', 2, static_cast<uint32_t>(count), "");
  return text + s_record('7', 4, 0x20000009, "");
}

TEST(FileFuzz, DamagedSRecords) {
  const uint64_t count = file_count(4000);
  Tally tally("S-records", count);
  for (uint64_t number = 0; number < count; ++number) {
    Damage damage(number);
    std::string text = s_record_file(damage);
    if (damage.below(2) != 0) text = damage.text(text);
    const auto image = loader::parse_srec("f.srec", text);
    if (!image) {
      tally.refuse(image.error(), "f.srec", number);
      continue;
    }
    tally.accept();
    for (const loader::Segment& segment : image.value().segments)
      ASSERT_LE(uint64_t{segment.address} + segment.memory_size, uint64_t{1} << 32U) << number;
  }
}

TEST(FileFuzz, DamagedSensorDescriptions) {
  const std::string whole = content("traces/soc_experiment.toml") +
                            "[speed_disturbance]\nscale = 1e-2\nrecord_samples = 100\nseed = 1\n";
  ASSERT_GT(whole.size(), 200U);
  const uint64_t count = file_count(4000);
  Tally tally("sensor TOML", count);
  for (uint64_t number = 0; number < count; ++number) {
    const auto result = sensor::read_signal_toml(Damage(number).text(whole), "f.toml");
    if (!result) {
      tally.refuse(result.error(), "f.toml", number);
      continue;
    }
    tally.accept();
    sensor::DescribedSource source(result.value());
    const auto value = source.sample(3, 0.012);
    if (!value) continue;
    EXPECT_TRUE(std::isfinite(value->u) && std::isfinite(value->v)) << number;
  }
}

TEST(FileFuzz, DamagedRecordings) {
  const std::string whole = content("traces/recorded_example.csv").substr(0, 3000);
  ASSERT_GT(whole.size(), 2000U);
  const uint64_t count = file_count(4000);
  Tally tally("CSV", count);
  for (uint64_t number = 0; number < count; ++number) {
    auto result = sensor::read_recording(Damage(number).text(whole), "f.csv");
    if (!result) {
      tally.refuse(result.error(), "f.csv", number);
      continue;
    }
    tally.accept();
    const auto value = result.value().sample(0, 0.0);
    ASSERT_TRUE(value) << number;
    EXPECT_TRUE(std::isfinite(value->u) && std::isfinite(value->v)) << number;
    EXPECT_TRUE(value->angle_turns >= 0.0 && value->angle_turns < 1.0) << number;
  }
}

TEST(FileFuzz, DamagedSettings) {
  const std::string whole =
      "# of a run\n[cpu]\nquantum_ns = 4e3\nexecutor = 'blocks'\nlines = 3\n[run]\ngolden = true\n"
      "until_uart = \"pass$\"\nlog = 'a.log'\n";
  const uint64_t count = file_count(4000);
  Tally tally("settings TOML", count);
  const TemporaryFile file(".toml");
  for (uint64_t number = 0; number < count; ++number) {
    Settings settings;
    const NumberField quantum(settings,
                              setting("cpu.quantum_ns", SettingKind::number, "10", "").in(1, 1e9));
    const ChoiceField<int> executor(settings, {{"blocks", 0}, {"stepping", 1}},
                                    setting("cpu.executor", SettingKind::choice, "blocks", ""));
    const IntegerField lines(settings,
                             setting("cpu.lines", SettingKind::integer, "3", "").in(0, 32));
    const FlagField golden(settings, setting("run.golden", SettingKind::flag, "false", ""));
    const TextField until(settings, setting("run.until_uart", SettingKind::text, "", ""));
    const TextField log(settings, setting("run.log", SettingKind::output, "", ""));
    const auto error = settings.read_file(file.write(Damage(number).text(whole)));
    if (!error) {
      tally.accept();
      EXPECT_GE(quantum(), 1) << number;
      EXPECT_LE(lines(), 32) << number;
      EXPECT_EQ(executor.text(), executor() == 0 ? "blocks" : "stepping") << number;
      EXPECT_EQ(golden.text(), golden() ? "true" : "false") << number;
      continue;
    }
    tally.refuse(error->text, file.path(), number);
  }
}

TEST(FileFuzz, DamagedCoverage) {
  std::string whole =
      "TN:capsoc_1\nSF:src/main.c\nFN:3,main\nFNDA:1,main\nFNF:1\nFNH:1\nBRDA:4,0,0,16\n"
      "BRDA:4,0,1,-\nBRF:2\nBRH:1\nDA:3,1\nDA:4,17\nLF:2\nLH:2\nend_of_record\n";
  const uint64_t count = file_count(4000);
  Tally tally("coverage", count);
  for (uint64_t number = 0; number < count; ++number) {
    const auto read = trace::parse_lcov("f.info", Damage(number).text(whole));
    if (!read) {
      tally.refuse(read.error(), "f.info", number);
      continue;
    }
    tally.accept();
    ASSERT_TRUE(trace::parse_lcov("f.info", trace::to_lcov(read.value()))) << number;
  }
}

TEST(FileFuzz, DamagedPinScripts) {
  const uint64_t count = file_count(4000);
  Tally tally("pin scripts", count);
  for (uint64_t number = 0; number < count; ++number) {
    const auto events = serial::parse_pin_script(
        "f.txt", Damage(number).text("# pins\n0.5 3 1\n0.5 4 0\n1e0 15 1  # last\n"), 16);
    if (!events) {
      tally.refuse(events.error(), "f.txt", number);
      continue;
    }
    tally.accept();
    for (const serial::PinEvent& event : events.value()) ASSERT_LT(event.pin, 16U) << number;
  }
}

TEST(FileFuzz, DamagedParameters) {
  std::string whole = "{\"parameters\": {";
  for (const char* name : {"a1", "a2", "b1", "b2", "beta", "phi"})
    whole += fmt::format("{}\"{}\": {{\"word\": 1073741824, \"value\": {}}}",
                         whole.back() == '{' ? "" : ", ", name,
                         std::string(name).size() == 2 ? "0.5" : "1.5707963267948966");
  whole += "}, \"method\": \"lm\", \"samples\": 1000}";
  const uint64_t count = file_count(4000);
  Tally tally("JSON parameters", count);
  const TemporaryFile file(".json");
  for (uint64_t number = 0; number < count; ++number) {
    const auto words = metrics::read_parameters(file.write(Damage(number).text(whole)));
    if (words)
      tally.accept();
    else
      tally.refuse(words.error(), file.path(), number);
  }
}

}  // namespace
}  // namespace capsoc::test
