#include "checkpoint/checkpoint_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <charconv>
#include <nlohmann/json.hpp>

#include "base/input_file.h"
#include "base/printable.h"
#include "host/sha256.h"
#include "version/version.h"

namespace capsoc::checkpoint {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view magic = "capsoc checkpoint ";
constexpr std::size_t hash_digits = 64;
/// Nothing that a run has is larger; a file that says so is wrong.
constexpr uint64_t largest_section = 1u << 30;

std::string compressed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, 0);
  // Level 1: most is zero already left out, and a run waits meanwhile.
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 1) != Z_OK)
    return {};  // no memory: unpacking finds a section that is damaged
  packed.resize(size);
  return packed;
}

std::optional<std::string> expanded(std::string_view packed, uint64_t size) {
  // Deflate makes at most 1032 bytes of one.
  if (size > largest_section || size / 1032 > packed.size()) return std::nullopt;
  std::string bytes(size, 0);
  uLongf done = size;
  if (uncompress(reinterpret_cast<Bytef*>(bytes.data()), &done,
                 reinterpret_cast<const Bytef*>(packed.data()), packed.size()) != Z_OK ||
      done != size)
    return std::nullopt;
  return bytes;
}

Error damaged(const std::string& file, const std::string& what) {
  return Error{fmt::format(
      "{}: the checkpoint is damaged ({}); save it again, or run from the beginning", file, what)};
}

/// Takes a file apart from its beginning.
class Scanner {
 public:
  Scanner(const std::string& bytes, const std::string& file) : rest_(bytes), file_(file) {}

  Result<Checkpoint> scan() {
    auto head = header();
    if (!head) return Error{head.error()};
    const Json& j = head.value();
    Checkpoint checkpoint;
    if (!text_of(j, "capsoc", checkpoint.written_by) || !number_of(j, "time_ps", checkpoint.time) ||
        !j.contains("run") || !j["run"].is_object() || !j.contains("parts") ||
        !j["parts"].is_array())
      return damaged(file_, "its header is incomplete");
    for (const auto& [name, value] : j["run"].items()) {
      if (!value.is_string()) return damaged(file_, "its header is incomplete");
      checkpoint.identity.emplace_back(name, value.get<std::string>());
    }
    for (const Json& part : j["parts"]) {
      auto section = next_section(part);
      if (!section) return Error{section.error()};
      checkpoint.sections.push_back(std::move(section.value()));
    }
    if (!rest_.empty()) return damaged(file_, fmt::format("{} bytes too many", rest_.size()));
    return checkpoint;
  }

 private:
  static bool text_of(const Json& j, const char* key, std::string& text) {
    if (!j.is_object() || !j.contains(key) || !j[key].is_string()) return false;
    text = j[key].get<std::string>();
    return true;
  }
  static bool number_of(const Json& j, const char* key, uint64_t& number) {
    if (!j.is_object() || !j.contains(key) || !j[key].is_number_unsigned()) return false;
    number = j[key].get<uint64_t>();
    return true;
  }

  /// "capsoc checkpoint VERSION SIZE SHA256\n" and SIZE bytes of JSON.
  Result<Json> header() {
    const std::size_t end = rest_.substr(0, 200).find('\n');
    if (rest_.substr(0, magic.size()) != magic || end == std::string_view::npos)
      return Error{
          fmt::format("{}: is no checkpoint; give a file that capsoc run --save wrote", file_)};
    std::string_view line = rest_.substr(magic.size(), end - magic.size());
    rest_.remove_prefix(end + 1);
    uint64_t found = 0, size = 0;
    if (!take_number(line, found)) return damaged(file_, "its first line");
    if (found != checkpoint::version)
      return Error{fmt::format(
          "{}: is a checkpoint of format {}, and this program has format {}; save it again", file_,
          found, checkpoint::version)};
    if (!take_number(line, size) || line.size() != hash_digits)
      return damaged(file_, "its first line");
    if (size > rest_.size()) return damaged(file_, "it ends in its header");
    const std::string text(rest_.substr(0, size));
    rest_.remove_prefix(size);
    if (host::sha256_of(text) != line) return damaged(file_, "its header");
    Json j = Json::parse(text, nullptr, false);
    if (!j.is_object()) return damaged(file_, "its header");
    return j;
  }

  /// A number and the space after it.
  static bool take_number(std::string_view& line, uint64_t& number) {
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
    if (error != std::errc() || end == line.data() + line.size() || *end != ' ') return false;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()) + 1);
    return true;
  }

  Result<Section> next_section(const Json& part) {
    Section section;
    std::string hash;
    uint64_t packed = 0, size = 0;
    if (!text_of(part, "name", section.name) || !text_of(part, "sha256", hash) ||
        !number_of(part, "packed", packed) || !number_of(part, "size", size) ||
        !number_of(part, "layout", section.layout))
      return damaged(file_, "its header is incomplete");
    if (packed > rest_.size())
      return damaged(file_, fmt::format("it ends in the part {}", printable(section.name)));
    // Of the packed bytes: the same state can be packed in other ways, and no other byte passes.
    const std::string_view blob = rest_.substr(0, packed);
    rest_.remove_prefix(packed);
    const bool whole = host::sha256_of(blob) == hash;
    auto bytes = whole ? expanded(blob, size) : std::nullopt;
    if (!bytes) return damaged(file_, fmt::format("the part {}", printable(section.name)));
    section.bytes = std::move(*bytes);
    return section;
  }

  std::string_view rest_;
  const std::string& file_;
};

}  // namespace

Result<Checkpoint> save(uint64_t time, const std::vector<Part>& parts) {
  Checkpoint checkpoint;
  checkpoint.time = time;
  checkpoint.written_by = fmt::format("{} ({})", capsoc::version(), commit());
  for (const Part& part : parts) {
    StateWriter writer;
    writer.set_time(time);
    part.visit(writer);
    if (!writer.ok()) return Error{fmt::format("{}: {}", part.name, writer.problem())};
    checkpoint.sections.push_back({part.name, writer.take(), writer.layout()});
  }
  return checkpoint;
}

std::optional<Error> load(const Checkpoint& checkpoint, const std::vector<Part>& parts) {
  const auto other = [](const std::string& what) {
    return Error{what + ": the checkpoint is of another version of capsoc; save it again"};
  };
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i >= checkpoint.sections.size() || checkpoint.sections[i].name != parts[i].name)
      return other(parts[i].name + " is missing");
    const Section& section = checkpoint.sections[i];
    if (!parts[i].visit) continue;
    StateReader reader(section.bytes);
    reader.set_time(checkpoint.time);
    parts[i].visit(reader);
    if (!reader.ok()) return Error{fmt::format("{}: {}", section.name, reader.problem())};
    if (!reader.at_end() || reader.layout() != section.layout)
      return other(section.name + " has other values");
  }
  if (checkpoint.sections.size() != parts.size())
    return other(printable(checkpoint.sections[parts.size()].name) +
                 " is not a part of this board");
  return std::nullopt;
}

std::string pack(const Checkpoint& checkpoint) {
  Json j;
  j["capsoc"] = checkpoint.written_by;
  j["time_ps"] = checkpoint.time;
  j["run"] = Json::object();
  for (const auto& [name, value] : checkpoint.identity) j["run"][name] = value;
  j["parts"] = Json::array();
  std::string blobs;
  for (const Section& section : checkpoint.sections) {
    const std::string packed = compressed(section.bytes);
    j["parts"].push_back({{"name", section.name},
                          {"size", section.bytes.size()},
                          {"packed", packed.size()},
                          {"layout", section.layout},
                          {"sha256", host::sha256_of(packed)}});
    blobs += packed;
  }
  const std::string header = j.dump(1, ' ', false, Json::error_handler_t::replace);
  return fmt::format("{}{} {} {}\n", magic, checkpoint::version, header.size(),
                     host::sha256_of(header)) +
         header + blobs;
}

Result<Checkpoint> unpack(const std::string& bytes, const std::string& file) {
  return Scanner(bytes, file).scan();
}

Result<Checkpoint> read(const std::string& file) {
  const InputLimits limits{"name a file that capsoc run --save wrote", largest_section, false};
  auto bytes = read_input(file, limits);
  if (!bytes) return Error{bytes.error()};
  return unpack(bytes.value(), file);
}

}  // namespace capsoc::checkpoint
