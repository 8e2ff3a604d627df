// Random packets: valid ones, damaged ones, and bytes of any kind, in pieces of any size. 100,000
// of them; CAPSOC_FUZZ_PACKETS sets another number.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <random>

#include "debug/client.h"
#include "fake_target.h"

namespace capsoc::debug::test {
namespace {

class Packets {
 public:
  explicit Packets(uint64_t seed) : random_(seed) {}

  uint32_t below(uint32_t n) { return static_cast<uint32_t>(random_() % n); }

  /// Bytes for the line.
  std::string next() {
    if (below(20) == 0) return noise(below(40));
    std::string payload = below(10) == 0 ? noise(below(60)) : sentence();
    if (below(4) == 0) mutate(payload);
    std::string line = frame(payload);
    if (below(10) == 0) mutate(line);
    if (below(50) == 0) line = std::string("\x03") + line;
    return line;
  }

 private:
  std::string noise(uint32_t length) {
    std::string bytes;
    for (uint32_t i = 0; i < length; ++i) bytes += static_cast<char>(below(256));
    return bytes;
  }
  std::string number() {
    char text[16];
    static constexpr uint32_t odd[] = {0,          1,          4,          FakeTarget::base,
                                       0x2000FFFF, 0xFFFFFFFF, 0x7FFFFFFF, 0x4000};
    const uint32_t value =
        below(2) == 0 ? odd[below(8)] : static_cast<uint32_t>(random_()) >> below(32);
    std::snprintf(text, sizeof text, "%x", value);
    return text;
  }
  std::string sentence() {
    static constexpr const char* starts[] = {"?",
                                             "g",
                                             "G",
                                             "p",
                                             "P",
                                             "m",
                                             "M",
                                             "X",
                                             "Z0,",
                                             "Z1,",
                                             "Z2,",
                                             "Z3,",
                                             "Z4,",
                                             "z0,",
                                             "z2,",
                                             "c",
                                             "s",
                                             "C05",
                                             "D",
                                             "k",
                                             "!",
                                             "R00",
                                             "Hg0",
                                             "T1",
                                             "vCont;c",
                                             "vCont;s:1",
                                             "vCont;r",
                                             "vCont?",
                                             "vRun;",
                                             "vKill;1",
                                             "vAttach;1",
                                             "vFlashErase:",
                                             "QStartNoAckMode",
                                             "qRcmd,",
                                             "qSupported:",
                                             "qXfer:features:read:target.xml:",
                                             "qXfer:memory-map:read::",
                                             "qMemoryRegionInfo:",
                                             "qXfer:threads:read::",
                                             "qCRC:",
                                             "qfThreadInfo",
                                             "qThreadExtraInfo,1",
                                             "qSymbol::"};
    std::string text = starts[below(sizeof starts / sizeof starts[0])];
    for (uint32_t parts = below(4); parts != 0; --parts) {
      text += number();
      text += ",:;=#"[below(4)];
    }
    if (below(3) == 0) text += to_hex(noise(below(90)));
    if (below(40) == 0) text += noise(below(2 * largest_packet));
    return text;
  }
  void mutate(std::string& text) {
    if (text.empty()) return;
    const uint32_t at = below(static_cast<uint32_t>(text.size()));
    switch (below(3)) {
      case 0:
        text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, 1 + below(8));
        break;
      default:
        text.insert(at, noise(1 + below(8)));
    }
  }
  std::mt19937_64 random_;
};

TEST(Fuzz, RandomPacketsAreAnsweredInTheProtocol) {
  const char* asked = std::getenv("CAPSOC_FUZZ_PACKETS");
  const long long count = asked != nullptr ? std::atoll(asked) : 100'000;
  Packets packets(20260801);
  FakeTarget target;
  uint64_t received = 0, damaged = 0, answers = 0;
  for (long long sent = 0; sent < count;) {
    Client client(target);
    PacketReader reader, theirs;
    theirs.ignore_checksums();
    const long long conversation = sent + 1 + packets.below(200);
    for (; sent < conversation && sent < count; ++sent) {
      std::string line = packets.next();
      while (!line.empty()) {
        const std::size_t cut = packets.below(4) != 0
                                    ? line.size()
                                    : 1 + packets.below(static_cast<uint32_t>(line.size()));
        for (const Arrival& arrival : reader.feed(line.substr(0, cut))) {
          received += arrival.kind == Arrival::Kind::packet ? 1 : 0;
          damaged += arrival.kind == Arrival::Kind::damaged ? 1 : 0;
          const Request request = client.handle(arrival);
          if (client.no_ack()) reader.ignore_checksums();
          if (request.kind == Request::Kind::resume) client.stopped({StopCause::Kind::step});
          for (const Arrival& answer : theirs.feed(client.take_output())) {
            ASSERT_NE(answer.kind, Arrival::Kind::damaged) << "answer to packet " << sent;
            ASSERT_NE(answer.kind, Arrival::Kind::interrupt);
            answers += answer.kind == Arrival::Kind::packet ? 1 : 0;
          }
        }
        line.erase(0, cut);
      }
    }
  }
  EXPECT_TRUE(target.points.empty()) << "every client took its own along";
  EXPECT_EQ(target.memory.size(), FakeTarget::size);
  std::printf("fuzz: %lld lines, %llu packets, %llu damaged, %llu answers\n", count,
              static_cast<unsigned long long>(received), static_cast<unsigned long long>(damaged),
              static_cast<unsigned long long>(answers));
  EXPECT_GT(received, static_cast<uint64_t>(count) / 2);
}

}  // namespace
}  // namespace capsoc::debug::test
