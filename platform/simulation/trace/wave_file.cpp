#include "trace/wave_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "host/link_target.h"

namespace capsoc::trace {
namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// A block is a byte with its kind and its length without that byte, 8 bytes with the highest
/// first. A file is a chain of blocks that begins with the header and ends at its end.
bool is_whole(const std::string& path) {
  constexpr int header_kind = 0, skip_kind = 255;
  const File file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (file == nullptr || std::fseek(file.get(), 0, SEEK_END) != 0) return false;
  const auto size = static_cast<uint64_t>(std::ftell(file.get()));
  uint64_t at = 0;
  while (at < size) {
    std::array<unsigned char, 9> head{};
    if (std::fseek(file.get(), static_cast<long>(at), SEEK_SET) != 0 ||
        std::fread(head.data(), 1, head.size(), file.get()) != head.size())
      return false;
    uint64_t length = 0;
    for (std::size_t i = 1; i < head.size(); ++i) length = length << 8U | head[i];
    if ((at == 0) != (head[0] == header_kind) || head[0] == skip_kind) return false;
    if (length < 8 || length > size - at - 1) return false;
    at += 1 + length;
  }
  return at != 0;
}

/// Of the other formats that GTKWave and simulators have.
bool is_other_format(std::string extension) {
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* other : {".vcd", ".ghw", ".lxt", ".lxt2", ".vzt", ".vpd", ".wlf", ".fsdb"})
    if (extension == other) return true;
  return false;
}

}  // namespace

WaveFile::WaveFile(const std::string& path) : file_(path), hierarchy_(file_.growing() + ".hier") {}

Result<WaveFile> WaveFile::at(const std::string& path) {
  std::filesystem::path fst(path);
  if (is_other_format(fst.extension().string())) {
    fst.replace_extension(".fst");
    return Error{
        fmt::format("{}: waves are written in FST alone; name the file {} (of GTKWave, "
                    "fst2vcd makes a VCD file of it)",
                    path, fst.filename().string())};
  }
  if (host::place_of(path).in_place()) return Error{path + ": is no file; name one for the waves"};
  if (auto error = host::check_writable(path)) return *error;
  return WaveFile(path);
}

std::optional<Error> WaveFile::finish() {
  if (!is_whole(file_.growing())) return host::cannot_write(file_.path(), ENOSPC);
  return file_.name();
}

}  // namespace capsoc::trace
