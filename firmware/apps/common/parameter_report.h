// The six parameters as text, the same in all applications (tests and scripts read it).
#ifndef CAPSOC_PARAMETER_REPORT_H
#define CAPSOC_PARAMETER_REPORT_H

#include <stdint.h>

#include "coprocessor.h"

// "t <seconds> s: a1 <word> a2 <word> b1 <word> b2 <word> beta <word> phi <word>\n", all decimal
// and signed; `seconds` is right-justified in four characters.
void print_progress(uint32_t seconds, const struct coprocessor_parameters* parameters);

// A heading and one line a parameter: name, machine word (signed decimal), number (fraction of full
// scale with 9 decimals, angles in rad within [-pi, pi)).
void print_parameter_table(const struct coprocessor_parameters* parameters);

#endif
