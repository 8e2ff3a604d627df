#include "service/session_file.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "host/sha256.h"

namespace capsoc::service {
namespace {

constexpr std::string_view magic = "capsoc session ";
constexpr std::size_t hash_digits = 64;

bool is_hash(const std::string& text) {
  return text.size() == hash_digits &&
         text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// Not hidden, no folder, nothing that a shell would mind.
bool is_plain_name(const std::string& name) {
  return !name.empty() && name.size() <= SessionFile::longest_name && name.front() != '.' &&
         name.find_first_of(std::string_view("/\0\n", 3)) == std::string::npos;
}

/// Members of a header; what is missing or of another kind is noted, and an empty value stands in.
class Header {
 public:
  explicit Header(const Json& json) : json_(json) {}
  bool ok() const { return ok_; }

  std::string text(const Json& object, const char* name) {
    const Json* const found = find(object, name);
    if (found != nullptr && found->is_string()) return found->get<std::string>();
    ok_ = false;
    return "";
  }
  std::string hash(const Json& object, const char* name) {
    std::string text_of_it = text(object, name);
    ok_ = ok_ && is_hash(text_of_it);
    return text_of_it;
  }
  uint64_t number(const Json& object, const char* name) {
    const Json* const found = find(object, name);
    if (found != nullptr && found->is_number_unsigned()) return found->get<uint64_t>();
    ok_ = false;
    return 0;
  }
  /// Texts by names.
  std::map<std::string, std::string> texts(const Json& object, const char* name) {
    std::map<std::string, std::string> all;
    const Json* const found = find(object, name);
    ok_ = ok_ && found != nullptr && found->is_object();
    if (!ok_) return all;
    for (const auto& [key, value] : found->items()) {
      ok_ = ok_ && value.is_string();
      if (ok_) all[key] = value.get<std::string>();
    }
    return all;
  }
  /// A list of objects of at most `most`.
  std::vector<Json> list(const char* name, std::size_t most) {
    const Json* const found = find(json_, name);
    ok_ = ok_ && found != nullptr && found->is_array() && found->size() <= most;
    if (!ok_) return {};
    for (const Json& each : *found) ok_ = ok_ && each.is_object();
    return ok_ ? std::vector<Json>(found->begin(), found->end()) : std::vector<Json>();
  }
  void demand(bool holds) { ok_ = ok_ && holds; }

 private:
  static const Json* find(const Json& object, const char* name) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(name);
    return found == object.end() ? nullptr : &*found;
  }

  const Json& json_;
  bool ok_ = true;
};

/// Takes a file apart from its beginning.
class Reader {
 public:
  Reader(const std::string& bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

  Result<SessionFile> read() {
    if (bytes_.compare(0, magic.size(), magic) != 0)
      return wrong("is no session; name a file that simulation.record wrote");
    at_ = magic.size();
    const auto version = number(' ');
    if (!version) return damaged();
    if (*version != SessionFile::version)
      return wrong(
          fmt::format("has version {} of the format, this program reads {}; replay it with "
                      "the program that recorded it",
                      *version, SessionFile::version));
    const auto size = number(' ');
    if (!size || *size > SessionFile::largest_header || at_ + hash_digits + 1 > bytes_.size())
      return damaged();
    const std::string hash = bytes_.substr(at_, hash_digits);
    at_ += hash_digits;
    if (bytes_[at_++] != '\n') return damaged();
    const auto header = take(*size);
    if (!header) return wrong("is cut off; copy it again");
    if (host::sha256_of(*header) != hash) return damaged();
    const Json json = Json::parse(*header, nullptr, false);
    if (json.is_discarded()) return damaged();
    return read(json);
  }

 private:
  Error wrong(const std::string& why) const { return Error{fmt::format("{}: {}", file_, why)}; }
  Error damaged() const { return wrong("is damaged; copy it again"); }

  std::optional<uint64_t> number(char end) {
    uint64_t value = 0;
    const char* const begin = bytes_.data() + at_;
    const char* const last = bytes_.data() + bytes_.size();
    const auto [next, error] = std::from_chars(begin, last, value);
    if (error != std::errc() || next == last || *next != end) return std::nullopt;
    at_ += static_cast<std::size_t>(next - begin) + 1;
    return value;
  }

  std::optional<std::string> take(uint64_t size) {
    if (size > bytes_.size() - at_) return std::nullopt;
    std::string piece = bytes_.substr(at_, static_cast<std::size_t>(size));
    at_ += static_cast<std::size_t>(size);
    return piece;
  }

  Result<SessionFile> read(const Json& json) {
    Header header(json);
    SessionFile session;
    session.written_by = header.text(json, "capsoc");
    session.settings = header.texts(json, "settings");
    for (const Json& each : header.list("uarts", soc_uarts))
      session.uarts.push_back({header.number(each, "bytes"), header.hash(each, "sha256")});
    read_marks(header, session);
    for (const Json& each : header.list("files", SessionFile::most_files)) {
      SessionFile::Content content{header.text(each, "setting"), header.text(each, "name"), ""};
      header.demand(is_plain_name(content.name));
      if (!header.ok()) return damaged();
      auto bytes = take(header.number(each, "size"));
      if (!bytes) return wrong("is cut off; copy it again");
      if (host::sha256_of(*bytes) != header.hash(each, "sha256")) return damaged();
      content.bytes = std::move(*bytes);
      session.files.push_back(std::move(content));
    }
    if (json.contains("state")) {
      auto state = take(header.number(json, "state"));
      if (!state) return wrong("is cut off; copy it again");
      header.demand(!state->empty());
      if (host::sha256_of(*state) != header.hash(json, "state_sha256")) return damaged();
      session.state = std::move(*state);
    }
    const auto log = take(header.number(json, "inputs"));
    const std::string log_hash = header.hash(json, "inputs_sha256");
    if (!header.ok()) return damaged();
    if (!log) return wrong("is cut off; copy it again");
    if (host::sha256_of(*log) != log_hash) return damaged();
    if (at_ != bytes_.size()) return wrong("continues after its end; copy it again");
    auto inputs = inputs_in(*log);
    if (!inputs) return damaged();
    session.inputs = std::move(inputs.value());
    const Position& end = session.marks.back().at;
    if (!session.inputs.empty() && end < session.inputs.back().at) return damaged();
    return session;
  }

  static void read_marks(Header& header, SessionFile& session) {
    for (const Json& each : header.list("marks", SessionFile::most_marks)) {
      const auto at = each.contains("at") ? position_in(each.at("at")) : std::nullopt;
      header.demand(at.has_value());
      if (!header.ok()) return;
      SessionFile::Mark mark{*at, header.texts(each, "parts")};
      for (const auto& [name, hash] : mark.parts) header.demand(is_hash(hash));
      header.demand(session.marks.empty() || session.marks.back().at <= mark.at);
      session.marks.push_back(std::move(mark));
    }
    header.demand(!session.marks.empty());
  }

  static constexpr std::size_t soc_uarts = 16;

  const std::string& bytes_;
  std::string file_;
  std::size_t at_ = 0;
};

}  // namespace

std::string pack(const SessionFile& session) {
  Json header = {{"capsoc", session.written_by}};
  Json& settings = header["settings"] = Json::object();
  for (const auto& [name, value] : session.settings) settings[name] = value;
  std::string blobs;
  Json& files = header["files"] = Json::array();
  for (const SessionFile::Content& each : session.files) {
    files.push_back({{"setting", each.setting},
                     {"name", each.name},
                     {"size", each.bytes.size()},
                     {"sha256", host::sha256_of(each.bytes)}});
    blobs += each.bytes;
  }
  if (!session.state.empty()) {
    header["state"] = session.state.size();
    header["state_sha256"] = host::sha256_of(session.state);
    blobs += session.state;
  }
  std::string log;
  for (const Input& input : session.inputs) log += to_bytes(input);
  header["inputs"] = log.size();
  header["inputs_sha256"] = host::sha256_of(log);
  Json& marks = header["marks"] = Json::array();
  for (const SessionFile::Mark& mark : session.marks)
    marks.push_back({{"at", to_json(mark.at)}, {"parts", mark.parts}});
  Json& uarts = header["uarts"] = Json::array();
  for (const SessionFile::Text& text : session.uarts)
    uarts.push_back({{"bytes", text.bytes}, {"sha256", text.sha256}});
  const std::string text = header.dump(1, ' ', false, Json::error_handler_t::replace);
  return fmt::format("{}{} {} {}\n", magic, SessionFile::version, text.size(),
                     host::sha256_of(text)) +
         text + blobs + log;
}

Result<SessionFile> unpack_session(const std::string& bytes, const std::string& file) {
  return Reader(bytes, file).read();
}

}  // namespace capsoc::service
