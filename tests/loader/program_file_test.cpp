#include "loader/program_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <random>

namespace capsoc::loader {
namespace {

class ProgramFile : public testing::Test {
 protected:
  std::string path = testing::TempDir() + std::to_string(getpid()) + "program_file_test.hex";
  void write(const std::string& text) { std::ofstream(path, std::ios::binary) << text; }
  ~ProgramFile() override { std::remove(path.c_str()); }
};

const std::string good =
    ":020000042000DA\r\n:0400100001020304E2\r\n:02001400AABB85\n:04000005000000D522\n:00000001FF\n";

TEST_F(ProgramFile, HexGivesSegmentsAtTheirAddresses) {
  write(good);
  const auto image = load_program(path);
  ASSERT_TRUE(image) << image.error();
  ASSERT_EQ(image.value().segments.size(), 1U);
  EXPECT_EQ(image.value().segments[0].address, 0x20000010U);
  EXPECT_EQ(image.value().segments[0].bytes, (std::vector<uint8_t>{1, 2, 3, 4, 0xAA, 0xBB}));
  EXPECT_EQ(image.value().entry, 0xD5U);
}

TEST_F(ProgramFile, WrongHexNamesItsLine) {
  write(":0400100001020304E3\n:00000001FF\n");
  EXPECT_NE(load_hex(path).error().find(":1: the line has a wrong checksum"), std::string::npos);
  write(":0400100001020304E2\n");
  EXPECT_NE(load_hex(path).error().find("no end record"), std::string::npos);
  write(good + ":0400100001020304E2\n");
  EXPECT_NE(load_hex(path).error().find(":6: the line stands after"), std::string::npos);
}

/// As arm-none-eabi-objcopy -O srec writes them.
const std::string good_srec =
    "S00B0000612E737265630000B8\r\nS1051234AABB4F\nS3092000001001020304BC\nS206400000112286\n"
    "S5030003F9\nS705000000D525\n";

TEST_F(ProgramFile, SRecordsGiveSegmentsAtTheirAddresses) {
  write("\xEF\xBB\xBF" + good_srec);
  const auto image = load_program(path);
  ASSERT_TRUE(image) << image.error();
  const std::vector<Segment>& segments = image.value().segments;
  ASSERT_EQ(segments.size(), 3U);
  EXPECT_EQ(segments[0].address, 0x1234U);
  EXPECT_EQ(segments[1].address, 0x20000010U);
  EXPECT_EQ(segments[2].address, 0x400000U);
  EXPECT_EQ(segments[1].bytes, (std::vector<uint8_t>{1, 2, 3, 4}));
  EXPECT_EQ(image.value().entry, 0xD5U);
}

TEST_F(ProgramFile, WrongSRecordsNameTheirLine) {
  const auto refusal = [this](const std::string& text) {
    write(text);
    const auto image = load_program(path);
    return image ? "" : image.error();
  };
  const std::string data = "S1051234AABB4F\n", end = "S9030000FC\n";
  ASSERT_EQ(refusal(data + end), "");
  for (const auto& [text, what] : std::vector<std::pair<std::string, std::string>>{
           {"S1051234AABB50\n" + end, ":1: the line has a wrong checksum"},
           {"S1061234AABB4E\n" + end, ":1: the line has a wrong length"},
           {"S1051234AABB4\n" + end, ":1: the line is no record of whole bytes"},
           {"S1051234AAGB4F\n" + end, ":1: the line is no record of whole bytes"},
           {"S4051234AABB4F\n" + end, ":1: the line has a type that S-records do not know"},
           {"S10200FD\n" + end, ":1: the line is too short for its address"},
           {data + "S5030002FA\n" + end, ":2: the line counts other data records"},
           {data + "S90500001234B4\n", ":2: the line has data, and its type has none"},
           {data + end + data, ":3: the line stands after the end record"},
           {data + ":00000001FF\n", ":2: the line does not begin with S and a type"},
           {"S309FFFFFFFE01020304F1\n" + end, ":1: the line leaves the address space"},
           {data, "no end record"},
           {end, "nothing to load"}}) {
    const std::string said = refusal(text);
    EXPECT_NE(said.find(what), std::string::npos) << said;
    EXPECT_EQ(said.rfind(path, 0), 0U) << said;
  }
}

TEST_F(ProgramFile, RawBytesGoWhereTheyAreSent) {
  write("abc");
  const auto image = load_at(path + "@0x21000000");
  ASSERT_TRUE(image) << image.error();
  EXPECT_EQ(image.value().segments[0].address, 0x21000000U);
  EXPECT_EQ(image.value().segments[0].bytes.size(), 3U);
  for (const char* wrong : {"@", "@x", "@-1", "@0x1ffffffff", "@0xfffffffe", "@12k"})
    EXPECT_FALSE(load_at(path + wrong)) << wrong;
  EXPECT_FALSE(load_at("nowhere@0"));
}

TEST_F(ProgramFile, DamagedHexIsAnErrorOrLoadsButNeverCrashes) {
  std::mt19937 random(20191108);
  unsigned refused = 0;
  for (int round = 0; round < 100'000; ++round) {
    std::string damaged = good;
    for (int i = 0; i < 3; ++i) damaged[random() % damaged.size()] = static_cast<char>(random());
    refused += parse_hex("damaged.hex", damaged) ? 0 : 1;
    parse_srec("damaged.srec", damaged);
  }
  EXPECT_GT(refused, 80'000U);
}

}  // namespace
}  // namespace capsoc::loader
