#include "observers/symbols.h"

#include <fmt/format.h>

#include <cstdlib>
#include <optional>

#include "base/nearest.h"
#include "base/printable.h"

namespace capsoc::run {
namespace {

std::optional<uint32_t> as_number(const std::string& text) {
  if (text.rfind("0x", 0) != 0 || text.size() < 3 || text.size() > 10) return std::nullopt;
  char* end = nullptr;
  const unsigned long value = std::strtoul(text.c_str() + 2, &end, 16);
  if (*end != '\0') return std::nullopt;
  return static_cast<uint32_t>(value);
}

}  // namespace

Result<uint32_t> address_of(const std::string& text, const std::string& setting,
                            const source::Program& program) {
  if (const auto number = as_number(text)) return *number;
  if (const auto address = program.address_of(text)) return *address;
  const std::string nearest = nearest_names(text, program.symbol_names());
  return Error{fmt::format(
      "{} = {}: is no symbol of the program; give one{}, or an address (0x20001000)", setting,
      printable(text), nearest.empty() ? "" : " (did you mean " + nearest + "?)")};
}

}  // namespace capsoc::run
