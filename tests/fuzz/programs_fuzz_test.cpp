// Damaged programs, asked for everything that symbols and debug information are read for: lines,
// functions, call stacks, profile, coverage. Whatever the bytes, there is an answer, or one
// sentence that names the file; what could not be read is said to be. CAPSOC_FUZZ_FILES sets how
// many, CAPSOC_FUZZ_FIRST the number of the first.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <systemc>
#include <vector>

#include "loader/elf_image.h"
#include "loader/place.h"
#include "loader/program_settings.h"
#include "loader/vector_table.h"
#include "program_damage.h"
#include "soc/soc.h"
#include "source/call_stack.h"
#include "tally.h"
#include "trace/call_tree.h"
#include "trace/coverage.h"
#include "trace/functions.h"
#include "trace/profile.h"

namespace capsoc::test {
namespace {

constexpr const char* program_name = "f.elf";

/// A core that runs a sound program from its memories; no device answers.
class Board : public armv7m::Bus {
 public:
  explicit Board(const loader::ElfImage& image) {
    core.map_memory(0, static_cast<uint32_t>(code_.size()), code_.data(), false, 0);
    core.map_memory(0x20000000, static_cast<uint32_t>(data_.size()), data_.data(), true, 0);
    for (const loader::Segment& segment : image.segments)
      if (segment.address + segment.bytes.size() <= code_.size())
        std::copy(segment.bytes.begin(), segment.bytes.end(), code_.begin() + segment.address);
  }
  bool read(uint32_t, unsigned, uint32_t&, unsigned&, armv7m::AccessKind) override { return false; }
  bool write(uint32_t, unsigned, uint32_t, unsigned&) override { return false; }

 private:
  std::vector<uint8_t> code_ = std::vector<uint8_t>(1U << 22U);
  std::vector<uint8_t> data_ = std::vector<uint8_t>(1U << 22U);

 public:
  armv7m::Core core{*this};
};

/// The call tree of what a core executes.
class Calls : public armv7m::Observer {
 public:
  Calls(armv7m::Core& core, trace::CallTree& tree) : core_(core), tree_(tree) {
    core_.add_observer(*this, true, false);
  }
  ~Calls() override { core_.remove_observer(*this); }
  Calls(const Calls&) = delete;
  Calls& operator=(const Calls&) = delete;
  void issued(const armv7m::Core& core, const armv7m::DecodedOp&) override { tree_.issued(core); }
  void retired(const armv7m::Core& core, const armv7m::DecodedOp& op) override {
    tree_.retired(core, op);
  }
  void entered(const armv7m::Core& core, unsigned exception, armv7m::Entry how,
               uint64_t since) override {
    tree_.entered(core, exception, how, since);
  }
  void returned(const armv7m::Core& core, unsigned exception) override {
    tree_.returned(core, exception);
  }
  void accessed(const armv7m::Core&, const armv7m::DirectAccess&) override {}
  void started(const armv7m::Core& core) override { tree_.started(core); }

 private:
  armv7m::Core& core_;
  trace::CallTree& tree_;
};

/// A program as the compiler made it, and what runs it.
struct Sound {
  explicit Sound(const std::string& path)
      : bytes(content(path)), image(loader::load_elf(path).value()), board(image) {
    for (const loader::Symbol& symbol : image.symbols)
      if (symbol.is_code && symbol.size > 8) addresses.push_back(symbol.address + symbol.size / 2);
    for (const uint32_t odd : {0U, 1U, 0x100U, 0x20000000U, 0xFFFFFFF0U, 0xFFFFFFFFU})
      addresses.push_back(odd);
  }
  std::string bytes;
  loader::ElfImage image;
  Board board;
  std::vector<uint32_t> addresses;
};

/// Everything that is asked of a program.
class Questions {
 public:
  Questions(soc::Soc& soc, Sound& sound, const loader::ElfImage& image, uint64_t number)
      : soc_(soc), sound_(sound), image_(image), number_(number), program_({&image}) {}

  /// How many sentences say what could not be read.
  std::size_t ask() {
    ask_for_symbols();
    ask_for_places();
    ask_for_profile();
    ask_for_coverage();
    const std::vector<std::string> gaps = program_.gaps();
    for (const std::string& gap : gaps) {
      EXPECT_EQ(gap.rfind(std::string(program_name) + ": ", 0), 0U) << number_ << ": " << gap;
      EXPECT_TRUE(is_plain(gap)) << number_ << ": " << gap;
    }
    return gaps.size();
  }

 private:
  void ask_for_symbols() {
    for (const std::string& name : program_.symbol_names()) {
      EXPECT_TRUE(is_plain(name)) << number_ << ": " << name;
      EXPECT_LE(name.size(), 1000U) << number_;
    }
    loader::ElfImage copy = image_;
    copy.overwrite("main", {1, 2, 3, 4});
    loader::find_vector_table({&image_}, "auto");
    loader::ProgramSettings::read(image_);
  }

  void ask_for_places() {
    const source::ReadWord read = [this](uint32_t address) -> std::optional<uint32_t> {
      uint32_t word = 0;
      if (!sound_.board.core.debug_read(address, &word, 4)) return std::nullopt;
      return word;
    };
    for (std::size_t i = number_ % step; i < sound_.addresses.size(); i += step) {
      const uint32_t address = sound_.addresses[i];
      for (const source::Place& place : program_.places_at(address))
        EXPECT_TRUE(is_plain(source::to_text(place))) << number_;
      armv7m::InterruptedRegisters registers;
      registers.r.fill(0x20000100);
      registers.r[14] = sound_.addresses[(i + 1) % sound_.addresses.size()];
      registers.r[15] = address;
      EXPECT_LE(program_.call_stack(registers, read, 40).frames.size(), 80U) << number_;
    }
  }

  void ask_for_profile() {
    trace::Functions functions;
    functions.add(image_);
    trace::CallTree tree(functions);
    armv7m::Core& core = sound_.board.core;
    const Calls calls(core, tree);
    core.reset();
    core.run(core.cycles() + 400);
    tree.finish(core);
    const std::string text =
        trace::to_callgrind(tree, functions, program_name,
                            [this](uint32_t address) { return program_.line_at(address); });
    EXPECT_NE(text.find("\ntotals: "), std::string::npos) << number_;
    EXPECT_FALSE(trace::to_folded(tree, functions).empty()) << number_;
    EXPECT_FALSE(trace::top_functions(tree, functions, 4).empty()) << number_;
  }

  /// Of a program that has not run yet, written twice: the second adds to the first.
  void ask_for_coverage() {
    const TemporaryFile file(".info");
    for (unsigned turn = 0; turn < 2; ++turn) {
      auto coverage = trace::Coverage::attach(soc_, program_, file.path());
      if (!coverage) {
        const std::string& said = coverage.error();
        EXPECT_TRUE(said.find("has no lines of source") != std::string::npos ||
                    said.find("is on this machine") != std::string::npos)
            << number_ << ": " << said;
        EXPECT_TRUE(is_plain(said)) << number_ << ": " << said;
        return;
      }
      const auto error = coverage.value()->finish();
      EXPECT_FALSE(error) << number_ << ": " << error->text;
    }
  }

  static constexpr std::size_t step = 4;  // of the addresses in one program
  soc::Soc& soc_;
  Sound& sound_;
  const loader::ElfImage& image_;
  uint64_t number_;
  source::Program program_;
};

TEST(ProgramFuzz, DamagedPrograms) {
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  soc::Soc soc("soc", {});
  std::vector<std::unique_ptr<Sound>> programs;
  for (const char* name : {"hello", "selfcal", "exceptions-O2"})
    programs.push_back(std::make_unique<Sound>(std::string(FIRMWARE "/") + name + ".elf"));
  ASSERT_FALSE(loader::place(programs.front()->image, soc));
  const char* from = std::getenv("CAPSOC_FUZZ_FIRST");
  const uint64_t first = from != nullptr ? std::strtoull(from, nullptr, 10) : 0;
  const uint64_t count = file_count(600);
  Tally tally("programs", count);
  uint64_t told = 0, slowest = 0;
  double longest = 0;
  for (uint64_t number = first; number < first + count; ++number) {
    const auto begin = std::chrono::steady_clock::now();
    Sound& sound = *programs[number % programs.size()];
    auto image = loader::parse_elf(program_name, ProgramDamage(number)(sound.bytes));
    if (image) {
      tally.accept();
      told += Questions(soc, sound, image.value(), number).ask() != 0 ? 1U : 0U;
    } else {
      tally.refuse(image.error(), program_name, number);
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    if (took.count() > longest) {
      longest = took.count();
      slowest = number;
    }
  }
  std::printf(
      "fuzz: programs: of %llu it is said what cannot be read; number %llu took longest, %.2f s\n",
      static_cast<unsigned long long>(told), static_cast<unsigned long long>(slowest), longest);
  EXPECT_GT(told, count / 20);
}

}  // namespace
}  // namespace capsoc::test

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
