#include "trace/window.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>

#include "base/nearest.h"

namespace capsoc::trace {
namespace {

constexpr double longest_s = 1e6;

std::optional<uint32_t> hexadecimal_number(const std::string& text) {
  if (text.size() < 3 || text[0] != '0' || (text[1] != 'x' && text[1] != 'X')) return std::nullopt;
  uint32_t value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + 2, end, value, 16);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

std::optional<double> decimal(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

}  // namespace

Result<Bound> Bound::parse(const std::string& text, const std::string& what,
                           const Functions& functions) {
  Bound bound;
  if (text.empty()) return bound;
  if (const auto address = functions.address_of(text)) {
    bound.address = address;
  } else if (const auto number = hexadecimal_number(text)) {
    bound.address = *number & ~1U;
  } else if (const auto seconds = decimal(text)) {
    if (!(*seconds >= 0) || *seconds > longest_s)
      return Error{fmt::format("{} = {} is out of range; give 0 to {:g} s", what, text, longest_s)};
    bound.picoseconds = static_cast<uint64_t>(std::llround(*seconds * 1e12));
  } else {
    const std::string nearest = nearest_names(text, functions.names());
    return Error{fmt::format(
        "{} = {} is no symbol of the program; give a function{}, an address (0x...) or seconds",
        what, text, nearest.empty() ? "" : " (did you mean " + nearest + "?)")};
  }
  return bound;
}

void Window::close() {
  open_ = false;
  if (!start_.address) over_ = true;
}

void Window::time(uint64_t picoseconds) {
  if (over_) return;
  if (stop_.picoseconds && picoseconds >= *stop_.picoseconds) {
    open_ = false;
    over_ = true;
    return;
  }
  if (start_.picoseconds && picoseconds >= *start_.picoseconds) {
    start_.picoseconds.reset();
    open_ = true;
  }
}

void Window::instruction(uint32_t address) {
  if (over_) return;
  if (open_ && stop_.address && address == *stop_.address) {
    close();
  } else if (!open_ && start_.address && address == *start_.address) {
    open_ = true;
  }
}

}  // namespace capsoc::trace
