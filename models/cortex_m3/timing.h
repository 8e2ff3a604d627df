#pragma once

#include <cstdint>

namespace capsoc::cortex_m3 {

/// Groups of instructions that take the same time (Cortex-M3 TRM, instruction set summary).
enum class CycleClass : uint8_t {
  alu,
  multiply_add,
  multiply_long,
  multiply_accumulate_long,
  divide,
  load,
  store,
  store_reg,
  dual,
  multiple,
  branch,
  table,
  barrier,
  system
};

/// Cycles in the table of the TRM with P, the refill of the pipeline, at two cycles. The cycles of
/// an instruction depend on nothing but itself, its operands and whether it branches, so every
/// executor counts alike: the pipelining of neighbouring loads (2 to 1) is left out, and a long
/// multiplication takes the middle of its range.
namespace timing {
constexpr unsigned pipeline_refill = 2;
constexpr unsigned exception_entry = 12;
constexpr unsigned exception_return = 10;
constexpr unsigned tail_chain = 6;
constexpr unsigned divide_most = 12;

constexpr unsigned cycles(CycleClass kind) {
  switch (kind) {
    case CycleClass::multiply_add:
      return 2;
    case CycleClass::multiply_long:
      return 4;
    case CycleClass::multiply_accumulate_long:
      return 6;
    case CycleClass::divide:
      return 2;
    case CycleClass::load:
      return 2;
    case CycleClass::store:
      return 1;  // goes to the write buffer
    case CycleClass::store_reg:
      return 2;
    case CycleClass::dual:
      return 3;
    case CycleClass::multiple:
      return 1;  // and one a register
    case CycleClass::table:
      return 2;
    case CycleClass::barrier:
      return 2;
    case CycleClass::system:
      return 2;
    default:
      return 1;
  }
}

/// Beyond the two cycles every division takes: the divider retires about four quotient bits a
/// cycle, so the time follows the difference of the operands' magnitudes.
inline unsigned divide_extra(uint32_t dividend, uint32_t divisor) {
  if (divisor == 0 || dividend < divisor) return 0;
  int difference = __builtin_clz(divisor) - __builtin_clz(dividend);
  return 1 + static_cast<unsigned>(difference) / 4;
}

/// Flash words that begin inside the instruction: each costs the region's wait states once.
constexpr unsigned words_fetched(uint32_t address, unsigned size) {
  return ((address & 2) == 0 || size == 4) ? 1 : 0;
}
}  // namespace timing
}  // namespace capsoc::cortex_m3
