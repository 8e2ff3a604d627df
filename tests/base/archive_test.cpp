#include "base/archive.h"

#include <gtest/gtest.h>

#include <limits>

namespace capsoc {
namespace {

enum class Colour : uint8_t { red, green, blue };

struct Point {
  int32_t x = 0, y = 0;
  void visit(Archive& archive) {
    archive("x", x);
    archive("y", y);
  }
};

struct Everything {
  bool flag = false;
  uint8_t byte = 0;
  int64_t big = 0;
  Int128 wide = 0;
  double real = 0;
  Colour colour = Colour::red;
  std::string text;
  std::array<uint16_t, 3> words{};
  std::vector<Point> points;
  std::deque<uint8_t> queue;
  std::optional<Point> maybe;
  std::vector<uint8_t> memory = std::vector<uint8_t>(5000);

  void visit(Archive& archive) {
    archive("flag", flag);
    archive("byte", byte);
    archive("big", big);
    archive("wide", wide);
    archive("real", real);
    archive.at_most("colour", colour, Colour::blue);
    archive("text", text);
    archive("words", words);
    archive("points", points);
    archive.sequence("queue", queue, 4);
    archive("maybe", maybe);
    archive.memory("memory", memory.data(), memory.size());
  }
};

Everything something() {
  Everything e;
  e.flag = true;
  e.byte = 200;
  e.big = std::numeric_limits<int64_t>::min();
  e.wide = Int128{-5} * (Int128{1} << 70);
  e.real = -0.1;
  e.colour = Colour::blue;
  e.text = "any text, even without an end";
  e.words = {1, 2, 65535};
  e.points = {{1, -1}, {2, -2}};
  e.queue = {7, 8, 9};
  e.maybe = Point{3, 4};
  e.memory[0] = 1;
  e.memory[2500] = 2;
  e.memory[4999] = 3;
  return e;
}

std::string saved(Everything& e) {
  StateWriter writer;
  e.visit(writer);
  EXPECT_TRUE(writer.ok()) << writer.problem();
  return writer.take();
}

/// What is different from `bytes`, "" if nothing is.
std::string difference(Everything& e, const std::string& bytes) {
  StateComparison comparison(bytes);
  e.visit(comparison);
  return comparison.difference();
}

TEST(Archive, LoadsWhatItSaved) {
  Everything before = something(), after;
  after.memory[1000] = 99;  // what is there goes
  after.points.resize(7);
  const std::string bytes = saved(before);
  StateReader reader(bytes);
  after.visit(reader);
  ASSERT_TRUE(reader.ok()) << reader.problem();
  EXPECT_TRUE(reader.at_end());
  EXPECT_EQ(difference(after, bytes), "");
  EXPECT_EQ(after.memory, before.memory);
  EXPECT_EQ(saved(after), bytes);
}

TEST(Archive, ZeroPagesTakeNoRoom) {
  Everything e = something();
  const std::size_t with_three_pages = saved(e).size();
  e.memory[2500] = 0;
  EXPECT_EQ(saved(e).size(), with_three_pages - 1024 - sizeof(uint32_t));
}

TEST(Archive, TheFirstDifferenceIsNamed) {
  Everything e = something();
  const std::string bytes = saved(e);
  e.points[1].y = -3;
  e.maybe->x = 0;
  EXPECT_EQ(difference(e, bytes), "points.1.y: fffffffe is fffffffd");
  e = something();
  e.memory[2500] = 4;
  EXPECT_EQ(difference(e, bytes), "memory at byte 448: 0000000200000000 is 0000000400000000");
  e = something();
  e.maybe.reset();
  EXPECT_EQ(difference(e, bytes), "maybe: 01 is 00");
}

TEST(Archive, AHashIsOfEveryValue) {
  const auto hash = [](Everything e) {
    StateHash archive;
    e.visit(archive);
    return archive.value();
  };
  const uint64_t same = hash(something());
  EXPECT_EQ(hash(something()), same);
  Everything other = something();
  other.wide += 1;
  EXPECT_NE(hash(other), same);
  other = something();
  other.memory[4999] = 4;
  EXPECT_NE(hash(other), same);
}

TEST(Archive, TheLayoutIsOfNamesAndWidthsNotOfValues) {
  StateWriter one, other, renamed;
  Everything e = something();
  e.visit(one);
  e.big = 5;
  e.visit(other);
  EXPECT_EQ(one.layout(), other.layout());
  uint8_t byte = 0;
  uint16_t word = 0;
  StateWriter narrow, wide;
  narrow("a", byte);
  wide("a", word);
  renamed("b", byte);
  EXPECT_NE(narrow.layout(), wide.layout());
  EXPECT_NE(narrow.layout(), renamed.layout());
}

TEST(Archive, RefusesWhatIsCutOff) {
  Everything e = something();
  const std::string bytes = saved(e);
  for (std::size_t size = 0; size < bytes.size(); size += size < 200 ? 1 : 97) {
    const std::string part = bytes.substr(0, size);
    StateReader reader(part);
    Everything into;
    into.visit(reader);
    EXPECT_FALSE(reader.ok()) << size;
  }
}

TEST(Archive, RefusesValuesThatCannotBe) {
  const auto load = [](auto visit, const std::string& bytes) {
    StateReader reader(bytes);
    visit(reader);
    return reader.problem();
  };
  bool flag = false;
  Colour colour = Colour::green;
  std::vector<uint8_t> queue = {1};
  EXPECT_EQ(load([&](Archive& a) { a("flag", flag); }, "\x02"), "flag is neither true nor false");
  EXPECT_EQ(load([&](Archive& a) { a.at_most("colour", colour, Colour::blue); }, "\x03"),
            "colour has a value that does not exist");
  EXPECT_EQ(colour, Colour::green);
  EXPECT_EQ(load([&](Archive& a) { a.sequence("queue", queue, 4); },
                 std::string("\x05\0\0\0\0\0\0\0", 8)),
            "queue has more elements than it can have");
  EXPECT_EQ(queue.size(), 1u);
  std::vector<uint8_t> memory(2048);
  EXPECT_EQ(load([&](Archive& a) { a.memory("ram", memory.data(), memory.size()); },
                 std::string("\x03\0\0\0", 4)),
            "ram has a page outside");
}

TEST(Archive, AfterARefusalNothingChanges) {
  const std::string nothing;
  StateReader reader(nothing);
  uint32_t number = 5;
  reader("number", number);
  EXPECT_EQ(reader.problem(), "number is missing");
  EXPECT_EQ(number, 5u);
  reader.refuse("is not looked at any more");
  EXPECT_EQ(reader.problem(), "number is missing");
}

}  // namespace
}  // namespace capsoc
