#include "soc/soc.h"

#include <fmt/format.h>

#include <algorithm>

#include "bus/address_map.h"

namespace capsoc::soc {
namespace {

constexpr uint64_t kib = 1024, mib = 1024 * kib;

std::unique_ptr<coprocessor::Device> make_coprocessor(const Config& config) {
  if (config.make_coprocessor) return config.make_coprocessor();
  return std::make_unique<coprocessor::Coprocessor>(config.coprocessor);
}

}  // namespace

Soc::Soc(const sc_core::sc_module_name& name, const Config& config)
    : sc_module(name),
      cpu("cpu", clock),
      ahb("ahb", bus::soc_address_map(), clock),
      apb("apb", bus::soc_address_map(), clock),
      code_sram("code_sram", 4 * mib),
      data_sram("data_sram", 4 * mib),
      block_ram("block_ram", 16 * kib),
      psram("psram", 16 * mib),
      timer0("timer0", clock),
      timer1("timer1", clock),
      dual_timer("dual_timer", clock),
      watchdog("watchdog", clock),
      uart0("uart0", clock),
      uart1("uart1", clock),
      uart2("uart2", clock),
      uart3("uart3", clock),
      uart4("uart4", clock),
      gpio0("gpio0", clock),
      gpio1("gpio1", clock),
      gpio2("gpio2", clock),
      gpio3("gpio3", clock),
      fpgaio("fpgaio"),
      scc("scc"),
      coprocessor("coprocessor", clock, make_coprocessor(config)),
      adc("adc_front_end", clock),
      clock_controller("clock_controller", clock) {
  cpu.set_quantum(config.quantum);
  cpu.core().set_executor(config.executor);
  bind(config.devices);
  connect_interrupts();
  adc.set_sink([this](const peripherals::SensorSample& sample) { coprocessor.sample(sample); });
  cpu.on_reset_request([this] { reset_peripherals(); });
}

/// The socket of the user's own device in a slot, or null.
tlm_utils::simple_target_socket<tlm_util::RegisterTarget>* Soc::own_socket(
    const std::vector<OwnDevice>& own, const std::string& slot) {
  for (const OwnDevice& device : own) {
    if (device.slot != slot) continue;
    devices.push_back(device.make(*this));
    return &devices.back()->socket;
  }
  return nullptr;
}

void Soc::bind(const std::vector<OwnDevice>& own) {
  cpu.icode.bind(ahb.i_code);
  cpu.dcode.bind(ahb.d_code);
  cpu.system.bind(ahb.system);
  ahb.port(bus::apb_bridge_target)->bind(apb.socket);

  ahb.port("code_sram")->bind(code_sram.socket);
  ahb.port("data_sram")->bind(data_sram.socket);
  ahb.port("block_ram")->bind(block_ram.socket);
  ahb.port("psram")->bind(psram.socket);
  for (peripherals::Gpio* gpio : gpios()) ahb.port(gpio->basename())->bind(gpio->socket);

  apb.port("timer0")->bind(timer0.socket);
  apb.port("timer1")->bind(timer1.socket);
  apb.port("dual_timer")->bind(dual_timer.socket);
  apb.port("watchdog")->bind(watchdog.socket);
  apb.port("fpgaio")->bind(fpgaio.socket);
  apb.port("scc")->bind(scc.socket);
  for (peripherals::Uart* uart : uarts()) apb.port(uart->basename())->bind(uart->socket);
  apb.port("coprocessor")->bind(coprocessor.socket);
  apb.port("adc_front_end")->bind(adc.socket);
  apb.port("clock_controller")->bind(clock_controller.socket);

  for (const bus::MapEntry& entry : bus::soc_address_map()) {
    if (entry.kind != bus::TargetKind::unimplemented) continue;
    if (auto* socket = own_socket(own, entry.name)) {
      if (entry.bus == bus::BusKind::apb) {
        apb.port(entry.target)->bind(*socket);
      } else {
        ahb.port(entry.target)->bind(*socket);
      }
      continue;
    }
    const std::string module = entry.name + "_stub";
    unimplemented.push_back(
        std::make_unique<bus::Unimplemented>(module.c_str(), entry.name, entry.base));
    auto& socket = unimplemented.back()->socket;
    if (entry.bus == bus::BusKind::apb) {
      apb.port(entry.target)->bind(socket);
    } else {
      ahb.port(entry.target)->bind(socket);
    }
  }
}

void Soc::connect(tlm_util::InterruptLine& source, const char* device, const char* output) {
  const bus::AddressMap map = bus::soc_address_map();
  for (const bus::InterruptWire& wire : bus::find_entry(map, device)->interrupts) {
    if (wire.output != output) continue;
    if (wire.line == bus::nmi_line) {
      source.connect([this](bool level) {
        if (level) cpu.pulse_nmi();
      });
      continue;
    }
    source.connect([this, line = static_cast<unsigned>(wire.line)](bool level) {
      high_sources_[line] += level ? 1 : -1;
      cpu.set_interrupt(line, high_sources_[line] > 0);
    });
  }
}

void Soc::each_interrupt(const EachInterrupt& call) {
  call(timer0.interrupt, "timer0", "interrupt");
  call(timer1.interrupt, "timer1", "interrupt");
  call(dual_timer.interrupt, "dual_timer", "interrupt");
  call(watchdog.interrupt, "watchdog", "interrupt");
  for (peripherals::Uart* uart : uarts()) {
    call(uart->rx_interrupt, uart->basename(), "rx");
    call(uart->tx_interrupt, uart->basename(), "tx");
    call(uart->overrun_interrupt, uart->basename(), "overrun");
  }
  for (peripherals::Gpio* gpio : gpios())
    call(gpio->combined_interrupt, gpio->basename(), "combined");
  call(coprocessor.interrupt, "coprocessor", "interrupt");
  call(adc.interrupt, "adc_front_end", "interrupt");
}

void Soc::connect_interrupts() {
  each_interrupt([this](tlm_util::InterruptLine& source, const char* device, const char* output) {
    connect(source, device, output);
  });
  watchdog.reset_request.connect([this](bool level) {
    if (level) cpu.request_reset();
  });
}

void Soc::reset_peripherals() {
  timer0.reset();
  timer1.reset();
  dual_timer.reset();
  watchdog.reset();
  for (peripherals::Uart* uart : uarts()) uart->reset();
  for (peripherals::Gpio* gpio : gpios()) gpio->reset();
  fpgaio.reset();
  scc.reset();
  coprocessor.reset();
  adc.reset();
  clock_controller.reset();
  for (auto& device : devices) device->system_reset();
}

uint32_t Soc::peek(uint32_t address) {
  uint8_t bytes[4] = {};
  tlm::tlm_generic_payload payload;
  payload.set_command(tlm::TLM_READ_COMMAND);
  payload.set_address(address);
  payload.set_data_ptr(bytes);
  payload.set_data_length(sizeof bytes);
  payload.set_streaming_width(sizeof bytes);
  cpu.system->transport_dbg(payload);
  return bytes[0] | bytes[1] << 8 | bytes[2] << 16 | static_cast<uint32_t>(bytes[3]) << 24;
}

bool Soc::is_memory(uint32_t address, uint32_t size) const {
  const bus::AddressMap& map = ahb.map();
  return std::any_of(map.begin(), map.end(), [&](const bus::MapEntry& entry) {
    return entry.kind == bus::TargetKind::memory && address >= entry.base &&
           address <= entry.last() && size - 1 <= entry.last() - address;
  });
}

/// Bytes of a debug access that one memory answers; 0 for any other place.
uint32_t Soc::access_memory(tlm::tlm_command command, uint32_t address, void* bytes,
                            uint32_t size) {
  if (!is_memory(address, size)) return 0;
  tlm::tlm_generic_payload payload;
  payload.set_command(command);
  payload.set_address(address);
  payload.set_data_ptr(static_cast<uint8_t*>(bytes));
  payload.set_data_length(size);
  payload.set_streaming_width(size);
  return cpu.system->transport_dbg(payload);
}

bool Soc::read_memory(uint32_t address, void* bytes, uint32_t size) {
  return size == 0 || access_memory(tlm::TLM_READ_COMMAND, address, bytes, size) == size;
}

bool Soc::write_memory(uint32_t address, const void* bytes, uint32_t size) {
  if (size == 0) return true;
  // A write only reads them.
  const uint32_t done =
      access_memory(tlm::TLM_WRITE_COMMAND, address, const_cast<void*>(bytes), size);
  if (done != 0) cpu.core().invalidate_code(address, done);
  return done == size;
}

std::optional<Error> Soc::load(const loader::ElfImage& image) {
  for (const loader::Segment& segment : image.segments) {
    const uint32_t last = segment.address + segment.memory_size - 1;
    if (!is_memory(segment.address, 1) || !is_memory(last, 1))
      return Error{fmt::format(
          "{}: the segment {:#010x} to {:#010x} lies outside memory; link it to the map that "
          "`capsoc info` prints",
          image.path, segment.address, last)};
    if (!is_memory(segment.address, segment.memory_size))
      return Error{fmt::format(
          "{}: the segment at {:#010x} crosses the end of a memory; link it to the map that "
          "`capsoc info` prints",
          image.path, segment.address)};
    std::vector<uint8_t> bytes = segment.bytes;
    bytes.resize(segment.memory_size);
    write_memory(segment.address, bytes.data(), segment.memory_size);
  }
  return std::nullopt;
}

}  // namespace capsoc::soc
