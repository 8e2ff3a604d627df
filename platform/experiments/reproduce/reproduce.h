#pragma once

#include <array>
#include <iosfwd>
#include <string>
#include <vector>

#include "reproduce/report.h"
#include "reproduce/synthesis.h"

namespace capsoc::reproduce {

/// The files of the folder of traces that the tables are made from.
inline constexpr std::array needed_traces = {"soc_experiment.toml", "csfn_eq.toml", "csfn_h3.toml",
                                             "csfn_experiment.toml"};

/// Prints the figures of both papers next to ours, with a sentence wherever the two differ. Every
/// row of Tables 1 to 6 of the SoC paper is compared with the double-precision LMSED, Table 8 and
/// Figures 13 and 14 with the coprocessor model's paper arithmetic. The experiments of both papers
/// (SoC: Tables 9 and 10, CSFN: Table 2, and its simulations) run on the traces of the folder
/// `traces`. Every random record has a fixed seed, so the text is the same on every run. Returns
/// the number of rows that should agree with the paper, by what is known about it, and do not: 0 is
/// the expected result. `chosen`: only the tables with these ids of table_names(), empty: all.
/// `tables` takes the rows. `synthesis`: our side of Table 7.
int reproduce_tables(std::ostream& out, const std::string& traces,
                     const std::vector<std::string>& chosen = {},
                     std::vector<DataTable>* tables = nullptr, const Synthesis& synthesis = {});

}  // namespace capsoc::reproduce
