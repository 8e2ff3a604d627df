#include "error_table.h"

#include <math.h>
#include <stddef.h>

#define PI 3.14159265358979323846

enum { node_shift = 25, largest_value = (1 << 19) - 1 };

static const char too_large[] = "the error is larger than the table can take";

void error_table_add(struct error_table* table, uint32_t angle, int32_t residue) {
  const uint32_t node = (angle + (UINT32_C(1) << (node_shift - 1))) >> node_shift;
  table->sums[node % error_nodes] += residue;
  ++table->counts[node % error_nodes];
}

const char* error_table_nodes(const struct error_table* table, int32_t nodes[error_nodes]) {
  static double mean[error_nodes], cosine[error_nodes], value[error_nodes];
  for (int j = 0; j < error_nodes; ++j) {
    if (table->counts[j] < error_least_samples)
      return "a part of the turn has too few samples: turn slower or learn for more turns";
    mean[j] = (double)table->sums[j] / table->counts[j] / 256;
    cosine[j] = cos(2 * PI / error_nodes * j);
    value[j] = 0;
  }
  for (int order = 0; order <= error_orders; ++order) {
    double even = 0, odd = 0;
    for (int j = 0; j < error_nodes; ++j) {
      even += mean[j] * cosine[order * j % error_nodes];
      odd += mean[j] * cosine[(order * j + 3 * error_nodes / 4) % error_nodes];
    }
    const double z = PI / error_nodes * order;
    const double scale =
        order == 0 ? 1.0 / error_nodes : 2.0 / error_nodes * z / sin(z) * (1 + z * z / 4);
    for (int j = 0; j < error_nodes; ++j)
      value[j] += scale * (even * cosine[order * j % error_nodes] +
                           odd * cosine[(order * j + 3 * error_nodes / 4) % error_nodes]);
  }
  for (int j = 0; j < error_nodes; ++j) {
    if (fabs(value[j]) > largest_value) return too_large;
    nodes[j] = (int32_t)rint(value[j]);
  }
  return NULL;
}

const char* error_table_without_inertia(const int32_t first[error_nodes],
                                        int32_t second[error_nodes], double k) {
  for (int j = 0; j < error_nodes; ++j) {
    const double value = (k * second[j] - first[j]) / (k - 1);
    if (fabs(value) > largest_value) return too_large;
    second[j] = (int32_t)rint(value);
  }
  return NULL;
}
