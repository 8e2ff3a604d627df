// The angle's error over the angle, learnt at constant speed, as the nodes of the coprocessor's
// harmonic correction (docs/reference/coprocessor.md).
#ifndef CAPSOC_ERROR_TABLE_H
#define CAPSOC_ERROR_TABLE_H

#include <stdbool.h>
#include <stdint.h>

enum { error_nodes = 128, error_least_samples = 4, error_orders = 10 };

// Residues by the node that their angle is nearest to. Starts as {0}.
struct error_table {
  int64_t sums[error_nodes];  // 2^-32 turn
  uint32_t counts[error_nodes];
};

// ANGLE and RESIDUE of a sample, 2^-32 turn.
void error_table_add(struct error_table* table, uint32_t angle, int32_t residue);

// Computes the nodes, 2^-24 turn, from the orders h = 0 to 10 of the means. Each order is scaled by
// two factors, with z = pi h / 128: z / sin z undoes the mean over a node's width, and 1 + z^2 / 4
// adds half of the error of a chord. Returns null, or a sentence if there are no nodes: one has
// fewer than four samples, or a value does not fit.
const char* error_table_nodes(const struct error_table* table, int32_t nodes[error_nodes]);

// Removes from `second` the shaft's uneven motion by inertia, which falls with the square of the
// speed: (k second - first) / (k - 1). `second` was learnt at sqrt(k) times the speed of `first`,
// with the same coefficients. Returns null, or a sentence if a value does not fit.
const char* error_table_without_inertia(const int32_t first[error_nodes],
                                        int32_t second[error_nodes], double k);

#endif
