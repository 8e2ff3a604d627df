// Lines and inlined functions of programs, compared with addr2line of the cross compiler.
#include "source/debug_information.h"

#include <elf.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstring>
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
      ASSERT_EQ(ours(information, addresses[i]), found) << "asked again";
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

/// Replaces a section of an ELF file.
void put_section(std::string& elf, const std::string& name, const std::string& contents) {
  Elf32_Ehdr header;
  std::memcpy(&header, elf.data(), sizeof header);
  std::vector<Elf32_Shdr> sections(header.e_shnum);
  const std::size_t size = sections.size() * sizeof(Elf32_Shdr);
  std::memcpy(sections.data(), elf.data() + header.e_shoff, size);
  const uint32_t names = sections[header.e_shstrndx].sh_offset;
  for (Elf32_Shdr& section : sections) {
    if (elf.data() + names + section.sh_name != name) continue;
    section.sh_offset = static_cast<uint32_t>(elf.size());
    section.sh_size = static_cast<uint32_t>(contents.size());
  }
  std::memcpy(elf.data() + header.e_shoff, sections.data(), size);
  elf += contents;
}

std::string word(uint32_t value) {
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &value, 4);
  return bytes;
}

/// hello.elf with one unit of code from 0x100 to 0x200 that holds `entries`. 2: a block with all of
/// that code and its own entries; 3: a namespace that names its sibling by its place in the
/// section.
std::string with_entries(const std::string& entries) {
  const std::string abbreviations(
      "\x01\x11\x01\x11\x01\x12\x06\x00\x00"
      "\x02\x0B\x01\x11\x01\x12\x06\x00\x00"
      "\x03\x39\x01\x01\x13\x00\x00\x00",
      26);
  const std::string unit =
      std::string("\x04\x00\x00\x00\x00\x00\x04\x01", 8) + word(0x100) + word(0x100) + entries;
  std::string elf = *loader::load_elf(FIRMWARE "/hello.elf").value().file;
  put_section(elf, ".debug_abbrev", abbreviations);
  put_section(elf, ".debug_info", word(static_cast<uint32_t>(unit.size())) + unit);
  return elf;
}

std::string complaint_at(const std::string& elf, uint32_t address) {
  const DebugInformation information("f.elf", elf);
  information.places_at(address);
  for (const std::string& complaint : information.complaints())
    if (complaint.find("the functions at") != std::string::npos) return complaint;
  return "";
}

TEST(DebugInformation, EntriesNestedWithoutEndAreDamage) {
  constexpr std::size_t deep = 200000;
  std::string blocks;
  for (std::size_t i = 0; i < deep; ++i) blocks += "\x02" + word(0x100) + word(0x100);
  EXPECT_EQ(complaint_at(with_entries(blocks + std::string(deep + 1, '\0')), 0x180),
            "f.elf: cannot read the functions at 0x00000180: they are nested too deep");
  EXPECT_EQ(complaint_at(with_entries(blocks.substr(0, 9) + std::string(2, '\0')), 0x180), "");
}

/// Each namespace names its own first entry as its sibling: 40 in each other are 2^40 ways.
TEST(DebugInformation, EntriesThatAreReachedTwiceAreDamage) {
  std::string spaces;
  constexpr uint32_t first = 20, size = 5;  // after the unit's header and its own entry
  for (uint32_t i = 1; i <= 40; ++i) spaces += "\x03" + word(first + i * size);
  EXPECT_EQ(complaint_at(with_entries(spaces + std::string(42, '\0')), 0x180),
            "f.elf: cannot read the functions at 0x00000180: they do not end");
}

}  // namespace
}  // namespace capsoc::source
