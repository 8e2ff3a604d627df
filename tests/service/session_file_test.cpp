// Recorded sessions as files: what was written is read, and no damage is.
#include "service/session_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "host/sha256.h"

namespace capsoc::service {
namespace {

SessionFile session() {
  SessionFile file;
  file.written_by = "0.1.0 (test)";
  file.settings = {{"coprocessor.arithmetic", "paper"}, {"program.rate", "250"}};
  file.files = {{"firmware.elf", "a.elf",
                 std::string("\x7f"
                             "ELF\0\n",
                             6)},
                {"sensor.file", "s.toml", "a1 = 0.5\n"}};
  const Position first{1000, 20, 10, 0}, last{2000, 40, 20, 1};
  file.inputs = {{first, "uart.send", {{"uart", 0}, {"bytes", "x"}}, {}},
                 {last, "adc.inject", {{"u", {{"frame", 0}}}}, {std::string(16, '\0')}}};
  file.marks = {{first, {{"cpu", host::sha256_of("1")}}}, {last, {{"cpu", host::sha256_of("2")}}}};
  file.uarts = {{3, host::sha256_of("abc")}};
  return file;
}

std::string error_of(const std::string& bytes) {
  const auto read = unpack_session(bytes, "s.session");
  return read ? "" : read.error();
}

/// The header changed, with the hash that it has then.
template <typename Change>
std::string forged(Change change) {
  const std::string bytes = pack(session());
  const std::size_t line = bytes.find('\n');
  const std::size_t size = std::stoul(bytes.substr(std::string("capsoc session 1 ").size()));
  Json header = Json::parse(bytes.substr(line + 1, size));
  change(header);
  const std::string text = header.dump();
  return "capsoc session 1 " + std::to_string(text.size()) + " " + host::sha256_of(text) + "\n" +
         text + bytes.substr(line + 1 + size);
}

TEST(SessionFile, GivesBackWhatWasRecorded) {
  const std::string bytes = pack(session());
  const auto read = unpack_session(bytes, "s.session");
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(pack(read.value()), bytes);
  EXPECT_EQ(read.value().files.at(0).bytes, session().files.at(0).bytes);
  EXPECT_EQ(read.value().inputs.at(1).frames.at(0).size(), 16U);
}

TEST(SessionFile, MayBeginInAState) {
  SessionFile file = session();
  file.state = std::string("a state\0", 8);
  const std::string bytes = pack(file);
  const auto read = unpack_session(bytes, "s.session");
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read.value().state, file.state);
  EXPECT_EQ(pack(read.value()), bytes);
  std::string damaged = bytes;
  damaged.at(bytes.find("a state")) = 'b';
  EXPECT_EQ(error_of(damaged), "s.session: is damaged; copy it again");
}

TEST(SessionFile, SaysWhatIsWrong) {
  const std::string good = pack(session());
  EXPECT_EQ(error_of("capsoc checkpoint 1"),
            "s.session: is no session; name a file that simulation.record wrote");
  std::string other = good;
  other.replace(std::string("capsoc session ").size(), 1, "2");
  EXPECT_EQ(error_of(other),
            "s.session: has version 2 of the format, this program reads 1; replay it with the "
            "program that recorded it");
  EXPECT_EQ(error_of(good.substr(0, good.size() - 1)), "s.session: is cut off; copy it again");
  EXPECT_EQ(error_of(good + "x"), "s.session: continues after its end; copy it again");
  const std::string damaged = "s.session: is damaged; copy it again";
  EXPECT_EQ(error_of(forged([](Json& header) { header.erase("marks"); })), damaged);
  EXPECT_EQ(error_of(forged([](Json& header) { header["marks"] = Json::array(); })), damaged);
  EXPECT_EQ(error_of(forged([](Json& header) { header["files"][0]["name"] = "../x"; })), damaged);
  EXPECT_EQ(error_of(forged([](Json& header) { header["files"][0]["name"] = ".x"; })), damaged);
  EXPECT_EQ(error_of(forged([](Json& header) { header["inputs"] = -1; })), damaged);
  EXPECT_EQ(error_of(forged([](Json& header) { header["settings"]["x"] = 1; })), damaged);
  EXPECT_EQ(
      error_of(forged([](Json& header) { std::swap(header["marks"][0], header["marks"][1]); })),
      damaged);
}

std::string damaged(std::string bytes, std::mt19937_64& random) {
  const auto place = [&] { return static_cast<std::size_t>(random() % bytes.size()); };
  for (uint64_t faults = 1 + random() % 3; faults != 0 && !bytes.empty(); --faults)
    switch (random() % 4) {
      case 0:
        bytes[place()] ^= static_cast<char>(1U << random() % 8);
        break;
      case 1:
        bytes.resize(place());
        break;
      case 2:
        bytes.erase(place(), 1 + random() % 9);
        break;
      default:
        bytes.insert(place(), 1 + random() % 9, static_cast<char>(random()));
    }
  return bytes;
}

TEST(SessionFile, NoDamagedOneIsAccepted) {
  constexpr int count = 50'000;
  const std::string good = pack(session());
  std::mt19937_64 random(1);
  int refused = 0;
  for (int i = 0; i < count; ++i) {
    const std::string bytes = damaged(good, random);
    if (unpack_session(bytes, "s"))
      EXPECT_TRUE(bytes == good) << "file " << i << " of seed 1";
    else
      ++refused;
  }
  EXPECT_GT(refused, count * 9 / 10);
}

/// Any value of the header by another one.
void forge(Json& value, std::mt19937_64& random) {
  static const Json others[] = {nullptr,        -1,  0, 1e300, UINT64_MAX, "", "x", Json::array(),
                                Json::object(), true};
  if ((value.is_object() || value.is_array()) && !value.empty() && random() % 8 != 0) {
    auto at = value.begin();
    std::advance(at, static_cast<std::ptrdiff_t>(random() % value.size()));
    return forge(*at, random);
  }
  value = others[random() % std::size(others)];
}

TEST(SessionFile, AForgedHeaderDoesNoHarm) {
  constexpr int count = 50'000;
  std::mt19937_64 random(2);
  int refused = 0;
  for (int i = 0; i < count; ++i)
    refused += error_of(forged([&](Json& header) { forge(header, random); })).empty() ? 0 : 1;
  EXPECT_GT(refused, count / 2);
}

}  // namespace
}  // namespace capsoc::service
