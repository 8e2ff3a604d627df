#include "ports/semihosting_port.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "host/console.h"
#include "serial/open_backend.h"

namespace capsoc::run {
namespace {

constexpr uint32_t stack_size = 64U << 10U;  // what SYS_HEAPINFO leaves for it

/// From the end of the program, as linker scripts name it, to the end of the memory that it is in.
semihosting::HeapInfo heap_of(const loader::ElfImage& image, const bus::AddressMap& map) {
  for (const char* name : {"end", "_end", "__end__", "heap_start"}) {
    const auto symbol = image.address_of(name);
    if (!symbol) continue;
    for (const bus::MapEntry& entry : map) {
      if (entry.kind != bus::TargetKind::memory || *symbol < entry.base || *symbol > entry.last())
        continue;
      const auto top = static_cast<uint32_t>(entry.last() + 1);
      const uint32_t base = (*symbol + 7) & ~7U, limit = top - stack_size;
      if (base < limit) return {base, limit, top, limit};
    }
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<SemihostingPort>> SemihostingPort::open(
    const SemihostingSettings& settings, soc::Soc& soc, const loader::ElfImage& image,
    const std::string& program, serial::KeptStream* kept, const serial::GiveUp& give_up) {
  semihosting::GuestFiles files;
  if (const std::string& directory = settings.directory(); !directory.empty()) {
    auto opened = semihosting::GuestFiles::in(directory);
    if (!opened) return Error{opened.error()};
    files = std::move(opened.value());
  }
  auto console = serial::open_or_keep(settings.console(), "--semihosting-console", kept, give_up);
  if (!console) return Error{console.error()};
  if (const std::string place = console.value()->place(); !place.empty())
    host::say("semihosting: {}\n", place);
  semihosting::Environment environment;
  // The name without its folder: the same bytes wherever the program lies.
  environment.command_line = std::filesystem::path(program).filename().string();
  if (const std::string& arguments = settings.arguments(); !arguments.empty())
    environment.command_line += " " + arguments;
  environment.epoch_s = static_cast<uint64_t>(settings.epoch_s());
  environment.heap = heap_of(image, soc.ahb.map());
  environment.now_ns = [&soc] {
    return static_cast<uint64_t>(soc.clock.time_of(soc.cpu.core().cycles()) /
                                 sc_core::sc_time(1, sc_core::SC_NS));
  };
  std::unique_ptr<SemihostingPort> port(new SemihostingPort(
      soc, std::move(console.value()), std::move(files), std::move(environment), give_up));
  port->on_standard_error_ = settings.console() == "stderr";
  return port;
}

SemihostingPort::SemihostingPort(soc::Soc& soc, std::unique_ptr<serial::CharacterBackend> console,
                                 semihosting::GuestFiles files,
                                 semihosting::Environment environment,
                                 const serial::GiveUp& give_up)
    : soc_(soc),
      console_(std::move(console), give_up),
      semihosting_(*this, std::move(files), console_, std::move(environment)) {
  soc_.cpu.core().listeners().semihosting = [this](armv7m::Core& core) {
    soc_.cpu.note_work();
    uint32_t result = core.reg(0);
    switch (semihosting_.call(core.reg(0), core.reg(1), result)) {
      case semihosting::Semihosting::Outcome::asks_again:
        core.ask_again();
        return true;
      case semihosting::Semihosting::Outcome::ended:
        return false;
      case semihosting::Semihosting::Outcome::answered:
        break;
    }
    core.set_reg(0, result);
    return true;
  };
}

std::string SemihostingPort::finish() {
  console_.finish();
  return on_standard_error_ ? "" : console_.failure();
}

bool SemihostingPort::read(uint32_t address, void* data, uint32_t size) {
  return soc_.read_memory(address, data, size);
}

bool SemihostingPort::write(uint32_t address, const void* data, uint32_t size) {
  return soc_.write_memory(address, data, size);
}

}  // namespace capsoc::run
