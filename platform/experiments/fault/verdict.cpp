#include "fault/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coprocessor/register_map.h"
#include "results/exit_codes.h"

namespace capsoc::fault {
namespace {

struct Bit {
  uint32_t mask;
  const char* name;
};
/// What says that something is wrong: bits of STATUS that go, and that come, and bits of FLAGS that
/// come.
constexpr Bit status_goes[] = {{coprocessor::status_lock, "LOCK"},
                               {coprocessor::status_valid, "VALID"}};
constexpr Bit status_comes[] = {{coprocessor::status_diverged, "DIVERGED"},
                                {coprocessor::status_mirror, "MIRROR"},
                                {coprocessor::status_alarm, "ALARM"}};
constexpr Bit flag_comes[] = {
    {coprocessor::flag_clip, "CLIP"},          {coprocessor::flag_sat, "SAT"},
    {coprocessor::flag_zero, "ZERO"},          {coprocessor::flag_early, "EARLY"},
    {coprocessor::flag_lockchg, "LOCKCHG"},    {coprocessor::flag_config, "CONFIG"},
    {coprocessor::flag_unsettled, "UNSETTLED"}};
/// Those of the safety mechanisms; with one of them VALID goes, too.
constexpr Bit mechanism_comes[] = {{coprocessor::flag_parity, "PARITY"},
                                   {coprocessor::flag_misfit, "MISFIT"},
                                   {coprocessor::flag_jump, "JUMP"},
                                   {coprocessor::flag_missed, "MISSED"}};

std::string detection(const SampleResult& golden, const SampleResult& result) {
  for (const Bit& bit : mechanism_comes)
    if ((result.flags & ~golden.flags & bit.mask) != 0) return bit.name;
  for (const Bit& bit : status_goes)
    if ((golden.status & ~result.status & bit.mask) != 0) return fmt::format("no {}", bit.name);
  for (const Bit& bit : status_comes)
    if ((result.status & ~golden.status & bit.mask) != 0) return bit.name;
  for (const Bit& bit : flag_comes)
    if ((result.flags & ~golden.flags & bit.mask) != 0) return bit.name;
  return "";
}

double degrees_between(uint32_t one, uint32_t other) {
  return std::abs(static_cast<double>(static_cast<int32_t>(one - other))) * 360.0 / 0x1p32;
}

bool is_trusted(const SampleResult& result) {
  constexpr uint32_t good = coprocessor::status_valid | coprocessor::status_lock;
  return (result.status & good) == good &&
         (result.status & (coprocessor::status_alarm | coprocessor::status_diverged)) == 0;
}

}  // namespace

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::crashed:
      return "crashed";
    case Verdict::hung:
      return "hung";
    case Verdict::unapplied:
      return "unapplied";
    case Verdict::silent:
      return "silent";
    case Verdict::detected:
      return "detected";
    case Verdict::wrong:
      return "wrong";
    case Verdict::masked:
      return "masked";
    case Verdict::latent:
      break;
  }
  return "latent";
}

void Judgement::note_wrong(const SampleResult& status) {
  if (!first_wrong_) first_wrong_ = samples_;
  if (!detected_ && is_trusted(status)) ++trusted_;
}

void Judgement::take(const SampleResult& golden, const SampleResult* result) {
  if (golden.exists && result != nullptr && result->exists) {
    const bool both = golden.has_angle && result->has_angle;
    const double error = both ? degrees_between(golden.angle, result->angle) : 0;
    largest_deg_ = std::max(largest_deg_, error);
    if (error > tolerance_.degrees) note_wrong(*result);
    if (!detected_)
      if (std::string what = detection(golden, *result); !what.empty()) {
        detected_by_ = std::move(what);
        detected_ = samples_;
      }
    last_ = *result;
  } else if (golden.exists) {
    // Who reads the angle gets the one before.
    note_wrong(last_.value_or(golden));
  }
  ++samples_;
}

void Judgement::note_end() {
  if (!detected_ && samples_ > 0) detected_ = samples_ - 1;
}

std::optional<uint64_t> Judgement::detected_after() const {
  if (!detected_ || !first_wrong_) return detected_ ? std::optional<uint64_t>(0) : std::nullopt;
  return *detected_ - std::min(*detected_, *first_wrong_);
}

Verdict Judgement::conclude(const Ending& ending) const {
  if (!ending.is_applied) return Verdict::unapplied;
  if (trusted_ > tolerance_.samples) return Verdict::silent;
  if (!detected_by_.empty()) return Verdict::detected;
  if (ending.code == run::exit_code::crashed) return Verdict::crashed;
  if (ending.code != ending.golden_code)
    return ending.code == run::exit_code::limit ? Verdict::hung : Verdict::detected;
  if (first_wrong_) return Verdict::wrong;
  return ending.is_same_state ? Verdict::masked : Verdict::latent;
}

}  // namespace capsoc::fault
