#include "trace/save_file.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

namespace capsoc::trace {
namespace {

// Flags of a trace in GTKWave's save files (its enum TraceEntFlagBits), by bit.
constexpr uint32_t hexadecimal = 1U << 1U, binary = 1U << 3U, right = 1U << 5U, blank = 1U << 9U,
                   is_signed = 1U << 10U, ascii = 1U << 11U, analog_step = 1U << 15U,
                   analog_more = 1U << 17U, group_begin = 1U << 23U, group_end = 1U << 24U;

uint32_t flags_of(SaveText::Radix radix) {
  switch (radix) {
    case SaveText::Radix::binary:
      return binary | right;
    case SaveText::Radix::hexadecimal:
      return hexadecimal | right;
    case SaveText::Radix::ascii:
      return ascii | right;
    case SaveText::Radix::real:
      return is_signed | right;
  }
  return right;
}

std::string shown(uint32_t flags, const std::string& signal) {
  return fmt::format("@{:x}\n{}\n", flags, signal);
}

}  // namespace

std::string save_file(const std::string& waves) {
  return std::filesystem::path(waves).replace_extension(".gtkw").string();
}

SaveText::SaveText(const std::string& waves)
    : text_(fmt::format("[dumpfile] \"{}\"\n[size] 1400 900\n[sst_expanded] 1\n",
                        std::filesystem::path(waves).filename().string())) {}

void SaveText::begin_group(const std::string& name) {
  text_ += fmt::format("@{:x}\n-{}\n", blank | group_begin, name);
}

void SaveText::end_group(const std::string& name) {
  text_ += fmt::format("@{:x}\n-{}\n", blank | group_end, name);
}

void SaveText::add(Radix radix, const std::string& path) {
  text_ += shown(flags_of(radix), path);
}

void SaveText::add_curve(Radix radix, const std::string& path) {
  text_ += shown(flags_of(radix) | analog_step, path);
  text_ += fmt::format("@{:x}\n-\n-\n", analog_more);
}

void SaveText::show_around(uint64_t time, uint64_t units) {
  constexpr double pixels = 1000;  // of the waves' part of a window of this size
  text_ += fmt::format("[timestart] {}\n", time > units / 2 ? time - units / 2 : 0);
  // Zoom (a power of two), the marker, and the 26 named ones, which are nowhere.
  text_ += fmt::format("*{:.2f} {}", std::log2(pixels / static_cast<double>(units)), time);
  for (int named = 0; named < 26; ++named) text_ += " -1";
  text_ += '\n';
}

}  // namespace capsoc::trace
