#include "serial/open_backend.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "serial/file_backend.h"
#include "serial/pty_backend.h"
#include "serial/tcp_backend.h"

namespace capsoc::serial {
namespace {

std::optional<uint16_t> port_number(const std::string& text) {
  uint16_t port = 0;
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, port);
  if (text.empty() || error != std::errc() || last != end) return std::nullopt;
  return port;
}

}  // namespace

Result<std::unique_ptr<CharacterBackend>> open_backend(const std::string& spec,
                                                       const std::string& option,
                                                       const GiveUp& give_up, const char* names) {
  const std::size_t colon = spec.find(':');
  const std::string kind = spec.substr(0, colon);
  const bool named = colon != std::string::npos;
  const std::string name = named ? spec.substr(colon + 1) : "";
  if (spec == "stdout" || spec == "stdio") return FileBackend::standard(spec == "stdio", give_up);
  if (spec == "stderr") return FileBackend::standard_error(give_up);
  if (spec == "null") return FileBackend::null();
  if (kind == "file" && !name.empty()) return FileBackend::to_file(name, give_up);
  if (kind == "pty" && named == !name.empty()) return PtyBackend::open(name, give_up);
  if (kind == "tcp")
    if (const auto port = port_number(named ? name : "0"))
      return TcpBackend::open(*port, option + " tcp", give_up);
  return Error{fmt::format("{} {}: choose {}", option, spec, names)};
}

Result<std::unique_ptr<CharacterBackend>> open_or_keep(const std::string& spec,
                                                       const std::string& option, KeptStream* kept,
                                                       const GiveUp& give_up) {
  if (kept != nullptr && (spec == "stdout" || spec == "stderr" || spec == "stdio"))
    return std::unique_ptr<CharacterBackend>(std::make_unique<KeptBackend>(*kept));
  return open_backend(spec, option, give_up);
}

bool are_the_same_place(const std::string& one, const std::string& other) {
  const auto is_standard = [](const std::string& spec) {
    return spec == "stdout" || spec == "stdio";
  };
  const bool has_name = one.rfind("file:", 0) == 0 || one.rfind("pty:", 0) == 0;
  return (is_standard(one) && is_standard(other)) || (one == other && has_name);
}

}  // namespace capsoc::serial
