#include "fit/contenders.h"

#include "csfn/ellipse_fit.h"
#include "csfn/peers.h"
#include "csfn/training.h"

namespace capsoc::fit {
namespace {

using csfn::Parameters;

Result<Parameters> trained(const Result<csfn::Training>& training) {
  if (!training) return Error{training.error()};
  return training.value().parameters;
}

Result<Parameters> by_peer(csfn::Peer peer, const csfn::Samples& s) {
  const auto found = csfn::identify_by(peer, s.u, s.v);
  if (!found) return Error{found.error()};
  return found.value().parameters;
}

}  // namespace

std::vector<Contender> contenders() {
  using csfn::Samples;
  std::vector<Contender> all;
  const auto add = [&](const char* name, auto identify) {
    all.push_back({name, std::move(identify), false});
  };
  add("adam", [](const Samples& s) {
    return trained(csfn::train_adam(s.u, s.v, csfn::paper_start(s.u, s.v), csfn::decaying_adam()));
  });
  add("lm", [](const Samples& s) {
    return trained(csfn::train_levenberg_marquardt(s.u, s.v, csfn::paper_start(s.u, s.v)));
  });
  add("heydemann", [](const Samples& s) { return csfn::fit_heydemann(s.u, s.v); });
  add("taubin", [](const Samples& s) { return csfn::fit_taubin(s.u, s.v); });
  add("direct", [](const Samples& s) { return csfn::fit_direct(s.u, s.v); });
  for (const csfn::Peer peer : csfn::all_peers) {
    all.push_back(
        {csfn::to_string(peer), [peer](const Samples& s) { return by_peer(peer, s); }, true});
  }
  return all;
}

}  // namespace capsoc::fit
