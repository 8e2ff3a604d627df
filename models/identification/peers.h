// The methods that both papers name in addition to their own, for comparison on the same records.
// Each is our reading of what it is named after, in its plainest form, and none of them is used for
// an answer.
#pragma once

#include <array>
#include <cstdint>

#include "base/result.h"
#include "identification/samples.h"

namespace capsoc::identification {

enum class Peer {
  gradient,   ///< the CSFN by stochastic gradient descent at a constant rate
  momentum,   ///< the same with momentum (Qian, Neural Netw. 12, 1999)
  recursive,  ///< the ellipse by recursive weighted least squares (Hoseinnezhad, IEEE Trans.
              ///< Ind. Electron. 54, 2007): weights that forget
  fourier,    ///< the first line of both channels' spectra (Bunte and Beineke, IEEE Trans. Ind.
              ///< Electron. 51, 2004)
  observer,   ///< a state observer of sine, quadrature and offset (Zhang and Wu, Meas. Sci.
              ///< Technol. 25, 2014)
  two_step,   ///< two gradient estimators: speed and offset, then amplitude and phase (Wu and
              ///< Li, IEEE Sens. J. 18, 2018)
};

inline constexpr std::array all_peers = {Peer::gradient, Peer::momentum, Peer::recursive,
                                         Peer::fourier,  Peer::observer, Peer::two_step};

/// "sgd", "momentum", "rls", "fourier", "observer", "two-step".
const char* to_string(Peer peer);

/// Whether it needs the samples in order of time and a shaft that turns steadily.
bool needs_order(Peer peer);

/// What it identified, canonical, at the record's end.
struct PeerAnswer {
  Parameters parameters;
  int steps = 0;  ///< updates of the parameters; 0 for a closed form
};

/// Error: check_samples(), a method that ran away or found no ellipse, or samples that are not what
/// it needs: in order of time, three whole turns or more at a steady speed.
Result<PeerAnswer> identify_by(Peer peer, const Channel& u, const Channel& v, uint64_t seed = 1);

}  // namespace capsoc::identification
