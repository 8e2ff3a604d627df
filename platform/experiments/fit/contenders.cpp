#include "fit/contenders.h"

#include "identification/ellipse_fit.h"
#include "identification/peers.h"
#include "identification/training.h"

namespace capsoc::fit {
namespace {

using identification::Parameters;

Result<Parameters> trained(const Result<identification::Training>& training) {
  if (!training) return Error{training.error()};
  return training.value().parameters;
}

Result<Parameters> by_peer(identification::Peer peer, const identification::Samples& s) {
  const auto found = identification::identify_by(peer, s.u, s.v);
  if (!found) return Error{found.error()};
  return found.value().parameters;
}

}  // namespace

std::vector<Contender> contenders() {
  using identification::Samples;
  std::vector<Contender> all;
  const auto add = [&](const char* name, auto identify) {
    all.push_back({name, std::move(identify), false});
  };
  add("adam", [](const Samples& s) {
    return trained(identification::train_adam(s.u, s.v, identification::paper_start(s.u, s.v),
                                              identification::decaying_adam()));
  });
  add("lm", [](const Samples& s) {
    return trained(
        identification::train_levenberg_marquardt(s.u, s.v, identification::paper_start(s.u, s.v)));
  });
  add("heydemann", [](const Samples& s) { return identification::fit_heydemann(s.u, s.v); });
  add("taubin", [](const Samples& s) { return identification::fit_taubin(s.u, s.v); });
  add("direct", [](const Samples& s) { return identification::fit_direct(s.u, s.v); });
  for (const identification::Peer peer : identification::all_peers) {
    all.push_back({identification::to_string(peer),
                   [peer](const Samples& s) { return by_peer(peer, s); }, true});
  }
  return all;
}

}  // namespace capsoc::fit
