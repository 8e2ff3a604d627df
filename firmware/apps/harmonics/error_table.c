#include "error_table.h"

#include <math.h>
#include <stddef.h>

#define PI 3.14159265358979323846

enum { node_shift = 25, largest_value = (1 << 19) - 1, longest_gap = 2 };

static const char too_large[] = "the error is larger than the table can take";

void error_table_add(struct error_table* table, uint32_t angle, int32_t residue) {
  const uint32_t node = (angle + (UINT32_C(1) << (node_shift - 1))) >> node_shift;
  table->sums[node % error_nodes] += residue;
  ++table->counts[node % error_nodes];
}

static bool enough(const struct error_table* table, int node) {
  return table->counts[node % error_nodes] >= error_least_samples;
}

// Mean residue of the samples at each node. A small signal of few bits leaves out a node or two,
// however many turns there are: those are between their neighbours. False if there are more in a
// row.
static bool means(const struct error_table* table, double mean[error_nodes]) {
  for (int j = 0; j < error_nodes; ++j)
    if (enough(table, j)) mean[j] = (double)table->sums[j] / table->counts[j] / 256;
  for (int j = 0; j < error_nodes; ++j) {
    if (enough(table, j)) continue;
    int before = 1, after = 1;
    while (before <= longest_gap && !enough(table, j + error_nodes - before)) ++before;
    while (after <= longest_gap && !enough(table, j + after)) ++after;
    if (before + after - 1 > longest_gap) return false;
    const double left = mean[(j + error_nodes - before) % error_nodes];
    const double right = mean[(j + after) % error_nodes];
    mean[j] = (left * after + right * before) / (before + after);
  }
  return true;
}

const char* error_table_nodes(const struct error_table* table, int32_t nodes[error_nodes]) {
  static double mean[error_nodes], cosine[error_nodes], value[error_nodes];
  if (!means(table, mean))
    return "a part of the turn has too few samples: turn slower or learn for more turns";
  for (int j = 0; j < error_nodes; ++j) {
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
