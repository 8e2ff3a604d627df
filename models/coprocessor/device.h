// What stands behind the coprocessor's bus target: the C++ model, the Verilated RTL, or both in
// lockstep. Plain C++: time is a PCLK edge number that the caller hands in and that never decreases
// from call to call.
//
// At one edge things happen in the order of docs/coprocessor.md: ends and starts of ticks, then at
// most one submit(), then at most one write(). A read() at edge c sees the registers as edge c left
// them; after it, or after interrupt(), idle() or nodes(), edge c is closed and the next submit()
// or write() must name a later one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace capsoc::coprocessor {

// The nodes of the last sample whose results were committed, for lockstep comparison. Raw words:
// signed formats sign-extended, unsigned ones zero-extended.
struct Nodes {
  int64_t u = 0, v = 0, cal_s = 0, cal_c = 0, amplitude = 0;  // Q1.31
  int64_t relative = 0, reference_phase = 0, residue = 0;     // 2^-32 turn
  int64_t sine = 0, cosine = 0, error_u = 0, error_v = 0;     // Q1.31
  // Registers as the commit leaves them.
  int64_t phase = 0, frequency = 0;                              // 2^-48 turn
  int64_t a_u = 0, b_u = 0, c_u = 0, a_v = 0, b_v = 0, c_v = 0;  // Q2.46
  int64_t a1 = 0, a2 = 0, b1 = 0, b2 = 0, beta = 0, phi = 0, angle = 0;
  int64_t error_average = 0, status = 0, flags = 0, samples = 0;
};

struct NamedNode {
  const char* name;
  int64_t Nodes::*value;
};
// Every node of Nodes by name, in pipeline order.
const std::array<NamedNode, 31>& node_names();

struct RegisterAccess {
  bool ok = false;  // false: no register there (PSLVERR)
  uint32_t value = 0;
};

class Device {
 public:
  virtual ~Device() = default;

  // Power-on state; time goes on.
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

  // 32-bit register access at a byte offset. debug: no side effect, LO registers show the present
  // value instead of the latched one.
  virtual RegisterAccess read(uint64_t cycle, uint32_t offset, bool debug) = 0;
  // false: unmapped. A write that has no effect (read-only, reserved value) is true and explained
  // by guest_error().
  virtual bool write(uint64_t cycle, uint32_t offset, uint32_t value) = 0;

  // What was wrong with the last write, for the log; empty if nothing was.
  virtual std::string_view guest_error() const = 0;

  virtual bool interrupt() const = 0;
  virtual bool idle() const = 0;
  virtual const Nodes& nodes() const = 0;

 protected:
  Device() = default;
  Device(const Device&) = default;
  Device& operator=(const Device&) = default;
};

}  // namespace capsoc::coprocessor
