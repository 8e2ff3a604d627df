// Damaged files of every kind that a user hands to the program: whatever the bytes, reading ends
// with a value or with one sentence that names the file. The numbers are the seeds, so a failure
// repeats. CAPSOC_FUZZ_FILES sets how many of each kind; a build of the preset `sanitize` sees
// reads outside them, too.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/setting_fields.h"
#include "damage.h"
#include "loader/elf_image.h"
#include "loader/program_file.h"
#include "loader/program_settings.h"
#include "metrics/parameter_file.h"
#include "sensor/described_source.h"
#include "sensor/mat_file.h"
#include "sensor/recorded_source.h"
#include "sensor/sds_file.h"
#include "sensor/toml_reader.h"
#include "sensor/wav_file.h"
#include "serial/pin_line.h"
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

/// Text in several dialects, so that what guesses them meets damage, too.
TEST(FileFuzz, DamagedDialects) {
  std::string rows[4] = {"sep=;\nt;u;v\n", "Model,X\nTIME,\"CH1\",CH2,angle_rad\n(ms),(V),(V),\n",
                         "# sin cos\n", ""};
  for (int k = 0; k < 60; ++k) {
    const double u = 0.5 * std::sin(0.1 * k), v = 0.5 * std::cos(0.1 * k);
    rows[0] += fmt::format("{};0,{:06.0f};{}0,{:06.0f}\n", k, 1e6 * std::fabs(u), v < 0 ? "-" : "",
                           1e6 * std::fabs(v));
    rows[1] += fmt::format("{},{},\"{}\",{},\n", k, u, v, 0.1 * k);
    rows[2] += fmt::format("  {}\t {}\n", u, v);
    rows[3] += fmt::format("{},{},{}\r", k, 2048 + std::round(1000 * u), std::round(1000 * v));
  }
  const uint64_t count = file_count(8000);
  Tally tally("dialects", count);
  for (uint64_t number = 0; number < count; ++number) {
    sensor::RecordingOptions options;
    options.automatic_scale = number % 3 != 0;
    if (number % 7 == 0) options.columns = "2,3";
    auto result = sensor::read_recording(Damage(number).text(rows[number % 4]), "f.csv", options);
    if (!result) {
      tally.refuse(result.error(), result.error()[0] == '-' ? "--" : "f.csv", number);
      continue;
    }
    tally.accept();
    for (uint64_t k = 0; const auto value = result.value().sample(k, 0); ++k)
      ASSERT_TRUE(std::isfinite(value->u) && std::isfinite(value->v)) << number;
  }
}

template <typename Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// What a table of a damaged binary file gives.
void judge_table(const Result<sensor::ColumnTable>& table, uint64_t number, Tally& tally) {
  if (!table) {
    tally.refuse(table.error(), "f.bin", number);
    return;
  }
  auto source = sensor::read_table(table.value(), "f.bin", {});
  if (!source) {
    tally.refuse(source.error(), "f.bin", number);
    return;
  }
  tally.accept();
  ASSERT_TRUE(std::isfinite(source.value().sample(0, 0)->u)) << number;
}

TEST(FileFuzz, DamagedWav) {
  std::string whole = "RIFF....WAVEfmt ";
  append(whole, uint32_t{16});
  for (const uint16_t half : {1, 2, 250, 0, 1000, 0, 4, 16}) append(whole, half);
  whole += "data";
  append(whole, uint32_t{800});
  for (int k = 0; k < 200; ++k) {
    append(whole, static_cast<int16_t>(10000 * std::sin(0.1 * k)));
    append(whole, static_cast<int16_t>(10000 * std::cos(0.1 * k)));
  }
  const uint64_t count = file_count(8000);
  Tally tally("WAV", count);
  for (uint64_t number = 0; number < count; ++number)
    judge_table(sensor::read_wav(Damage(number).binary(whole, 48, 40), "f.bin"), number, tally);
}

/// A variable of a MAT file, packed or not.
std::string mat_vector(const std::string& name, const std::vector<double>& values, bool packed) {
  std::string body;
  for (const uint32_t word : {6U, 8U, 6U, 0U, 5U, 8U, static_cast<uint32_t>(values.size()), 1U})
    append(body, word);
  append(body, 0x10001U);
  body += name + std::string(3, '\0');
  append(body, uint32_t{9});
  append(body, static_cast<uint32_t>(8 * values.size()));
  for (const double value : values) append(body, value);
  std::string element;
  append(element, uint32_t{14});
  append(element, static_cast<uint32_t>(body.size()));
  element += body;
  if (!packed) return element;
  uLongf size = compressBound(element.size());
  std::string deflated(size, '\0');
  compress(reinterpret_cast<Bytef*>(deflated.data()), &size,
           reinterpret_cast<const Bytef*>(element.data()), element.size());
  deflated.resize(size);
  std::string out;
  append(out, uint32_t{15});
  append(out, static_cast<uint32_t>(deflated.size()));
  return out + deflated;
}

TEST(FileFuzz, DamagedMat) {
  std::vector<double> u, v;
  for (int k = 0; k < 60; ++k) {
    u.push_back(0.5 * std::sin(0.1 * k));
    v.push_back(0.5 * std::cos(0.1 * k));
  }
  std::string head = "MATLAB 5.0 MAT-file";
  head.resize(124, ' ');
  head += std::string("\0\1IM", 4);
  const uint64_t count = file_count(8000);
  Tally tally("MAT", count);
  for (uint64_t number = 0; number < count; ++number) {
    const bool packed = number % 2 != 0;
    // Packed bytes are damaged before they are packed, or nothing would get past the checksum.
    std::string one = mat_vector("u", u, false), other = mat_vector("v", v, packed);
    if (number % 4 != 3) {
      one = Damage(number).binary(one, 64, 16);
      if (number % 4 == 1) {
        uLongf size = compressBound(one.size());
        std::string deflated(size, '\0');
        compress(reinterpret_cast<Bytef*>(deflated.data()), &size,
                 reinterpret_cast<const Bytef*>(one.data()), one.size());
        deflated.resize(size);
        one.clear();
        append(one, uint32_t{15});
        append(one, static_cast<uint32_t>(size));
        one += deflated;
      }
      judge_table(sensor::read_mat(head + one + other, "f.bin"), number, tally);
    } else {
      judge_table(sensor::read_mat(Damage(number).binary(head + one + other, 200, 100), "f.bin"),
                  number, tally);
    }
  }
}

TEST(FileFuzz, DamagedSds) {
  const std::string metadata =
      "sds:\n  name: x\n  frequency: 250\n  tick-frequency: 1000\n  content:\n  - value: u\n"
      "    type: int16_t\n    scale: 0.00003\n  - value: v\n    type: int16_t\n    dim-x: 1\n"
      "    scale: 0.00003\n    offset: 0.1\n";
  std::string whole;
  for (uint32_t block = 0; block < 8; ++block) {
    append(whole, block * 100);
    append(whole, uint32_t{40});
    for (int k = 0; k < 10; ++k) {
      append(whole, static_cast<int16_t>(10000 * std::sin(0.1 * k)));
      append(whole, static_cast<int16_t>(10000 * std::cos(0.1 * k)));
    }
  }
  const uint64_t count = file_count(8000);
  Tally tally("SDS", count);
  for (uint64_t number = 0; number < count; ++number) {
    const bool text = number % 2 != 0;
    const auto described =
        sensor::read_sds_metadata(text ? Damage(number).text(metadata) : metadata, "f.bin");
    if (!described) {
      tally.refuse(described.error(), "f.bin", number);
      continue;
    }
    judge_table(sensor::read_sds(text ? whole : Damage(number).binary(whole, 60, 50),
                                 described.value(), "f.bin"),
                number, tally);
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
