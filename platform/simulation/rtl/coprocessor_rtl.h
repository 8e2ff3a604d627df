// The Verilated coprocessor with the interface of the model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"
#include "coprocessor/device.h"
#include "rtl/rtl_abi.h"
#include "rtl/rtl_library.h"

namespace capsoc::rtl {

/// Whether the clock runs while nothing can change (`idle_o` and no input). Same results.
enum class Clocking { skip, every };

/// Drives the pins in the interval in front of each edge, evaluates, samples, then clocks. No
/// thread; every instance has its own Verilator context.
class CoprocessorRtl final : public coprocessor::Device {
 public:
  explicit CoprocessorRtl(RtlLibrary::Handle library, Clocking clocking = Clocking::skip);
  ~CoprocessorRtl() override;

  void reset() override;
  void advance(uint64_t cycle) override;
  std::optional<uint64_t> next_event() const override;
  bool submit(uint64_t cycle, int32_t u, int32_t v, bool clip) override {
    return submit_of(0, cycle, u, v, clip);
  }
  bool submit_of(unsigned channel, uint64_t cycle, int32_t u, int32_t v, bool clip) override;
  unsigned channels() const override;
  coprocessor::RegisterAccess read(uint64_t cycle, uint32_t offset, bool debug) override;
  bool write(uint64_t cycle, uint32_t offset, uint32_t value) override;
  bool write_bytes(uint64_t cycle, uint32_t offset, uint32_t value, uint8_t strobes) override;
  bool interrupt() const override;
  bool idle() const override;
  const coprocessor::Nodes& nodes() const override;
  bool stage_nodes(unsigned stage, coprocessor::Nodes& nodes) const override;
  unsigned tick() const override;
  const char* kind() const override { return "rtl"; }
  void visit(Archive& archive) override;
  bool save_idle(coprocessor::IdleState& state) const override;
  bool load_idle(const coprocessor::IdleState& state) override;
  std::unique_ptr<Device> clone() const override;

  /// Every flip-flop of the design, as the library lists them.
  const capsoc_rtl_flip_flops* flip_flops() const;
  std::size_t flip_flop_count() const;
  /// Up to 64 bits of one, from bit 64 * `part` on, in the interval after the latest edge and
  /// whatever the pipeline does. Combinational logic follows.
  uint64_t get_flip_flops(uint32_t index, uint32_t part) const;
  void set_flip_flops(uint32_t index, uint32_t part, uint64_t value);
  /// From now on the bits of `mask` have these values after each edge. Slower: edge by edge. A copy
  /// holds nothing.
  void hold_flip_flops(uint32_t index, uint32_t part, uint64_t mask, uint64_t value);
  void release_flip_flops(uint32_t index, uint32_t part, uint64_t mask);

  /// Rising edges that were really made, of all that have passed.
  uint64_t clocks() const;

  /// From now on every clock goes to an FST file; a cycle is `period_ns` long there.
  std::optional<Error> open_waves(const std::string& file, unsigned period_ns = 40);
  /// Nodes that stand in the file next to the RTL's own.
  void show_model(const coprocessor::Nodes& nodes);
  void close_waves();

  /// Writes this instance's coverage, in Verilator's format; only with a library built for it.
  std::optional<Error> write_coverage(const std::string& file) const;

 private:
  class Pins;
  explicit CoprocessorRtl(std::unique_ptr<Pins> pins);
  std::unique_ptr<Pins> pins_;
};

}  // namespace capsoc::rtl
