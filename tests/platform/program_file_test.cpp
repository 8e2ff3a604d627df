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
  EXPECT_NE(load_hex(path).error().find(":6: the line stands behind"), std::string::npos);
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
  }
  EXPECT_GT(refused, 80'000U);
}

}  // namespace
}  // namespace capsoc::loader
