#include "loader/program_file.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>
#include <utility>

#include "base/input_file.h"
#include "loader/hex_record.h"

namespace capsoc::loader {
namespace {

constexpr uint64_t largest_file = 64U << 20U;  // more than all memories of the board

Result<std::string> contents(const std::string& path) {
  return read_input(path, {"name a file to load", largest_file});
}

}  // namespace

Result<ElfImage> load_hex(const std::string& path) {
  const auto text = contents(path);
  if (!text) return Error{text.error()};
  return parse_hex(path, text.value());
}

Result<ElfImage> load_program(const std::string& path) {
  auto bytes = read_program(path);
  if (!bytes) return Error{bytes.error()};
  const std::string_view text = without_byte_order_mark(bytes.value());
  if (text.substr(0, 1) == ":") return parse_hex(path, bytes.value());
  if (text.size() > 1 && text[0] == 'S' && text[1] >= '0' && text[1] <= '9')
    return parse_srec(path, bytes.value());
  return parse_elf(path, std::move(bytes.value()));
}

Result<ElfImage> load_at(const std::string& place) {
  const std::size_t at = place.rfind('@');
  if (at == std::string::npos) return load_program(place);
  const std::string path = place.substr(0, at), number = place.substr(at + 1);
  char* end = nullptr;
  const unsigned long long address = std::strtoull(number.c_str(), &end, 0);
  if (number.empty() || hex_digit(number[0]) < 0 || *end != '\0' || address > 0xFFFFFFFF)
    return Error{
        fmt::format("--load {}: '{}' is no address; write FILE@0x21000000", place, number)};
  auto bytes = contents(path);
  if (!bytes) return Error{bytes.error()};
  const uint64_t size = bytes.value().size();
  if (address + size > uint64_t{1} << 32U)
    return Error{fmt::format("{}: does not fit after {:#x}", path, address)};
  ElfImage image;
  image.path = path;
  image.segments.push_back({static_cast<uint32_t>(address),
                            {bytes.value().begin(), bytes.value().end()},
                            static_cast<uint32_t>(size)});
  return image;
}

}  // namespace capsoc::loader
