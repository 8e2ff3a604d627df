// What stands at the coprocessor's bus target: the C++ model, the Verilated RTL, or both in
// lockstep. Plain C++: time is a PCLK edge number that the caller hands in and that never decreases
// from call to call.
//
// What is submitted or written "at edge c" is on the pins in the interval before edge c and acts at
// that edge. What is read "at edge c" is on the pins in the interval after edge c and shows the
// state after it. The order at one edge is that of docs/reference/coprocessor.md: ends and starts
// of ticks, then at most one submit(), then at most one write(). After a read(), or after
// next_event(), interrupt(), idle(), nodes() or stage_nodes(), edge c is closed: the next submit()
// or write() must name a later one. The bus carries one transfer an interval: after a read() that
// is not for debugging at edge c the next read() is at c + 1 and the next write() at c + 2 at the
// earliest.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "base/archive.h"
#include "coprocessor/nodes.h"
#include "coprocessor/sequencer.h"

namespace capsoc::coprocessor {

struct IdleState;

inline constexpr uint8_t all_strobes = 0xF;

struct RegisterAccess {
  bool ok = false;  // false: no register there (PSLVERR)
  uint32_t value = 0;
};

class Device {
 public:
  virtual ~Device() = default;

  // Power-on state; time continues.
  virtual void reset() = 0;

  // Runs the pipeline up to and including edge `cycle`. The functions below that take a cycle do
  // this first.
  virtual void advance(uint64_t cycle) = 0;

  // The edge of the next commit, end of a load or fall of BUSY; none when idle.
  virtual std::optional<uint64_t> next_event() const = 0;

  // The sample port of the ADC stream (Q1.31 words). Returns whether the sample was latched: not
  // while CTRL.ADC is 0 (ignored), not while another sample waits (dropped, counted, flagged
  // EARLY).
  virtual bool submit(uint64_t cycle, int32_t u, int32_t v, bool clip) = 0;

  // The same for a sample of one of channels(); false of others. A device of one channel has no
  // more than submit().
  virtual bool submit_of(unsigned channel, uint64_t cycle, int32_t u, int32_t v, bool clip) {
    if (channel == 0) return submit(cycle, u, v, clip);
    advance(cycle);
    return false;
  }
  virtual unsigned channels() const { return 1; }

  // 32-bit register access at a byte offset. debug: no side effect, LO registers show the present
  // value instead of the latched one.
  virtual RegisterAccess read(uint64_t cycle, uint32_t offset, bool debug) = 0;
  // false: unmapped. A write that has no effect (read-only, reserved value) is true and explained
  // by write_complaint() (register_map.h).
  virtual bool write(uint64_t cycle, uint32_t offset, uint32_t value) = 0;
  // The same with PSTRB: bit i says that byte i of the word is written. false, and no effect,
  // unless all four are.
  virtual bool write_bytes(uint64_t cycle, uint32_t offset, uint32_t value, uint8_t strobes) {
    if (strobes == all_strobes) return write(cycle, offset, value);
    advance(cycle);
    return false;
  }

  virtual bool interrupt() const = 0;
  virtual bool idle() const = 0;
  // All nodes of the last sample whose results were committed.
  virtual const Nodes& nodes() const = 0;

  // Sets those nodes of `nodes` that stage `stage` makes, if a sample is in it and this is the last
  // interval of its tick; else returns false. A device that cannot look inside always does.
  virtual bool stage_nodes(unsigned /*stage*/, Nodes& /*nodes*/) const { return false; }

  // Cycles of a tick: always the same of one device.
  virtual unsigned tick() const { return tick_cycles; }

  // What it is, in the words of --coprocessor.
  virtual const char* kind() const { return "tlm"; }

  // The state, between two edges: everything that was asked for at the last one is done. A device
  // that cannot be saved refuses.
  virtual void visit(Archive& archive) { archive.refuse("cannot be saved"); }

  // The same while it is idle, in the form of all devices (coprocessor/idle_state.h): what one has
  // saved another continues from. save_idle: false while it computes. load_idle: reset comes first.
  // Both are false for a device that cannot do it.
  virtual bool save_idle(IdleState& /*state*/) const { return false; }
  virtual bool load_idle(const IdleState& /*state*/) { return false; }

  // Lets `change` change the state while the device is idle; it returns whether it did. False: the
  // device computes, or cannot do it, and nothing was changed.
  using IdleChange = std::function<bool(IdleState& state)>;
  virtual bool change_idle(const IdleChange& change);

  // The same device in the same state; null if it cannot be copied.
  virtual std::unique_ptr<Device> clone() const { return nullptr; }

 protected:
  Device() = default;
  Device(const Device&) = default;
  Device& operator=(const Device&) = default;
};

}  // namespace capsoc::coprocessor
