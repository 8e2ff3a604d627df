// The file of a checkpoint, damaged and forged. CAPSOC_DAMAGED: how many damaged ones (2000).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "armv7m/core.h"
#include "checkpoint/checkpoint_file.h"
#include "coprocessor/coprocessor.h"

namespace capsoc::checkpoint {
namespace {

/// A processor with a little memory, and a coprocessor: parts with states of many kinds.
class Machine : public armv7m::Bus {
 public:
  Machine() {
    core.map_memory(0, sizeof memory, memory, true, 0);
    for (uint32_t i = 0; i < sizeof memory; i += 2) {
      memory[i] = static_cast<uint8_t>(i * 7);
      memory[i + 1] = 0x18;  // ADDS
    }
    memory[0] = memory[2] = memory[3] = memory[5] = memory[6] = memory[7] = 0;
    memory[1] = 0x10;  // SP 0x1000
    memory[4] = 9;     // entry 8
    core.reset();
  }
  bool read(uint32_t, unsigned, uint32_t& value, unsigned&, armv7m::AccessKind) override {
    value = 0;
    return true;
  }
  bool write(uint32_t, unsigned, uint32_t, unsigned&) override { return true; }

  void work() {
    core.run(core.cycles() + 300);
    for (int i = 0; i < 5; ++i) {
      coprocessor.submit(edge_ += 40, i << 20, -(i << 24), false);
      coprocessor.write(edge_ + 1, coprocessor::reg_ctrl,
                        coprocessor::ctrl_demod | coprocessor::ctrl_adc);
      edge_ += 2;
    }
  }
  std::vector<Part> parts() {
    return {{"cpu",
             [this](Archive& a) {
               a("core", core);
               if (a.loading()) core.memory_changed();
             }},
            {"ram", [this](Archive& a) { a.memory("bytes", memory, sizeof memory); }},
            {"coprocessor", [this](Archive& a) { coprocessor.visit(a); }}};
  }

  uint8_t memory[8192] = {};
  armv7m::Core core{*this};
  coprocessor::Coprocessor coprocessor{coprocessor::Options{}};

 private:
  uint64_t edge_ = 0;
};

std::string file_of(Machine& machine) {
  auto saved = save(12345, machine.parts());
  EXPECT_TRUE(saved) << saved.error();
  saved.value().identity = {{"program", "one"}, {"cpu.priority_bits", "3"}};
  return pack(saved.value());
}

/// Restored from a file, or the error.
std::optional<Error> restore(Machine& machine, const std::string& bytes) {
  const auto read = unpack(bytes, "f");
  if (!read) return Error{read.error()};
  return load(read.value(), machine.parts());
}

TEST(CheckpointFile, GivesBackWhatWasSaved) {
  Machine one, other;
  one.work();
  const std::string bytes = file_of(one);
  EXPECT_EQ(restore(other, bytes), std::nullopt);
  EXPECT_EQ(file_of(other), bytes);
  one.work();
  other.work();  // its edges begin earlier, its cycles do not
  EXPECT_EQ(one.core.cycles(), other.core.cycles());
  EXPECT_EQ(one.core.reg(0), other.core.reg(0));
}

TEST(CheckpointFile, SaysWhatIsWrong) {
  Machine machine;
  const std::string good = file_of(machine);
  const auto says = [&](const std::string& bytes) {
    const auto error = restore(machine, bytes);
    return error ? error->text : std::string("accepted");
  };
  EXPECT_EQ(says(good), "accepted");
  EXPECT_EQ(says(""), "f: is no checkpoint; give a file that capsoc run --save wrote");
  EXPECT_EQ(says("a,b,c\n1,2,3\n"),
            "f: is no checkpoint; give a file that capsoc run --save wrote");
  std::string other = good;
  other.replace(other.find(" 1 "), 3, " 7 ");
  EXPECT_EQ(says(other),
            "f: is a checkpoint of format 7, and this program has format 1; save it again");
  EXPECT_EQ(says(good.substr(0, 150)),
            "f: the checkpoint is damaged (it ends in its header); save it again, or run from the "
            "beginning");
  EXPECT_EQ(says(good.substr(0, good.size() - 3)),
            "f: the checkpoint is damaged (it ends in the part coprocessor); save it again, or run "
            "from the beginning");
  EXPECT_EQ(says(good + "x"),
            "f: the checkpoint is damaged (1 bytes too many); save it again, or run from the "
            "beginning");
  other = good;
  other[good.size() - 20] = static_cast<char>(other[good.size() - 20] ^ 1);
  EXPECT_EQ(says(other),
            "f: the checkpoint is damaged (the part coprocessor); save it again, or run from the "
            "beginning");
  other = good;
  other.replace(other.find("\"cpu\""), 5, "\"cpv\"");
  EXPECT_EQ(says(other),
            "f: the checkpoint is damaged (its header); save it again, or run from the beginning");
}

TEST(CheckpointFile, RefusesAnotherBoard) {
  Machine machine;
  auto saved = save(0, machine.parts());
  ASSERT_TRUE(saved);
  auto parts = machine.parts();
  parts[1].name = "flash";
  EXPECT_EQ(load(saved.value(), parts)->text,
            "flash is missing: the checkpoint is of another version of capsoc; save it again");
  parts = machine.parts();
  parts.pop_back();
  EXPECT_EQ(load(saved.value(), parts)->text,
            "coprocessor is not a part of this board: the checkpoint is of another version of "
            "capsoc; save it again");
  parts = machine.parts();
  uint32_t more = 0;
  parts[2].visit = [&](Archive& a) {
    machine.coprocessor.visit(a);
    a("more", more);
  };
  EXPECT_EQ(load(saved.value(), parts)->text, "coprocessor: more is missing");
  parts[2].visit = [&](Archive& a) { a("cycle", more); };
  EXPECT_EQ(load(saved.value(), parts)->text,
            "coprocessor has other values: the checkpoint is of another version of capsoc; save it "
            "again");
}

std::string damaged(const std::string& good, std::mt19937_64& random) {
  std::string bytes = good;
  const auto place = [&] { return static_cast<std::size_t>(random() % bytes.size()); };
  for (uint64_t faults = 1 + random() % 3; faults != 0 && !bytes.empty(); --faults) {
    switch (random() % 6) {
      case 0:
        bytes[place()] ^= static_cast<char>(1u << random() % 8);
        break;
      case 1:
        bytes.resize(place());
        break;
      case 2:
        bytes.erase(place(), 1 + random() % 9);
        break;
      case 3:
        bytes.insert(place(), 1 + random() % 9, static_cast<char>(random()));
        break;
      case 4:
        bytes[place()] = static_cast<char>(random());
        break;
      default: {
        const std::size_t from = place(), to = place();
        const std::string piece = bytes.substr(from, random() % 100);
        bytes.replace(to, std::min(piece.size(), bytes.size() - to), piece);
      }
    }
  }
  return bytes;
}

TEST(CheckpointFile, NoDamagedOneIsAccepted) {
  const char* wanted = std::getenv("CAPSOC_DAMAGED");
  const int count = wanted != nullptr ? std::atoi(wanted) : 2000;
  Machine machine;
  machine.work();
  const std::string good = file_of(machine);
  std::mt19937_64 random(1);
  int refused = 0, same = 0;
  for (int i = 0; i < count; ++i) {
    const std::string bytes = damaged(good, random);
    const auto error = restore(machine, bytes);
    if (!error) {
      EXPECT_TRUE(bytes == good) << "file " << i << " of seed 1";
      ++same;
    } else {
      ++refused;
    }
  }
  fmt::print("damaged checkpoints, seed 1: {} refused, {} not changed by the damage\n", refused,
             same);
  EXPECT_GT(refused, count * 9 / 10);
}

/// Wrong values with right checksums are refused, or give a state that can be run.
TEST(CheckpointFile, AForgedStateDoesNoHarm) {
  const char* wanted = std::getenv("CAPSOC_DAMAGED");
  const int count = (wanted != nullptr ? std::atoi(wanted) : 2000) / 10;
  Machine machine;
  machine.work();
  const auto saved = save(0, machine.parts());
  ASSERT_TRUE(saved);
  std::mt19937_64 random(2);
  int refused = 0, ran = 0;
  for (int i = 0; i < count; ++i) {
    Checkpoint forged = saved.value();
    std::string& bytes = forged.sections[random() % 2 * 2].bytes;  // not the program
    for (uint64_t faults = 1 + random() % 20; faults != 0; --faults)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    Machine into;
    if (load(forged, into.parts())) {
      ++refused;
      continue;
    }
    into.core.run(into.core.cycles() + 200);
    into.work();
    ++ran;
  }
  fmt::print("forged states, seed 2: {} refused, {} ran on\n", refused, ran);
  EXPECT_EQ(refused + ran, count);
  EXPECT_GT(refused, 0);
  EXPECT_GT(ran, 0);
}

}  // namespace
}  // namespace capsoc::checkpoint
