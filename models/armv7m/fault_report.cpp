#include "armv7m/fault_report.h"

namespace capsoc::armv7m {
namespace {

struct Bit {
  unsigned position;
  const char* text;
};

constexpr Bit cfsr_bits[] = {
    {0, "IACCVIOL: instruction fetch from memory that may not be executed"},
    {1, "DACCVIOL: data access that the MPU forbids"},
    {3, "MUNSTKERR: memory fault while unstacking on exception return"},
    {4, "MSTKERR: memory fault while stacking on exception entry"},
    {5, "MLSPERR: memory fault while saving floating-point state"},
    {7, "MMARVALID: MMFAR holds the address"},
    {8, "IBUSERR: bus error on an instruction fetch"},
    {9, "PRECISERR: bus error on a data access"},
    {10, "IMPRECISERR: bus error on a buffered write"},
    {11, "UNSTKERR: bus error while unstacking on exception return"},
    {12, "STKERR: bus error while stacking on exception entry"},
    {13, "LSPERR: bus error while saving floating-point state"},
    {15, "BFARVALID: BFAR holds the address"},
    {16, "UNDEFINSTR: undefined instruction"},
    {17, "INVSTATE: execution outside Thumb state (branch to an even address?)"},
    {18, "INVPC: illegal exception return"},
    {19, "NOCP: coprocessor instruction without a coprocessor"},
    {24, "UNALIGNED: unaligned access"},
    {25, "DIVBYZERO: division by zero"},
};
constexpr Bit hfsr_bits[] = {
    {1, "VECTTBL: the vector table could not be read"},
    {30, "FORCED: escalated from a fault that could not be taken"},
    {31, "DEBUGEVT: breakpoint without a debugger"},
};

template <unsigned n>
void describe(std::string& text, const Bit (&bits)[n], uint32_t value) {
  for (const Bit& bit : bits) {
    if (((value >> bit.position) & 1) == 0) continue;
    if (!text.empty()) text += "; ";
    text += bit.text;
  }
}

}  // namespace

std::string describe_cfsr(uint32_t cfsr, uint32_t hfsr) {
  constexpr uint32_t forced = 1u << 30;
  // Only faults leave a trace in CFSR.
  if (hfsr == forced && cfsr == 0) return "FORCED: escalated from an SVC that could not be taken";
  std::string text;
  describe(text, hfsr_bits, hfsr);
  describe(text, cfsr_bits, cfsr);
  return text.empty() ? "no fault" : text;
}

}  // namespace capsoc::armv7m
