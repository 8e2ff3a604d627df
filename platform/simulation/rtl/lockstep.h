// Two devices side by side, model and RTL, with private copies of every sample and transaction.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "coprocessor/device.h"

namespace capsoc::rtl {

/// The first difference between the sides.
struct Difference {
  uint64_t cycle = 0;      ///< PCLK edge
  std::string what;        ///< "read of 0x0c0 (ANGLE)", "interrupt", "node sine of T2", ...
  std::string model, rtl;  ///< both values, in hexadecimal
  std::string node;        ///< the node that went wrong first in pipeline order; "" if none did
  std::string registers;   ///< those that differ, too, with both values, of a difference at a pin
};

/// One call of the Device interface, as it is replayed.
struct Operation {
  enum class Kind { sample, write, read, debug_read, reset };
  Kind kind = Kind::sample;
  uint64_t cycle = 0;
  uint32_t offset_or_u = 0, value_or_v = 0;
  bool clip = false;
  unsigned channel = 0;                        ///< of a sample
  uint8_t strobes = coprocessor::all_strobes;  ///< of a write
};

/// Values of a node on both sides, one for each clock.
struct NodeHistory {
  std::string name;
  std::vector<double> model, rtl;  ///< one value a clock, in the unit of the node's format
};

/// The clocks around a difference.
struct History {
  uint64_t first_cycle = 0;
  std::vector<NodeHistory> nodes;  ///< the node that went wrong first, then others that differ
};

/// "0x0c0 (ANGLE)".
std::string register_name(uint32_t offset);
/// Text of an operation, as the report prints it.
std::string describe(const Operation& operation);

/// Compares read data, responses, interrupt edges with their cycle, next event, idle, every node at
/// the end of its tick, every register at each commit and the coefficients that a LOAD writes.
/// Answers with the model's values; stops comparing after the first difference.
class Lockstep final : public coprocessor::Device {
 public:
  Lockstep(std::unique_ptr<Device> model, std::unique_ptr<Device> rtl);
  ~Lockstep() override;

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
  unsigned tick() const override;
  const char* kind() const override { return "lockstep"; }
  void visit(Archive& archive) override;
  bool save_idle(coprocessor::IdleState& state) const override;
  bool load_idle(const coprocessor::IdleState& state) override;
  /// Changes each side separately: a difference remains.
  bool change_idle(const IdleChange& change) override;

  /// One side, for example to inject a fault that the comparison has to find. Closes the present
  /// edge first.
  Device& model();
  Device& rtl();

  const std::optional<Difference>& difference() const;
  /// Runs once, at the first difference.
  void on_difference(std::function<void()> callback);

  /// Report of the difference and of the last 16 accesses and samples before it, as several lines
  /// of text. `command` reproduces it; `cycle_ns` turns cycles into time.
  std::string report(const std::string& command, double cycle_ns = 40) const;
  /// Simulates the clocks around the difference again and writes both sides into one FST file. Does
  /// nothing without a difference, or if the sides cannot be copied.
  std::optional<Error> write_waves(const std::string& file) const;

  /// The same clocks as numbers, from `before` clocks ahead of the difference to `after` after it,
  /// of at most `most` nodes. Empty without a difference or if the sides cannot be copied.
  History history(uint64_t before, uint64_t after, std::size_t most) const;

  /// How much was compared.
  struct Counters {
    uint64_t samples = 0, reads = 0, writes = 0, commits = 0, nodes = 0, interrupt_edges = 0;

    void visit(Archive& archive);
  };
  const Counters& counters() const;

 private:
  class Pair;
  std::unique_ptr<Pair> pair_;
};

}  // namespace capsoc::rtl
