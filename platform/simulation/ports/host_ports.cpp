#include "ports/host_ports.h"

#include "host/console.h"

namespace capsoc::run {
namespace {

/// The GDB server that the settings ask for, or null.
Result<std::unique_ptr<debug::GdbServer>> make_gdb_server(const GdbSettings& settings,
                                                          soc::Soc& soc,
                                                          std::function<bool()> give_up) {
  const long long port = settings.port();
  const bool halted = settings.halt();
  if (port < 0 && halted) return Error{"--halt waits for a debugger; give --gdb PORT, too"};
  if (port < 0) return std::unique_ptr<debug::GdbServer>();
  auto connections = debug::Connections::listen(static_cast<uint16_t>(port));
  if (!connections) return Error{connections.error()};
  host::say("gdb: listening on 127.0.0.1:{}{}\n", connections.value()->port(),
            halted ? ", waiting for a debugger" : "");
  return std::make_unique<debug::GdbServer>(soc, std::move(connections.value()), halted,
                                            std::move(give_up));
}

}  // namespace

Result<std::unique_ptr<HostPorts>> HostPorts::open(const PortSettings& settings, soc::Soc& soc,
                                                   const loader::ElfImage& program,
                                                   const std::string& program_file,
                                                   const serial::GiveUp& give_up) {
  std::unique_ptr<HostPorts> ports(new HostPorts(soc, give_up));
  HostPorts* self = ports.get();

  serial::KeptStreams* const kept = settings.kept;
  auto itm = ItmOutput::open(settings.itm.backend(), static_cast<unsigned>(settings.itm.port()),
                             kept != nullptr ? &kept->itm : nullptr, give_up);
  if (!itm) return Error{itm.error()};
  ports->itm_ = std::move(itm.value());
  // Who asks for the text is the debugger that enables it.
  const auto itm_port = static_cast<unsigned>(settings.itm.port());
  const bool itm_shown = ItmOutput::is_shown(settings.itm.backend());
  if (itm_shown) soc.cpu.core().debugging().show_stimulus(1U << itm_port, true);
  soc.cpu.core().listeners().stimulus = [self, &soc](unsigned port, uint32_t value, unsigned size) {
    soc.cpu.note_work();
    self->itm_->put(port, value, size);
  };

  auto semihosting = SemihostingPort::open(settings.semihosting, soc, program, program_file,
                                           kept != nullptr ? &kept->console : nullptr, give_up);
  if (!semihosting) return Error{semihosting.error()};
  ports->semihosting_ = std::move(semihosting.value());

  if (auto error = ports->uarts_.open(settings.uarts)) return *error;
  if (auto error = ports->pins_.open(settings.pins)) return *error;

  // While a debugger holds the processor, what it printed is to be seen.
  auto gdb = make_gdb_server(settings.gdb, soc, [self, give_up] {
    self->uarts_.flush();
    self->pins_.flush();
    self->semihosting_->flush();
    return give_up();
  });
  if (!gdb) return Error{gdb.error()};
  ports->gdb_ = std::move(gdb.value());
  if (ports->gdb_ != nullptr && itm_shown) ports->gdb_->show_stimulus_of(itm_port);
  return ports;
}

std::vector<std::string> HostPorts::finish() {
  const std::string console = semihosting_->finish();
  uarts_.finish();
  itm_->finish();
  pins_.finish();
  std::vector<std::string> lost = uarts_.failures();
  for (std::string& sentence : pins_.failures()) lost.push_back(std::move(sentence));
  for (const std::string& failure : {console, itm_->failure()})
    if (!failure.empty()) lost.push_back(failure);
  return lost;
}

void HostPorts::tell_debugger(int code) {
  if (gdb_ != nullptr) gdb_->finish(code);
}

void HostPorts::visit(Archive& archive) {
  archive("uarts", uarts_);
  archive("itm", *itm_);
  archive("semihosting", *semihosting_);
}

}  // namespace capsoc::run
