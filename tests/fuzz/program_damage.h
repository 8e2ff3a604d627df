// Damage to programs, by number and where it hurts: headers of sections, symbols, units of debug
// information, tables of abbreviations and lines.
#pragma once

#include <elf.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "damage.h"

namespace capsoc::test {

class ProgramDamage {
 public:
  explicit ProgramDamage(uint64_t number) : random_(number) {}

  /// A sound ELF file with one to four kinds of damage.
  std::string operator()(const std::string& whole) {
    bytes_ = whole;
    read_sections();
    for (uint64_t kinds = 1 + random_.below(4); kinds > 0; --kinds) add();
    if (random_.below(16) == 0) bytes_.resize(random_.below(bytes_.size()));
    return std::move(bytes_);
  }

 private:
  void read_sections() {
    Elf32_Ehdr header;
    std::memcpy(&header, bytes_.data(), sizeof header);
    headers_ = header.e_shoff;
    sections_.resize(header.e_shnum);
    std::memcpy(sections_.data(), bytes_.data() + headers_, sections_.size() * sizeof(Elf32_Shdr));
    const Elf32_Shdr& names = sections_[header.e_shstrndx];
    for (std::size_t i = 0; i < sections_.size(); ++i)
      if (std::string(bytes_.data() + names.sh_offset + sections_[i].sh_name).rfind(".debug_", 0) ==
              0 &&
          sections_[i].sh_size > 64)
        debug_.push_back(i);
  }

  void add() {
    switch (random_.below(14)) {
      case 0:
        return word(random_.below(sizeof(Elf32_Ehdr) / 4) * 4);
      case 1:
        return word(headers_ + random_.below(sections_.size() * sizeof(Elf32_Shdr) / 4) * 4);
      case 2:
        return swap_headers();
      case 3:
        return damage_symbols();
      case 4:  // the header of the section's first unit, table or entry
        return word(debug_section().sh_offset + random_.below(40));
      case 5:
        return fill(debug_section());
      case 6:
        return shift(debug_section());
      case 7:
        return copy_section();
      case 8:
        return refer(debug_section());
      default:
        return scatter(debug_section());
    }
  }

  const Elf32_Shdr& debug_section() { return sections_[debug_[random_.below(debug_.size())]]; }
  uint64_t place_in(const Elf32_Shdr& section) {
    return section.sh_offset + random_.below(section.sh_size);
  }

  /// A word of the file becomes an odd one, a near one, or the file's size.
  void word(uint64_t place) {
    static constexpr uint32_t odd[] = {0,          1,          0xFFFFFFFF, 0x7FFFFFFF, 0x80000000,
                                       0xFFFFFFF0, 0xFFFFFFFE, 0x1000,     0x00FFFFFF, 0x80808080};
    if (place + 4 > bytes_.size()) return;
    uint32_t value = 0;
    std::memcpy(&value, bytes_.data() + place, 4);
    switch (random_.below(4)) {
      case 0:
        value += static_cast<uint32_t>(random_.below(33)) - 16;
        break;
      case 1:
        value = static_cast<uint32_t>(bytes_.size() - random_.below(64));
        break;
      default:
        value = odd[random_.below(std::size(odd))];
    }
    std::memcpy(bytes_.data() + place, &value, 4);
  }

  /// Section headers change places, names and all.
  void swap_headers() {
    const uint64_t size = sizeof(Elf32_Shdr);
    const auto first = bytes_.begin() + static_cast<std::ptrdiff_t>(
                                            headers_ + size * random_.below(sections_.size()));
    const auto second = bytes_.begin() + static_cast<std::ptrdiff_t>(
                                             headers_ + size * random_.below(sections_.size()));
    if (first != second) std::swap_ranges(first, first + static_cast<std::ptrdiff_t>(size), second);
  }

  void damage_symbols() {
    for (const Elf32_Shdr& section : sections_)
      if (section.sh_type == SHT_SYMTAB || section.sh_type == SHT_STRTAB)
        for (uint64_t edits = random_.below(64); edits > 0; --edits) change_byte(place_in(section));
  }

  void change_byte(uint64_t place) {
    static constexpr unsigned char likely[] = {0, 1, 2, 4, 5, 0x7F, 0x80, 0xFF, 0x0A, 0x1B};
    bytes_[place] = static_cast<char>(
        random_.below(2) != 0 ? likely[random_.below(std::size(likely))] : random_.below(256));
  }

  void scatter(const Elf32_Shdr& section) {
    for (uint64_t edits = 1 + random_.below(16); edits > 0; --edits) change_byte(place_in(section));
  }

  /// A run of the same byte: numbers of variable length that do not end, among others.
  void fill(const Elf32_Shdr& section) {
    static constexpr char with[] = {'\0', '\xFF', '\x80', '\x7F', '\x01'};
    const uint64_t from = random_.below(section.sh_size);
    const uint64_t length = std::min<uint64_t>(1 + random_.below(64), section.sh_size - from);
    bytes_.replace(section.sh_offset + from, length, length, with[random_.below(std::size(with))]);
  }

  /// Everything after a place moves by a few bytes.
  void shift(const Elf32_Shdr& section) {
    const uint64_t from = random_.below(section.sh_size - 32), by = 1 + random_.below(8);
    const uint64_t length = section.sh_size - from - by;
    char* const place = bytes_.data() + section.sh_offset + from;
    if (random_.below(2) != 0)
      std::memmove(place, place + by, length);
    else
      std::memmove(place + by, place, length);
  }

  /// References and offsets that lead back, forth and round: words that could be places of a
  /// section become other places of it.
  void refer(const Elf32_Shdr& section) {
    for (uint64_t edits = 1 + random_.below(64); edits > 0; --edits) {
      const uint64_t place = section.sh_offset + random_.below(section.sh_size - 4);
      uint32_t value = 0;
      std::memcpy(&value, bytes_.data() + place, 4);
      if (value == 0 || value >= section.sh_size) continue;
      const auto other = static_cast<uint32_t>(
          random_.below(2) != 0 ? random_.below(section.sh_size) : value - random_.below(200));
      std::memcpy(bytes_.data() + place, &other, 4);
    }
  }

  /// One section's contents at another one's place.
  void copy_section() {
    const Elf32_Shdr &from = debug_section(), &to = debug_section();
    std::memmove(bytes_.data() + to.sh_offset, bytes_.data() + from.sh_offset,
                 std::min(from.sh_size, to.sh_size));
  }

  Damage random_;
  std::string bytes_;
  uint64_t headers_ = 0;
  std::vector<Elf32_Shdr> sections_;
  std::vector<std::size_t> debug_;
};

}  // namespace capsoc::test
