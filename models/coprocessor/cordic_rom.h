// Constants of both CORDICs. angle[i] = round(atan(2^-i) / 2pi * 2^bits); the gain of n stages is
// prod(1 / sqrt(1 + 4^-i)) = 0.6072529350088813 for n = 30 (28 differs in the 17th digit).
#pragma once

#include <array>
#include <cstdint>

namespace capsoc::coprocessor::cordic_rom {

inline constexpr std::array<int64_t, 30> angle_37 = {
    17179869184, 10141868980, 5358685036, 2720152196, 1365354594, 683342891, 341754828, 170887842,
    85445225,    42722775,    21361408,   10680707,   5340354,    2670177,   1335088,   667544,
    333772,      166886,      83443,      41722,      20861,      10430,     5215,      2608,
    1304,        652,         326,        163,        81,         41};

inline constexpr std::array<int64_t, 28> angle_32 = {
    536870912, 316933406, 167458907, 85004756, 42667331, 21354465, 10679838,
    5340245,   2670163,   1335087,   667544,   333772,   166886,   83443,
    41722,     20861,     10430,     5215,     2608,     1304,     652,
    326,       163,       81,        41,       20,       10,       5};

// round(gain * (2^31 - 1) * 2^5), round(gain * (2^31 - 1)), round(gain * 2^32)
inline constexpr int64_t rotation_start = 41730103921;
inline constexpr int64_t rotation_start_paper = 1304065748;
inline constexpr int64_t vectoring_gain = 2608131496;

}  // namespace capsoc::coprocessor::cordic_rom
