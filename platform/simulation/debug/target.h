// Interface of the protocol to a processor and its memory, so that it can be tested without one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace capsoc::debug {

/// What `Z` packets set; the numbers are the protocol's.
enum class StopPoint : uint8_t {
  software_breakpoint = 0,
  hardware_breakpoint = 1,
  write_watchpoint = 2,
  read_watchpoint = 3,
  access_watchpoint = 4
};

/// True if it stops before an instruction; the other kinds watch data.
constexpr bool is_breakpoint(StopPoint point) {
  return point == StopPoint::software_breakpoint || point == StopPoint::hardware_breakpoint;
}

/// Why the processor is halted.
struct StopCause {
  enum class Kind : uint8_t {
    attached,  ///< by a debugger that connected, or after a reset
    step,
    interrupted,  ///< Ctrl-C, `monitor halt`
    breakpoint,
    watchpoint,
    bkpt_instruction,
    lockup,
    history_begin,  ///< the beginning of the history
    history_end,    ///< the present, from which it went back
    failure         ///< the run is over, and did not pass
  };
  Kind kind = Kind::attached;
  StopPoint point = StopPoint::software_breakpoint;  ///< with breakpoint and watchpoint
  uint32_t address = 0;                              ///< with watchpoint: what was accessed
};

/// One register of the target description.
struct Register {
  const char* name;
  unsigned bits;
};

/// In the order of their numbers: r0 to r15, xpsr (GDB's m-profile), the m-system group, then what
/// is an FPU's: s0 to s31 and fpscr.
constexpr std::array<Register, 56> registers = {
    {{"r0", 32},  {"r1", 32},     {"r2", 32},     {"r3", 32},       {"r4", 32},     {"r5", 32},
     {"r6", 32},  {"r7", 32},     {"r8", 32},     {"r9", 32},       {"r10", 32},    {"r11", 32},
     {"r12", 32}, {"sp", 32},     {"lr", 32},     {"pc", 32},       {"xpsr", 32},   {"msp", 32},
     {"psp", 32}, {"primask", 8}, {"basepri", 8}, {"faultmask", 8}, {"control", 8}, {"s0", 32},
     {"s1", 32},  {"s2", 32},     {"s3", 32},     {"s4", 32},       {"s5", 32},     {"s6", 32},
     {"s7", 32},  {"s8", 32},     {"s9", 32},     {"s10", 32},      {"s11", 32},    {"s12", 32},
     {"s13", 32}, {"s14", 32},    {"s15", 32},    {"s16", 32},      {"s17", 32},    {"s18", 32},
     {"s19", 32}, {"s20", 32},    {"s21", 32},    {"s22", 32},      {"s23", 32},    {"s24", 32},
     {"s25", 32}, {"s26", 32},    {"s27", 32},    {"s28", 32},      {"s29", 32},    {"s30", 32},
     {"s31", 32}, {"fpscr", 32}}};
constexpr unsigned first_system_register = 17, first_fpu_register = 23, fpu_singles = 32;
/// GDB's number of xpsr (the obsolete FPA registers are between pc and it).
constexpr unsigned xpsr_number = 25;
/// GDB has an FPU as d0 to d15 and fpscr.
constexpr unsigned first_double_number = 32, fpscr_number = first_double_number + fpu_singles / 2;

/// A range of addresses; its end may be that of the address space.
struct MemoryRange {
  uint64_t start, length;
};

/// The processor as a debugger sees it. Nothing takes simulated time.
class Target {
 public:
  virtual ~Target() = default;

  /// As compilers have it.
  virtual std::string processor() { return "cortex-m3"; }
  /// Whether the processor has one of `registers`.
  virtual bool has_register(unsigned /*index*/) { return true; }
  /// `index` into `registers`, of one that it has.
  virtual uint32_t read_register(unsigned index) = 0;
  virtual void write_register(unsigned index, uint32_t value) = 0;
  /// Without side effects. Returns at most `size` bytes from `address`, up to the first unreadable
  /// one.
  virtual std::string read_memory(uint32_t address, uint32_t size) = 0;
  /// Devices get a bus write. False if any byte has no memory or device.
  virtual bool write_memory(uint32_t address, const std::string& bytes) = 0;
  /// False for what cannot be watched. The size of a breakpoint is 0.
  virtual bool set(StopPoint kind, uint32_t address, uint32_t size) = 0;
  virtual void clear(StopPoint kind, uint32_t address, uint32_t size) = 0;
  /// Resets the system.
  virtual void reset() = 0;
  /// Saves the whole state to a file. Returns a line for the console with the outcome.
  virtual std::string save(const std::string& /*file*/) { return "nothing can be saved here\n"; }
  /// What the processor does, in words, for the thread list.
  virtual std::string state() = 0;
  /// Ranges that can be read and written, in any order and without overlap; what is between them
  /// is a hole.
  virtual std::vector<MemoryRange> memory_ranges() = 0;
  /// Enables or disables stimulus ports of the ITM (bit n is port n). Returns a line for the
  /// console that says where their text is, "" if it is shown.
  virtual std::string show_stimulus(uint32_t /*ports*/, bool /*on*/) {
    return "there is no ITM here\n";
  }
  /// Whether it can be resumed backwards.
  virtual bool has_history() const { return false; }
  /// Answer to a `monitor` command that only this target has; empty: no such command.
  virtual std::optional<std::string> command(const std::string& /*line*/) { return std::nullopt; }
  /// Lines on these commands for `monitor help`.
  virtual std::string command_help() const { return ""; }
};

/// How a client wants the processor to continue.
struct Resume {
  enum class Kind : uint8_t { run, step, range, step_back, run_back };
  Kind kind = Kind::run;
  uint32_t range_start = 0, range_end = 0;  ///< range: step while start <= pc < end
};

}  // namespace capsoc::debug
