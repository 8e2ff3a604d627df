// Harmonic correction (docs/reference/coprocessor.md): a table of the angle's error over the
// sensor's angle, 128 nodes with straight lines between them. Harmonics of the sensor stand in it.
#pragma once

#include <array>
#include <cstdint>

namespace capsoc::coprocessor {

inline constexpr unsigned correction_nodes = 128;

// s20, 2^-24 turn: by what the relative angle is too large at i / 128 turn of the sensor's angle.
using CorrectionTable = std::array<int32_t, correction_nodes>;

// A bit for each node.
using NodeBits = std::array<uint64_t, correction_nodes / 64>;

// Whether a node whose bit is set in `of` has a part in the correction at relative angle and phi.
bool reads_one(const NodeBits& of, uint32_t relative, uint32_t phi);

// The correction at relative angle and phi (both 2^-32 turn): s20, 2^-24 turn.
int32_t correction_at(const CorrectionTable& table, uint32_t relative, uint32_t phi);

// The relative angle without it, 2^-32 turn.
uint32_t corrected_angle(const CorrectionTable& table, uint32_t relative, uint32_t phi);

}  // namespace capsoc::coprocessor
