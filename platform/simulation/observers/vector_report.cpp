#include "observers/vector_report.h"

#include <fmt/format.h>

#include "base/archive.h"
#include "kit/guest_error.h"
#include "trace/exception_name.h"

namespace capsoc::run {

namespace {

constexpr unsigned most = 4;

}  // namespace

std::optional<Error> VectorReport::open() {
  listen();
  return std::nullopt;
}

/// As long as there is room: data that lies where a short table leaves it is written often.
void VectorReport::listen() {
  soc_.cpu.core().listeners().vectors = [this](const armv7m::VectorWrite& write) {
    written(write);
    return lines_ < most;
  };
}

/// A whole word that is a handler's address with the Thumb bit, or a stack in memory.
bool VectorReport::is_vector(const armv7m::VectorWrite& write) const {
  if (write.size != 4) return false;
  const uint32_t table = soc_.cpu.core().state().scb.vector(0);
  uint8_t byte = 0;
  if (write.address == table)
    return (write.value & 3) == 0 && soc_.read_memory(write.value - 4, &byte, 1);
  return (write.value & 1) != 0 && soc_.read_memory(write.value & ~1u, &byte, 1);
}

void VectorReport::visit(Archive& archive) {
  archive("vector_text", text_);
  archive("vector_lines", lines_);
  if (archive.loading()) listen();
}

std::optional<Finding> VectorReport::finding() const {
  if (text_.empty()) return std::nullopt;
  return Finding{"written into the vector table", text_};
}

void VectorReport::written(const armv7m::VectorWrite& write) {
  if (lines_ >= most || is_vector(write)) return;
  ++lines_;
  const unsigned number = (write.address - soc_.cpu.core().state().scb.vector(0)) / 4;
  const std::string what = number == 0 ? "the initial stack pointer"
                                       : fmt::format("the vector of exception {} ({})", number,
                                                     trace::exception_name(number));
  const std::string text = fmt::format("{:#x}, {} byte{}, to {:#010x}: {}", write.value, write.size,
                                       write.size == 1 ? "" : "s", write.address, what);
  text_ += fmt::format("    {}, by {} in cycle {}\n", text, view_.place(soc_.cpu.core().reg(15)),
                       soc_.cpu.core().cycles());
  kit::guest_error_once("cpu: vector table", "a write of " + text + "; a null pointer?");
}

}  // namespace capsoc::run
