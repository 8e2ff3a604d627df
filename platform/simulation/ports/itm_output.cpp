#include "ports/itm_output.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "serial/open_backend.h"

namespace capsoc::run {

Result<std::unique_ptr<ItmOutput>> ItmOutput::open(const std::string& place, unsigned port,
                                                   serial::KeptStream* kept,
                                                   const serial::GiveUp& give_up) {
  std::unique_ptr<serial::CharacterBackend> backend;
  if (place != "log") {
    const bool is_file = place.rfind("file:", 0) == 0 && place.size() > 5;
    if (place != "stdout" && place != "null" && !is_file)
      return Error{fmt::format("--itm {}: choose stdout, null, log or file:PATH", place)};
    auto opened = serial::open_or_keep(place, "--itm", kept, give_up);
    if (!opened) return Error{opened.error()};
    backend = std::move(opened.value());
  }
  return std::unique_ptr<ItmOutput>(new ItmOutput(port, std::move(backend)));
}

void ItmOutput::put(unsigned port, uint32_t value, unsigned size) {
  if (port != port_) return;
  for (unsigned i = 0; i < size; ++i) put_byte(static_cast<char>(value >> (8 * i)));
}

void ItmOutput::put_byte(char byte) {
  constexpr std::size_t longest = 1000;  // a program may never end its line
  line_ += byte;
  if (byte == '\n' || line_.size() >= longest) flush();
}

void ItmOutput::finish() {
  flush();
  if (backend_) backend_->finish();
}

void ItmOutput::flush() {
  if (line_.empty()) return;
  if (backend_) {
    backend_->write(line_);
  } else {
    if (line_.back() == '\n') line_.pop_back();
    spdlog::info("itm: {}", line_);
  }
  line_.clear();
}

}  // namespace capsoc::run
