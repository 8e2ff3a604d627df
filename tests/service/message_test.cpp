// Messages as bytes: what was written is read, in whatever pieces it comes; damage is reported.
#include "service/message.h"

#include <gtest/gtest.h>

#include <random>

namespace capsoc::service {
namespace {

Message request(int id) {
  return {{{"jsonrpc", "2.0"}, {"id", id}, {"method", "memory.write"}, {"params", {{"x", 1.5}}}},
          {}};
}

TEST(Message, WhatWasWrittenIsReadInAnyPieces) {
  constexpr unsigned seed = 20261126;
  std::mt19937 random(seed);
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::vector<Message> sent;
  std::string bytes;
  for (int i = 0; i < 200; ++i) {
    Message message = request(i);
    for (unsigned frames = random() % 4; frames > 0; --frames)
      message.frames.push_back(std::string(random() % 3000, static_cast<char>(random())));
    bytes += to_bytes(message);
    sent.push_back(std::move(message));
  }
  MessageReader reader;
  std::size_t read = 0;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t size = std::min<std::size_t>(bytes.size() - at, random() % 5000);
    reader.feed(std::string_view(bytes).substr(at, size));
    at += size;
    while (auto incoming = reader.next()) {
      ASSERT_TRUE(incoming->message) << incoming->damage;
      ASSERT_LT(read, sent.size());
      EXPECT_EQ(incoming->message->body, sent[read].body);
      EXPECT_EQ(incoming->message->frames, sent[read].frames);
      ++read;
    }
  }
  EXPECT_EQ(read, sent.size());
}

struct Damage {
  const char* line;
  Code code;
  const char* says;
  bool last;
};

TEST(Message, DamageIsTold) {
  const std::string deep(100, '[');
  const Damage all[] = {
      {"{\"a\": }\n", Code::parse_error, "is no JSON", false},
      {"[1, 2]\n", Code::invalid_request, "is no object", false},
      {"{\"frames\": 3}\n", Code::parse_error, "byte counts", true},
      {"{\"frames\": [-1]}\n", Code::parse_error, "is no count", true},
      {"{\"frames\": [1000000000, 1000000000]}\n", Code::parse_error, "1 GiB", true},
  };
  for (const Damage& each : all) {
    SCOPED_TRACE(each.line);
    MessageReader reader;
    reader.feed(each.line);
    const auto incoming = reader.next();
    ASSERT_TRUE(incoming.has_value());
    EXPECT_FALSE(incoming->message);
    EXPECT_EQ(incoming->code, each.code);
    EXPECT_NE(incoming->damage.find(each.says), std::string::npos) << incoming->damage;
    EXPECT_EQ(incoming->last, each.last);
  }
  MessageReader reader;
  reader.feed("{\"a\": " + deep + "\n" + to_bytes(request(1)));
  EXPECT_NE(reader.next()->damage.find("deeper"), std::string::npos);
  EXPECT_TRUE(reader.next()->message) << "what follows a damaged line is read";
}

TEST(Message, TextsDoNotNest) {
  const auto nested = [](int levels, const std::string& inside) {
    const auto depth = static_cast<std::size_t>(levels - 1);
    MessageReader reader;
    reader.feed("{\"a\\\"[\": " + std::string(depth, '[') + inside + std::string(depth, ']') +
                "}\n");
    return reader.next()->damage;
  };
  const std::string text = '"' + std::string(100, '{') + "\\\\\"";
  EXPECT_EQ(nested(MessageReader::deepest, ""), "");
  EXPECT_EQ(nested(MessageReader::deepest, text), "");
  EXPECT_EQ(nested(MessageReader::deepest, "[], []").find("nested deeper"), 0U);
  EXPECT_EQ(nested(MessageReader::deepest + 1, "").find("nested deeper"), 0U);
}

TEST(Message, ALineWithoutAnEndIsRefusedInBoundedMemory) {
  MessageReader reader;
  const std::string part(1 << 20, 'x');
  std::optional<MessageReader::Incoming> incoming;
  for (int i = 0; i < 40 && !incoming; ++i) {
    reader.feed(part);
    incoming = reader.next();
  }
  ASSERT_TRUE(incoming.has_value());
  EXPECT_TRUE(incoming->last);
}

/// Nothing that a client sends does more than be refused.
TEST(Message, HostileBytesAreReadOrRefused) {
  constexpr unsigned seed = 7, rounds = 100'000;
  std::mt19937 random(seed);
  SCOPED_TRACE("seed " + std::to_string(seed));
  Message whole = request(1);
  whole.frames = {"abcd", std::string(20, '\0')};
  const std::string bytes = to_bytes(whole);
  unsigned whole_ones = 0, refused = 0;
  for (unsigned round = 0; round < rounds; ++round) {
    std::string damaged = bytes;
    for (unsigned changes = random() % 4; changes > 0; --changes) {
      const std::size_t at = random() % damaged.size();
      switch (random() % 4) {
        case 0:
          damaged[at] = static_cast<char>(random());
          break;
        case 1:
          damaged.erase(at, 1 + random() % 8);
          break;
        case 2:
          damaged.insert(at, 1 + random() % 3, "{}[]\",:0\n"[random() % 9]);
          break;
        default:
          damaged.insert(at, damaged.substr(random() % damaged.size(), random() % 20));
      }
      if (damaged.empty()) damaged = "\n";
    }
    MessageReader reader;
    reader.feed(damaged);
    for (auto incoming = reader.next(); incoming; incoming = reader.next()) {
      ++(incoming->message ? whole_ones : refused);
      if (incoming->last) break;
    }
  }
  EXPECT_GT(whole_ones, rounds / 10);
  EXPECT_GT(refused, rounds / 10);
}

}  // namespace
}  // namespace capsoc::service
