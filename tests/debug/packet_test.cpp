// The packet layer of the GDB server.
#include "debug/packet.h"

#include <gtest/gtest.h>

namespace capsoc::debug {
namespace {

using Kind = Arrival::Kind;

TEST(Packet, IsFramedWithItsChecksumAndEscapes) {
  EXPECT_EQ(frame("OK"), "$OK#9a");
  EXPECT_EQ(frame(""), "$#00");
  EXPECT_EQ(frame("a#b"),
            "$a}\x03"
            "b#43");
}

TEST(Packet, EveryByteSurvivesFramingAndReading) {
  std::string all;
  for (int c = 0; c < 256; ++c) all += static_cast<char>(c);
  PacketReader reader;
  const auto arrivals = reader.feed(frame(all));
  ASSERT_EQ(arrivals.size(), 1U);
  EXPECT_EQ(arrivals[0].kind, Kind::packet);
  EXPECT_EQ(arrivals[0].payload, all);
}

TEST(Packet, ArrivesInPiecesOfAnySize) {
  PacketReader reader;
  std::vector<Arrival> arrivals;
  for (const char c : "+" + frame("m20000000,4") + "\x03-" + frame("?"))
    for (const Arrival& a : reader.feed({&c, 1})) arrivals.push_back(a);
  ASSERT_EQ(arrivals.size(), 5U);
  EXPECT_EQ(arrivals[0].kind, Kind::ack);
  EXPECT_EQ(arrivals[1].payload, "m20000000,4");
  EXPECT_EQ(arrivals[2].kind, Kind::interrupt);
  EXPECT_EQ(arrivals[3].kind, Kind::nak);
  EXPECT_EQ(arrivals[4].payload, "?");
}

TEST(Packet, WithAWrongChecksumIsDamagedUnlessNobodyLooks) {
  PacketReader reader;
  EXPECT_EQ(reader.feed("$?#40").at(0).kind, Kind::damaged);
  EXPECT_EQ(reader.feed("$?#xy").at(0).kind, Kind::damaged);
  reader.ignore_checksums();
  EXPECT_EQ(reader.feed("$?#40").at(0).payload, "?");
}

TEST(Packet, ThatBeginsInsideAnotherReplacesIt) {
  PacketReader reader;
  const auto arrivals = reader.feed("$m2000$?#3f");
  ASSERT_EQ(arrivals.size(), 2U);
  EXPECT_EQ(arrivals[0].kind, Kind::damaged);
  EXPECT_EQ(arrivals[1].payload, "?");
}

TEST(Packet, LongerThanAnnouncedIsDamagedAndTheNextOneIsNot) {
  PacketReader reader;
  const std::string longest(largest_packet, 'a');
  EXPECT_EQ(reader.feed(frame(longest)).at(0).kind, Kind::packet);
  EXPECT_EQ(reader.feed(frame(longest + "a")).at(0).kind, Kind::damaged);
  EXPECT_EQ(reader.feed("$?#3f").at(0).kind, Kind::packet);
}

TEST(Packet, RunLengthsAreExpandedAndMalformedOnesRefused) {
  EXPECT_EQ(unescape("0* "), "0000");
  EXPECT_EQ(unescape("* "), std::nullopt);
  EXPECT_EQ(unescape("0*"), std::nullopt);
  EXPECT_EQ(unescape("a}"), std::nullopt);
  std::string bomb = "0";
  for (int i = 0; i < 1000; ++i) bomb += "*~";
  EXPECT_EQ(unescape(bomb), std::nullopt);
}

TEST(Hex, IsReadStrictly) {
  EXPECT_EQ(to_hex(std::string("\x00\xff\x1a", 3)), "00ff1a");
  EXPECT_EQ(from_hex("00fF1A"), std::string("\x00\xff\x1a", 3));
  EXPECT_EQ(from_hex("0"), std::nullopt);
  EXPECT_EQ(from_hex("0g"), std::nullopt);
  std::string_view text = "20000000,4";
  EXPECT_EQ(take_number(text), 0x20000000U);
  EXPECT_EQ(text, ",4");
  text = "123456789";
  EXPECT_EQ(take_number(text), std::nullopt);
}

}  // namespace
}  // namespace capsoc::debug
