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

// Nodes, 2^-24 turn: the orders 0 to 10 of the means, each enlarged by what the mean over a node's
// width takes off it (z / sin z, z = pi h / 128) and by half of what a chord misses of an arc
// (1 + z^2 / 4). Null, or a sentence if there are none: a node has fewer than four samples, or a
// value does not fit.
const char* error_table_nodes(const struct error_table* table, int32_t nodes[error_nodes]);

// Of the tables of two speeds, `second` at sqrt(k) times the speed of `first`, with the same
// coefficients: what is left of `second` without the shaft's uneven motion by inertia, which falls
// with the square of the speed: (k second - first) / (k - 1). Null, or a sentence: it does not fit.
const char* error_table_without_inertia(const int32_t first[error_nodes],
                                        int32_t second[error_nodes], double k);

#endif
