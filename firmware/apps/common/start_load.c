#include "coprocessor.h"
#include "start_range.h"

void start_range_load(const struct start_range* range) {
  const struct start_values values = start_range_values(range);
  const struct coprocessor_parameters start = {
      .a1 = values.a1, .a2 = values.a2, .b1 = values.b1, .b2 = values.b2};
  coprocessor_load_parameters(&start);
}

void start_range_load_with_phase(const struct start_range* range) {
  int32_t words[6];
  start_range_coefficients(range, words);
  for (int i = 0; i < 6; ++i)
    coprocessor_set_coefficient((enum coprocessor_coefficient)i, (int64_t)words[i] * 32768);
}
