#include "soc/soc.h"

#include <fmt/format.h>

#include <algorithm>

namespace capsoc::soc {
namespace {

std::unique_ptr<coprocessor::Device> make_coprocessor(const Config& config) {
  if (config.make_coprocessor) return config.make_coprocessor();
  return std::make_unique<coprocessor::Coprocessor>(config.coprocessor);
}

}  // namespace

Soc::Soc(const sc_core::sc_module_name& name, const Config& config)
    : sc_module(name),
      cpu("cpu", clock, *config.processor),
      ahb("ahb", board_map(config.memory_waits), clock),
      apb("apb", board_map(), clock),
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
      clock_controller("clock_controller", clock),
      monitor_(config.monitor) {
  cpu.set_quantum(config.quantum);
  cpu.core().limit_translator(config.translator);
  cpu.core().set_executor(config.executor);
  cpu.set_fast_forward(config.fast_forward);
  list_components();
  bind();
  make_others(config.devices);
  connect_interrupts();
  adc.set_sink([this](const peripherals::SensorSample& sample) { coprocessor.sample(sample); });
  cpu.on_reset_request([this] { reset_peripherals(); });
}

/// The one list of what is on the board. What is not modelled and the user's own devices come
/// after it.
void Soc::list_components() {
  components_ = {&cpu,
                 &timer0,
                 &timer1,
                 &dual_timer,
                 &watchdog,
                 &uart0,
                 &uart1,
                 &uart2,
                 &uart3,
                 &uart4,
                 &gpio0,
                 &gpio1,
                 &gpio2,
                 &gpio3,
                 &fpgaio,
                 &scc,
                 &coprocessor,
                 &adc,
                 &clock_controller,
                 &code_sram,
                 &data_sram,
                 &block_ram,
                 &psram};
}

/// Every free slot gets the user's device, or a stand-in that says what is missing.
void Soc::make_others(const std::vector<OwnDevice>& own) {
  for (const bus::MapEntry& entry : board_map()) {
    if (entry.kind != bus::TargetKind::unimplemented) continue;
    const auto mine = std::find_if(
        own.begin(), own.end(), [&](const OwnDevice& device) { return device.slot == entry.name; });
    if (mine != own.end()) {
      devices.push_back(mine->make(*this));
      components_.push_back(devices.back().get());
      bind_target(entry, devices.back()->socket);
      continue;
    }
    const std::string module = entry.name + "_stub";
    unimplemented.push_back(
        std::make_unique<bus::Unimplemented>(module.c_str(), entry.name, entry.base));
    components_.push_back(unimplemented.back().get());
    bind_target(entry, unimplemented.back()->socket);
  }
}

/// With a monitor between the two, if there are any.
template <typename Initiator, typename Target>
void Soc::connect(Initiator& initiator, Target& target, const std::string& name,
                  kit::Downstream downstream) {
  if (!monitor_) return initiator.bind(target);
  monitors_.push_back(
      std::make_unique<kit::ProtocolMonitor<>>((name + "_monitor").c_str(), protocol, downstream));
  initiator.bind(monitors_.back()->from_initiator);
  monitors_.back()->to_target.bind(target);
}

template <typename Socket>
void Soc::bind_target(const bus::MapEntry& entry, Socket& socket) {
  if (entry.bus == bus::BusKind::apb)
    connect(*apb.port(entry.target), socket, entry.target, kit::Downstream::target);
  else
    connect(*ahb.port(entry.target), socket, entry.target, kit::Downstream::target);
}

void Soc::bind() {
  connect(cpu.icode, ahb.i_code, "icode", kit::Downstream::unknown);
  connect(cpu.dcode, ahb.d_code, "dcode", kit::Downstream::unknown);
  connect(cpu.system, ahb.system, "system", kit::Downstream::unknown);
  connect(*ahb.port(bus::apb_bridge_target), apb.socket, "apb", kit::Downstream::unknown);
  replaced_ = ahb.replaced.listen(
      [this](uint64_t first, uint64_t last) { cpu.memory_replaced(first, last); });
  const bus::AddressMap map = board_map();
  for (kit::Component* part : components_) {
    const bus::MapEntry* const entry = bus::find_entry(map, part->component_name());
    if (entry == nullptr) continue;  // the processor
    if (auto* device = dynamic_cast<kit::RegisterTarget*>(part))
      bind_target(*entry, device->socket);
    else if (auto* memory = dynamic_cast<bus::Memory*>(part))
      bind_target(*entry, memory->socket);
  }
}

void Soc::each_interrupt(const EachInterrupt& call) {
  const bus::AddressMap map = board_map();
  for (kit::Component* part : components_) {
    const bus::MapEntry* const entry = bus::find_entry(map, part->component_name());
    if (entry == nullptr) continue;
    for (const kit::Component::Output& output : part->outputs())
      for (const bus::InterruptWire& wire : entry->interrupts)
        if (wire.output == output.name) call(*output.line, part->component_name(), wire);
  }
}

void Soc::connect_interrupts() {
  each_interrupt([this](kit::InterruptLine& source, const char*, const bus::InterruptWire& wire) {
    if (wire.line == bus::nmi_line)
      return source.connect([this](bool level) {
        if (level) cpu.pulse_nmi();
      });
    source.connect([this, line = static_cast<unsigned>(wire.line)](bool level) {
      high_sources_[line] += level ? 1 : -1;
      cpu.set_interrupt(line, high_sources_[line] > 0);
    });
  });
  watchdog.reset_request.connect([this](bool level) {
    if (level) cpu.request_reset();
  });
}

void Soc::reset_peripherals() {
  for (kit::Component* part : components_) part->reset();
}

void Soc::visit(Archive& archive) {
  archive("clock", clock);
  archive("high_sources", high_sources_);
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

std::optional<Error> Soc::load(const std::string& path, uint32_t address,
                               const std::vector<uint8_t>& bytes) {
  if (bytes.empty()) return std::nullopt;
  const auto size = static_cast<uint32_t>(bytes.size());
  const uint32_t last = address + size - 1;
  if (!is_memory(address, 1) || !is_memory(last, 1))
    return Error{fmt::format(
        "{}: the segment {:#010x} to {:#010x} lies outside memory; link it to the map that "
        "`capsoc info` prints",
        path, address, last)};
  if (!is_memory(address, size))
    return Error{fmt::format(
        "{}: the segment at {:#010x} crosses the end of a memory; link it to the map that "
        "`capsoc info` prints",
        path, address)};
  write_memory(address, bytes.data(), size);
  return std::nullopt;
}

}  // namespace capsoc::soc
