// How fast the processor model is, next to qemu-system-arm on the same programs in the same run.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "base/data_table.h"

namespace capsoc::bench {

struct CpuBench {
  std::string program;                ///< capsoc itself, which runs each kernel in a process
  std::vector<std::string> firmware;  ///< ELF files
  std::string profile = "m3";         ///< of the processor: m3, m4 or m4f, which QEMU has boards of
  unsigned repeat = 3;                ///< runs, of which the best counts
  std::string quantum_ns = "1000000";
  double least_ratio = 0;  ///< of QEMU with -icount; 0: no requirement
};

/// Prints a line for each program and the geometric means. 0, or 1 when a program failed, a
/// checksum differs from QEMU's, or a mean ratio is below least_ratio. Times are processor time of
/// the whole process, start-up included. `table` takes the rows: program, instructions, cpi, mips,
/// qemu_mips, qemu_ratio, icount_mips, icount_ratio, translator_mips,
/// translator_ratio, translator_icount_ratio, verdict, and the slowest run's mips_least,
/// qemu_mips_least, icount_mips_least, translator_mips_least; the last row holds the means.
int run_cpu_bench(const CpuBench& bench, std::ostream& out, DataTable* table = nullptr);

}  // namespace capsoc::bench
