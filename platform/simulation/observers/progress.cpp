#include "observers/progress.h"

#include "host/console.h"
#include "results/results.h"

namespace capsoc::run {

void Progress::update(double simulated_s, const metrics::ParameterWords& words) {
  // The host's clock is asked at every 64th sample only: it costs as much as the sample's
  // bookkeeping.
  if (!shown_ || ++calls_ % 64 != 0) return;
  const auto now = Clock::now();
  if (now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  const double wall = std::chrono::duration<double>(now - start_).count();
  const metrics::Parameters p = metrics::to_values(words);
  host::say(
      "\r{:7.1f} s  {:>5}x  a1 {:.6f}  a2 {:.6f}  b1 {:+.6f}  b2 {:+.6f}  beta {:+.6f}  "
      "phi {:+.6f} ",
      simulated_s, speed_of(simulated_s, wall), p.a1, p.a2, p.b1, p.b2, p.beta, p.phi);
}

void Progress::finish() {
  if (shown_ && calls_ > 0) host::say("\r{:110}\r", "");
}

}  // namespace capsoc::run
