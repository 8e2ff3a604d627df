#include "debug/soc_target.h"

#include <fmt/format.h>

#include <algorithm>

#include "armv7m/active_exception.h"
#include "bus/address_map.h"
#include "debug/description.h"

namespace capsoc::debug {
namespace {

constexpr uint32_t private_bus_size = 1U << 20U, bit_band_size = 32U << 20U;
constexpr uint32_t private_bus = 0xE0000000, sram_bits = 0x22000000, device_bits = 0x42000000;

bool on_private_bus(uint32_t address) {
  return address - private_bus < private_bus_size;
}

enum : unsigned { xpsr = 16, msp, psp, primask, basepri, faultmask, control };
constexpr unsigned fpscr = first_fpu_register + fpu_singles;

bool is_single(unsigned index) {
  return index >= first_fpu_register && index < fpscr;
}

armv7m::Watchpoint watchpoint(StopPoint kind, uint32_t address, uint32_t size) {
  return {address, size, kind != StopPoint::write_watchpoint, kind != StopPoint::read_watchpoint};
}

}  // namespace

bool SocTarget::in_bit_band(uint32_t address) const {
  const bool alias = address - sram_bits < bit_band_size || address - device_bits < bit_band_size;
  return alias && soc_.cpu.core().profile().has_bit_bands;
}

bool SocTarget::has_register(unsigned index) {
  const armv7m::Profile& has = soc_.cpu.core().profile();
  switch (index) {
    case basepri:
      return has.has_special(armv7m::special::basepri);
    case faultmask:
      return has.has_special(armv7m::special::faultmask);
    default:
      return index < first_fpu_register || has.has_fpu();
  }
}

uint32_t SocTarget::read_register(unsigned index) {
  const armv7m::Core& core = soc_.cpu.core();
  switch (index) {
    case xpsr:
      return core.state().xpsr();
    case msp:
      return core.state().msp();
    case psp:
      return core.state().psp();
    case primask:
      return core.state().primask;
    case basepri:
      return core.state().basepri;
    case faultmask:
      return core.state().faultmask;
    case control:
      return core.state().control;
    case fpscr:
      return core.state().fpu.status().bits();
    default:
      return is_single(index) ? core.state().fpu.s(index - first_fpu_register) : core.reg(index);
  }
}

void SocTarget::write_register(unsigned index, uint32_t value) {
  armv7m::Core& core = soc_.cpu.core();
  switch (index) {
    case xpsr:
      return core.edit().set_xpsr(value & core.profile().xpsr_bits);
    case msp:
      return core.edit().set_msp(value);
    case psp:
      return core.edit().set_psp(value);
    case primask:
      return core.edit().set_primask((value & 1) != 0);
    case basepri:
      return core.edit().set_basepri(value);
    case faultmask:
      return core.edit().set_faultmask((value & 1) != 0);
    case control:
      return core.edit().set_control(value & core.profile().control_bits());
    case fpscr:
      core.edit().fpu.status() = armv7m::Fpscr(value);
      return;
    default:
      return is_single(index) ? core.edit().fpu.set_s(index - first_fpu_register, value)
                              : core.set_reg(index, value);
  }
}

uint32_t SocTarget::read_on_bus(uint32_t address, uint32_t size, uint8_t* bytes) {
  tlm::tlm_generic_payload payload;
  payload.set_command(tlm::TLM_READ_COMMAND);
  payload.set_address(address);
  payload.set_data_ptr(bytes);
  payload.set_data_length(size);
  payload.set_streaming_width(size);
  return soc_.cpu.system->transport_dbg(payload);
}

std::string SocTarget::read_memory(uint32_t address, uint32_t size) {
  size = static_cast<uint32_t>(std::min<uint64_t>(size, (uint64_t{1} << 32U) - address));
  std::string bytes(size, '\0');
  auto* out = reinterpret_cast<uint8_t*>(bytes.data());
  uint32_t done = 0;
  if (!on_private_bus(address) && !in_bit_band(address)) {
    done = read_on_bus(address, size, out);
  } else if (on_private_bus(address)) {
    while (done < size && soc_.cpu.core().debug_read(address + done, out + done, 1)) ++done;
  } else {
    // One word for each bit; bit 0 of the word is the bit.
    for (; done < size && in_bit_band(address + done); ++done) {
      const uint32_t at = address + done, bit = (at & (bit_band_size - 1)) >> 2U;
      uint8_t byte = 0;
      if (read_on_bus((at & 0xF0000000U) + (bit >> 3U), 1, &byte) != 1) break;
      out[done] = (at & 3U) == 0 ? byte >> (bit & 7U) & 1U : 0;
    }
  }
  bytes.resize(done);
  return bytes;
}

bool SocTarget::write_memory(uint32_t address, const std::string& bytes) {
  const auto size = static_cast<uint32_t>(bytes.size());
  if (size == 0) return true;
  if (address + size - 1 < address) return false;
  if (on_private_bus(address)) return soc_.cpu.core().debug_write(address, bytes.data(), size);
  std::string copy = bytes;
  tlm::tlm_generic_payload payload;
  payload.set_command(tlm::TLM_WRITE_COMMAND);
  payload.set_address(address);
  payload.set_data_ptr(reinterpret_cast<uint8_t*>(copy.data()));
  payload.set_data_length(size);
  payload.set_streaming_width(size);
  const uint32_t done = soc_.cpu.system->transport_dbg(payload);
  // Memory shows at several addresses, so what was decoded at any of them may be stale.
  if (done != 0) soc_.cpu.core().invalidate_code(0, 0xFFFFFFFF);
  return done == size || write_to_device(address + done, bytes.substr(done));
}

/// As the processor would write it, in the largest aligned pieces.
bool SocTarget::write_to_device(uint32_t address, const std::string& bytes) {
  for (uint32_t done = 0; done < bytes.size();) {
    uint32_t size = 4;
    while ((address + done) % size != 0 || size > bytes.size() - done) size /= 2;
    std::array<uint8_t, 4> piece{};
    for (uint32_t i = 0; i < piece.size() && i < size; ++i)
      piece[i] = static_cast<uint8_t>(bytes[done + i]);
    tlm::tlm_generic_payload payload;
    payload.set_command(tlm::TLM_WRITE_COMMAND);
    payload.set_address(address + done);
    payload.set_data_ptr(piece.data());
    payload.set_data_length(size);
    payload.set_streaming_width(size);
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    soc_.cpu.system->b_transport(payload, delay);
    if (!payload.is_response_ok()) return false;
    done += size;
  }
  return true;
}

bool SocTarget::set(StopPoint kind, uint32_t address, uint32_t size) {
  if (!is_breakpoint(kind)) {
    if (size == 0) return false;
    soc_.cpu.core().debugging().set_watchpoint(watchpoint(kind, address, size));
    return true;
  }
  address &= ~1U;
  ++breakpoints_[address][static_cast<std::size_t>(kind)];
  soc_.cpu.core().debugging().set_breakpoint(address);
  return true;
}

void SocTarget::clear(StopPoint kind, uint32_t address, uint32_t size) {
  if (!is_breakpoint(kind))
    return soc_.cpu.core().debugging().clear_watchpoint(watchpoint(kind, address, size));
  address &= ~1U;
  const auto found = breakpoints_.find(address);
  if (found == breakpoints_.end()) return;
  unsigned& count = found->second[static_cast<std::size_t>(kind)];
  if (count != 0) --count;
  if (found->second[0] + found->second[1] != 0) return;
  breakpoints_.erase(found);
  soc_.cpu.core().debugging().clear_breakpoint(address);
}

std::optional<StopCause> SocTarget::stop_cause(armv7m::StopReason reason) const {
  using armv7m::StopReason;
  using Kind = StopCause::Kind;
  const armv7m::Debugging& debugging = soc_.cpu.core().debugging();
  if (reason == StopReason::breakpoint) {
    const uint32_t pc = soc_.cpu.core().reg(15);
    return StopCause{debugging.has_breakpoint(pc) ? Kind::breakpoint : Kind::bkpt_instruction,
                     breakpoint_kind(pc)};
  }
  if (reason == StopReason::watchpoint) {
    const armv7m::WatchHit& hit = debugging.watch_hit();
    const StopPoint point = !hit.watchpoint.on_read    ? StopPoint::write_watchpoint
                            : !hit.watchpoint.on_write ? StopPoint::read_watchpoint
                                                       : StopPoint::access_watchpoint;
    return StopCause{Kind::watchpoint, point, hit.address};
  }
  if (reason == StopReason::lockup || reason == StopReason::stuck) return StopCause{Kind::lockup};
  return std::nullopt;
}

StopPoint SocTarget::breakpoint_kind(uint32_t address) const {
  const auto found = breakpoints_.find(address & ~1U);
  const bool hardware = found != breakpoints_.end() && found->second[1] != 0;
  return hardware ? StopPoint::hardware_breakpoint : StopPoint::software_breakpoint;
}

void SocTarget::reset() {
  soc_.cpu.reset_now();
}

std::string SocTarget::state() {
  const armv7m::Core& core = soc_.cpu.core();
  if (core.locked_up()) return "lockup";
  const uint32_t exception = armv7m::active_exception(core);
  const std::string mode =
      exception == 0
          ? (core.state().control & 1U) != 0 ? "Thread mode, unprivileged" : "Thread mode"
      : exception < 16 ? fmt::format("exception {}", exception)
                       : fmt::format("interrupt {}", exception - 16);
  return core.sleeping() ? mode + ", asleep" : mode;
}

std::vector<MemoryRange> SocTarget::memory_ranges() {
  std::vector<MemoryRange> ranges;
  for (const bus::MapEntry& entry : soc_.ahb.map())
    if (entry.kind != bus::TargetKind::unimplemented) ranges.push_back({entry.base, entry.size});
  if (soc_.cpu.core().profile().has_bit_bands) {
    ranges.push_back({sram_bits, bit_band_size});
    ranges.push_back({device_bits, bit_band_size});
  }
  ranges.push_back({private_bus, private_bus_size});
  return ranges;
}

std::string SocTarget::show_stimulus(uint32_t ports, bool on) {
  if (!soc_.cpu.core().profile().has_itm) return Target::show_stimulus(ports, on);
  soc_.cpu.core().debugging().show_stimulus(ports, on);
  if (!on || (shown_port_ && ports == 1U << *shown_port_)) return "";
  if (!shown_port_)
    return "itm: the text goes nowhere; start capsoc run with --itm stdout or --itm file:PATH\n";
  return fmt::format("itm: only the text of port {} is shown; choose another by -C itm.port=N\n",
                     *shown_port_);
}

std::string SocTarget::save(const std::string& file) {
  if (!saver_) return Target::save(file);
  const auto error = saver_(file);
  return error ? error->text + "\n" : file + ": saved\n";
}

}  // namespace capsoc::debug
