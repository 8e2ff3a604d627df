// What a recording's own angle says of its channels: an encoder next to a sensor has a zero and its
// own direction.
#pragma once

#include <optional>
#include <string>

#include "sensor/source.h"

namespace capsoc::metrics {

/// By least squares of both channels over sine and cosine of the recorded angle.
struct TruthAlignment {
  /// Argument of the sine of channel U where the recorded angle is 0, turns, -0.5 to 0.5.
  double zero_turns = 0;
  /// The channels turn the other way round: V = a2 cos(angle + beta) with |beta| beyond a quarter
  /// turn, or swapped, or inverted.
  bool reversed = false;
};

/// Beyond this the zero is the encoder's own, and is taken off; a sensor's errors stay below it.
inline constexpr double own_zero_turns = 10.0 / 360;

/// Nothing for a described signal, where an angle is missing, or where the channels do not turn
/// with the recorded angle. Rewinds the source.
std::optional<TruthAlignment> recorded_alignment(sensor::Source& source);

/// A sentence, beginning with the file's name, where the recorded angle's zero is taken off.
std::optional<std::string> own_zero(const std::string& file,
                                    const std::optional<TruthAlignment>& alignment);

}  // namespace capsoc::metrics
