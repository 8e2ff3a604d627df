#include "run/itm_output.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cerrno>
#include <cstring>

namespace capsoc::run {

Result<std::unique_ptr<ItmOutput>> ItmOutput::open(const std::string& place, unsigned port) {
  const auto make = [port](std::FILE* stream, bool owned, bool logs) {
    return std::unique_ptr<ItmOutput>(new ItmOutput(port, stream, owned, logs));
  };
  if (place == "null") return make(nullptr, false, false);
  if (place == "stdout") return make(stdout, false, false);
  if (place == "log") return make(nullptr, false, true);
  if (place.rfind("file:", 0) != 0 || place.size() == 5)
    return Error{fmt::format("--itm {}: choose stdout, null, log or file:PATH", place)};
  const std::string path = place.substr(5);
  std::FILE* stream = std::fopen(path.c_str(), "wb");
  if (stream == nullptr)
    return Error{fmt::format("{}: cannot be written ({}); name another file for --itm", path,
                             std::strerror(errno))};
  return make(stream, true, false);
}

ItmOutput::~ItmOutput() {
  if (owned_) std::fclose(stream_);
}

void ItmOutput::put(unsigned port, uint32_t value, unsigned size) {
  if (port != port_) return;
  for (unsigned i = 0; i < size; ++i) put_byte(static_cast<char>(value >> (8 * i)));
}

void ItmOutput::put_byte(char byte) {
  if (stream_ != nullptr) std::fputc(byte, stream_);
  if (!logs_) return;
  constexpr std::size_t longest = 1000;  // a program may never end its line
  if (byte != '\n') line_ += byte;
  if (byte != '\n' && line_.size() < longest) return;
  spdlog::info("itm: {}", line_);
  line_.clear();
}

void ItmOutput::flush() {
  if (stream_ != nullptr) std::fflush(stream_);
  if (!line_.empty()) put_byte('\n');
}

}  // namespace capsoc::run
