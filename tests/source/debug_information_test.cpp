// Lines and inlined functions of programs, held against addr2line of the cross compiler.
#include "source/debug_information.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>
#include <sstream>

#include "loader/elf_image.h"
#include "source/call_stack.h"

namespace capsoc::source {
namespace {

std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  std::array<char, 4096> part{};
  if (pipe != nullptr)
    for (std::size_t n = 0; (n = fread(part.data(), 1, part.size(), pipe.get())) > 0;)
      text.append(part.data(), n);
  return text;
}

std::string without_folder(const std::string& place) {
  const std::size_t slash = place.rfind('/');
  return slash == std::string::npos ? place : place.substr(slash + 1);
}

/// "function file:line; ..." the innermost first.
std::string ours(const DebugInformation& information, uint32_t address) {
  std::string text;
  for (const Place& place : information.places_at(address))
    text += fmt::format("{} {}; ", place.function, without_folder(to_text(place.at)));
  return text;
}

/// The same of each address, by addr2line.
std::vector<std::string> theirs(const std::string& elf, const std::vector<uint32_t>& addresses) {
  std::vector<std::string> all;
  constexpr std::size_t at_once = 500;
  for (std::size_t first = 0; first < addresses.size(); first += at_once) {
    std::string command = "arm-none-eabi-addr2line -a -f -i -e " + elf;
    for (std::size_t i = first; i < std::min(first + at_once, addresses.size()); ++i)
      command += fmt::format(" {:#x}", addresses[i]);
    std::istringstream lines(output_of(command));
    for (std::string line; std::getline(lines, line);) {
      if (line.rfind("0x", 0) == 0) {
        all.emplace_back();
        continue;
      }
      std::string place;
      std::getline(lines, place);
      if (const std::size_t note = place.find(" (disc"); note != std::string::npos)
        place.resize(note);
      all.back() += fmt::format("{} {}; ", line, without_folder(place));
    }
  }
  return all;
}

TEST(DebugInformation, NamesTheLinesThatAddr2lineNames) {
  for (const char* name : {"failures", "newlib", "selfcal", "threads-O3", "faults-O0"}) {
    const std::string elf = fmt::format(FIRMWARE "/{}.elf", name);
    const auto image = loader::load_elf(elf);
    ASSERT_TRUE(image) << image.error();
    const DebugInformation information(elf, *image.value().file);
    EXPECT_TRUE(information.has_lines() && information.has_frames());
    EXPECT_TRUE(information.complaints().empty());
    std::vector<uint32_t> addresses;
    for (const loader::Symbol& symbol : image.value().symbols)
      if (symbol.is_code)
        for (uint32_t offset = 0; offset < std::min(symbol.size, 0x400U); offset += 2)
          addresses.push_back(symbol.address + offset);
    const std::vector<std::string> expected = theirs(elf, addresses);
    ASSERT_EQ(expected.size(), addresses.size());
    unsigned compared = 0, different = 0;
    for (std::size_t i = 0; i < addresses.size(); ++i) {
      const std::string found = ours(information, addresses[i]);
      // Assembly has lines and no functions: which of several names is each one's choice.
      const bool assembly = expected[i].find(".S:") != std::string::npos;
      if (found.empty() || assembly || expected[i].find('?') != std::string::npos) continue;
      ++compared;
      if (found == expected[i]) continue;
      if (++different <= 5)
        ADD_FAILURE() << name << fmt::format(" {:#x}: ", addresses[i]) << found << "| "
                      << expected[i];
    }
    EXPECT_GT(compared, 1000U) << name;
    std::printf("source: %s: %u places compared, %u different\n", name, compared, different);
  }
}

TEST(DebugInformation, OfWhatIsNoElfIsEmpty) {
  for (const std::string& bytes : {std::string(), std::string("no ELF"), std::string(5000, '\0')}) {
    const DebugInformation information("a.bin", bytes);
    EXPECT_FALSE(information.has_lines());
    EXPECT_FALSE(information.has_frames());
    EXPECT_TRUE(information.places_at(0x100).empty());
    EXPECT_FALSE(information.line_at(0x100));
    EXPECT_TRUE(information.complaints().empty());
  }
}

TEST(DebugInformation, SaysWhatCannotBeRead) {
  const auto image = loader::load_elf(FIRMWARE "/hello.elf");
  ASSERT_TRUE(image);
  std::string bytes = *image.value().file;
  const std::string place = output_of(
      "arm-none-eabi-readelf -S -W " FIRMWARE
      "/hello.elf | awk '$2 == \".debug_abbrev\" || $3 == "
      "\".debug_abbrev\" {for (i = 1; i < NF; ++i) if ($i == \"PROGBITS\") print $(i+2)}'");
  const std::size_t offset = std::stoul(place, nullptr, 16);
  for (std::size_t i = 0; i < 64; ++i) bytes[offset + i] = '\xFF';
  const DebugInformation information("hello.elf", bytes);
  const std::vector<std::string> complaints = information.complaints();
  ASSERT_FALSE(complaints.empty());
  EXPECT_EQ(complaints.front().rfind("hello.elf: cannot read ", 0), 0U) << complaints.front();
}

}  // namespace
}  // namespace capsoc::source
