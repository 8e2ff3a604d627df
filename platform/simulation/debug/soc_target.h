// The SoC as the debugger's protocol sees it.
#pragma once

#include <functional>
#include <map>

#include "debug/target.h"
#include "soc/soc.h"

namespace capsoc::debug {

class SocTarget : public Target {
 public:
  explicit SocTarget(soc::Soc& soc) : soc_(soc) {}

  std::string processor() override { return soc_.cpu.core().profile().short_name; }
  bool has_register(unsigned index) override;
  uint32_t read_register(unsigned index) override;
  void write_register(unsigned index, uint32_t value) override;
  std::string read_memory(uint32_t address, uint32_t size) override;
  bool write_memory(uint32_t address, const std::string& bytes) override;
  bool set(StopPoint kind, uint32_t address, uint32_t size) override;
  void clear(StopPoint kind, uint32_t address, uint32_t size) override;
  void reset() override;
  std::string state() override;
  /// Writes the state; an Error says why it could not.
  using Saver = std::function<std::optional<Error>(const std::string& file)>;
  void on_save(Saver saver) { saver_ = std::move(saver); }
  std::string save(const std::string& file) override;
  std::vector<MemoryRange> memory_ranges() override;
  /// Sets the port whose text the run shows; unset: none.
  void show_stimulus_of(unsigned port) { shown_port_ = port; }
  std::string show_stimulus(uint32_t ports, bool on) override;

  /// Why the processor is halted after a run that ended with `reason`. Empty: the run is over.
  std::optional<StopCause> stop_cause(armv7m::StopReason reason) const;
  /// Kind of the breakpoint at the address.
  StopPoint breakpoint_kind(uint32_t address) const;

 private:
  bool in_bit_band(uint32_t address) const;
  uint32_t read_on_bus(uint32_t address, uint32_t size, uint8_t* bytes);
  bool write_to_device(uint32_t address, const std::string& bytes);

  soc::Soc& soc_;
  Saver saver_;
  std::optional<unsigned> shown_port_;
  std::map<uint32_t, std::array<unsigned, 2>> breakpoints_;  ///< how often set: software, hardware
};

}  // namespace capsoc::debug
