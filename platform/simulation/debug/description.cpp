#include "debug/description.h"

#include <fmt/format.h>

#include <algorithm>

namespace capsoc::debug {
namespace {

std::string feature(Target& target, const char* name, unsigned first, unsigned last) {
  std::string text = fmt::format("<feature name=\"{}\">\n", name);
  for (unsigned i = first; i < last; ++i) {
    if (!target.has_register(i)) continue;
    const Register& r = registers[i];
    const std::string n = r.name;
    const char* type = n == "pc"                               ? "code_ptr"
                       : n == "sp" || n == "msp" || n == "psp" ? "data_ptr"
                                                               : "int";
    const unsigned number = i < 16 ? i : xpsr_number + (i - 16);
    text += fmt::format("<reg name=\"{}\" bitsize=\"{}\" regnum=\"{}\" type=\"{}\"/>\n", r.name,
                        r.bits, number, r.bits == 8 ? "int8" : type);
  }
  return text + "</feature>\n";
}

/// The double-precision registers, of which GDB and LLDB make the others, and fpscr.
std::string fpu_feature(Target& target) {
  if (!target.has_register(first_fpu_register)) return "";
  std::string text = "<feature name=\"org.gnu.gdb.arm.vfp\">\n";
  for (unsigned n = 0; n < fpu_singles / 2; ++n)
    text += fmt::format("<reg name=\"d{}\" bitsize=\"64\" regnum=\"{}\" type=\"ieee_double\"/>\n",
                        n, first_double_number + n);
  return text + fmt::format(
                    "<reg name=\"fpscr\" bitsize=\"32\" regnum=\"{}\" type=\"int\" "
                    "group=\"float\"/>\n</feature>\n",
                    fpscr_number);
}

}  // namespace

std::string target_description(Target& target) {
  return "<?xml version=\"1.0\"?>\n<!DOCTYPE target SYSTEM \"gdb-target.dtd\">\n"
         "<target version=\"1.0\">\n<architecture>arm</architecture>\n" +
         feature(target, "org.gnu.gdb.arm.m-profile", 0, first_system_register) +
         feature(target, "org.gnu.gdb.arm.m-system", first_system_register, first_fpu_register) +
         fpu_feature(target) + "</target>\n";
}

std::string memory_map(const std::vector<MemoryRange>& ranges) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE memory-map PUBLIC \"+//IDN gnu.org//DTD GDB Memory Map "
      "V1.0//EN\" \"http://sourceware.org/gdb/gdb-memory-map.dtd\">\n<memory-map>\n";
  for (const MemoryRange& range : ranges)
    text += fmt::format("<memory type=\"ram\" start=\"{:#x}\" length=\"{:#x}\"/>\n", range.start,
                        range.length);
  return text + "</memory-map>\n";
}

std::string region_info(std::vector<MemoryRange> ranges, uint32_t address) {
  std::sort(ranges.begin(), ranges.end(),
            [](const MemoryRange& a, const MemoryRange& b) { return a.start < b.start; });
  uint64_t hole = 0, end = uint64_t{1} << 32U;
  for (const MemoryRange& range : ranges) {
    if (range.start > address) {
      end = range.start;
      break;
    }
    hole = range.start + range.length;
    if (address < hole)
      return fmt::format("start:{:x};size:{:x};permissions:rwx;", range.start, range.length);
  }
  return fmt::format("start:{:x};size:{:x};", hole, end - hole);
}

std::string thread_list(Target& target) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<threads>\n<thread id=\"1\" core=\"0\" "
      "name=\"{}\">{}</thread>\n</threads>\n",
      target.processor(), target.state());
}

}  // namespace capsoc::debug
