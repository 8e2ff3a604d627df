#pragma once

#include "cortex_m3/alu.h"
#include "cortex_m3/core.h"
#include "cortex_m3/timing.h"

namespace capsoc::cortex_m3 {

/// The semantics of the operations, one static function each, in execute_*.cpp.
struct Execute {
  using Access = Core::Access;

  /// Sets the handlers of a step from its operation and operands.
  static void bind(Step& step);

  static Handler data_handler(const DecodedOp& op);
  static Handler memory_handler(const DecodedOp& op);
  static Handler branch_handler(const DecodedOp& op);
  static Handler system_handler(const DecodedOp& op);

  /// Most cycles the step can take beyond DecodedOp::cycles, without device accesses.
  static uint32_t most_extra_cycles(const DecodedOp& op, uint32_t largest_wait);

  static void set_nz(Core& c, uint32_t value) { c.n_ = c.z_ = value; }
  static uint32_t read(const Core& c, const Step& op, unsigned n) {
    return n == 15 ? pc_of(op) : c.r_[n];
  }

  // Members of the operation families; see the sources for what each does.
  template <typename F, bool immediate, bool shifted, bool flags>
  static bool data(Core&, const Step&);
  template <ShiftType type, bool flags>
  static bool shift_register(Core&, const Step&);
  template <typename T, bool is_signed, Addressing mode>
  static bool load_one(Core&, const Step&);
  template <typename T, Addressing mode>
  static bool store_one(Core&, const Step&);
  template <unsigned condition>
  static bool branch_if(Core&, const Step&);
  template <typename T>
  static bool load_exclusive(Core&, const Step&);
  template <typename T>
  static bool store_exclusive(Core&, const Step&);
  static bool load_multiple(Core&, const Step&, uint32_t address, uint32_t written_back);
  static bool store_multiple(Core&, const Step&, uint32_t address, uint32_t written_back);
  static bool take_branch(Core&, uint32_t target);
  static bool table_branch(Core&, const Step&, uint32_t offset, Access access);
  static bool conditional(Core&, const Step&);
  static bool align_sp(Core&, const Step&);
  static Handler unconditional_handler(const DecodedOp& op);

#define OPERATION(name, ends) static bool name(Core&, const Step&);
#include "cortex_m3/operations.def"
#undef OPERATION
};

}  // namespace capsoc::cortex_m3
