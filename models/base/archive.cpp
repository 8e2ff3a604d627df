#include "base/archive.h"

#include "base/touched_pages.h"

namespace capsoc {
namespace {

constexpr uint64_t fnv_prime = 0x100000001b3;

void mix(uint64_t& hash, const void* bytes, std::size_t size) {
  const auto* each = static_cast<const unsigned char*>(bytes);
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ each[i]) * fnv_prime;
}

std::string in_hexadecimal(const void* bytes, std::size_t size) {
  static constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (std::size_t i = size; i-- > 0;) {
    const unsigned byte = static_cast<const unsigned char*>(bytes)[i];
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

/// Unit of memory(): less is not worth its number.
constexpr std::size_t page_size = 1024;

bool is_zero(const uint8_t* bytes, std::size_t size) {
  return bytes[0] == 0 && std::memcmp(bytes, bytes + 1, size - 1) == 0;
}

}  // namespace

void Archive::note(const char* name) {
  mix(layout_, name, std::strlen(name) + 1);
}

void Archive::note_width(std::size_t size) {
  const auto width = static_cast<unsigned char>(size);
  mix(layout_, &width, 1);
}

std::string Archive::path() const {
  std::string text;
  for (const Step& step : path_) {
    if (!text.empty()) text += '.';
    text += step.name != nullptr ? step.name : std::to_string(step.index);
  }
  return text;
}

void Archive::refuse(const std::string& sentence) {
  if (problem_.empty()) problem_ = path_.empty() ? sentence : path() + " " + sentence;
}

void Archive::visit_text(std::string& text) {
  uint64_t size = text.size();
  visit_number(size);
  if (!ok()) return;
  if (size > longest_sequence) return refuse("is longer than it can be");
  text.resize(size);
  note_width(1);
  if (size != 0) raw(text.data(), size);
}

// Pages that are not zero, each after its number, in order; then the number after the last one.
void Archive::memory(const char* name, uint8_t* bytes, std::size_t size) {
  const Scope scope(*this, name);
  const auto pages = static_cast<uint32_t>((size + page_size - 1) / page_size);
  const auto length = [&](uint32_t page) {
    return std::min(page_size, size - std::size_t{page} * page_size);
  };
  const TouchedPages touched(bytes, size);
  const auto is_empty = [&](uint32_t page) {
    const std::size_t at = std::size_t{page} * page_size;
    return !touched.any(at, length(page)) || is_zero(bytes + at, length(page));
  };
  const auto clear = [&](uint32_t from, uint32_t to) {
    for (uint32_t page = from; page < to; ++page)
      if (!is_empty(page)) std::memset(bytes + std::size_t{page} * page_size, 0, length(page));
  };
  for (uint32_t page = 0;;) {
    uint32_t next = page;
    if (!loading())
      while (next < pages && is_empty(next)) ++next;
    raw(&next, sizeof next);
    if (!ok()) return;
    if (next < page || next > pages) return refuse("has a page outside");
    if (loading()) clear(page, next);
    if (next == pages) return;
    raw(bytes + std::size_t{next} * page_size, length(next));
    if (!ok()) return;
    page = next + 1;
  }
}

void StateReader::raw(void* bytes, std::size_t size) {
  if (!ok()) return;
  if (size > bytes_.size() - next_) return refuse("is missing");
  std::memcpy(bytes, bytes_.data() + next_, size);
  next_ += size;
}

void StateHash::raw(void* bytes, std::size_t size) {
  mix(hash_, bytes, size);
}

void StateComparison::raw(void* bytes, std::size_t size) {
  if (!difference_.empty()) return;
  if (size > bytes_.size() - next_) {
    difference_ = path() + ": was not saved";
    return;
  }
  const char* const saved = bytes_.data() + next_;
  next_ += size;
  if (std::memcmp(bytes, saved, size) == 0) return;
  std::size_t at = 0;
  constexpr std::size_t word = 8;
  if (size > word)
    while (std::memcmp(static_cast<char*>(bytes) + at, saved + at, std::min(word, size - at)) == 0)
      at += word;
  const std::size_t shown = std::min(word, size - at);
  difference_ = path() + (size > word ? " at byte " + std::to_string(at) : "") + ": " +
                in_hexadecimal(saved + at, shown) + " is " +
                in_hexadecimal(static_cast<char*>(bytes) + at, shown);
}

}  // namespace capsoc
