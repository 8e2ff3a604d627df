// Constants of mathematics and of the fixed-point formats, once.
#pragma once

namespace capsoc {

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double two_pi = 2 * pi;
inline constexpr double radians_per_degree = pi / 180;
inline constexpr double degrees_per_radian = 57.295779513082320877;

/// One in Q31, and one turn in 2^-32 turn.
inline constexpr double q31 = 0x1p31;
inline constexpr double q32 = 0x1p32;

}  // namespace capsoc
