// How exact the CSFN identifier is, on generated records: what `capsoc fit --tables` prints.
#pragma once

#include <iosfwd>

namespace capsoc::fit {

/// Prints three tables: Table 1 of the CSFN paper, the angle errors of every method on shuffled,
/// partial-arc, noisy and 12-bit records, and those of the harmonics next to their statistical
/// bounds. Seeds are fixed, the text is the same on every run. Returns the number of figures that
/// miss their bound: 0 is the expected result.
int print_tables(std::ostream& out);

/// The methods that the papers name (identification/peers.h) next to the CSFN's and the closed
/// forms, on the same records and by the same clock. The errors are the same on every run, the
/// times are this host's. Returns the number of methods that miss a bound of their errors.
int print_peers(std::ostream& out);

}  // namespace capsoc::fit
