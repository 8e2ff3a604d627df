#include "regress/coverage.h"

#include <fmt/format.h>

#include <iterator>

#include "capsoc_registers.h"
#include "coprocessor/device.h"

namespace capsoc::regress {
namespace {

using coprocessor::Arithmetic;

struct GroupNames {
  const char* name;
  std::vector<std::string> bins;
};

std::vector<std::string> moments() {
  return {"idle",
          "sample waits, nothing runs",
          "T0",
          "T1",
          "T2",
          "T3",
          "T4",
          "full",
          "several stages",
          "LOAD waits",
          "L0",
          "L1",
          "L2"};
}

std::vector<std::string> quadrants() {
  return {"first", "second", "third", "fourth"};
}

std::vector<std::string> flags() {
  static constexpr const char* names[] = {
      "RESULT", "CLIP", "SAT",   "ZERO",      "EARLY",  "LOCKCHG", "DIVERGED", "MIRRORCHG",
      "CONFIG", "TURN", "ALARM", "UNSETTLED", "PARITY", "MISFIT",  "JUMP",     "MISSED"};
  static_assert(std::size(names) == coprocessor::flag_count);
  return {std::begin(names), std::end(names)};
}

std::vector<std::string> modes() {
  std::vector<std::string> names;
  for (const char* source : {"numeric", "tracking", "angle"})
    for (const char* rest : {"", " DEMOD", " CALIB", " DEMOD CALIB"})
      names.push_back(std::string(source) + rest);
  return names;
}

std::vector<std::string> mode_changes() {
  std::vector<std::string> names;
  for (const char* when : {" idle", " busy"})
    for (const char* what :
         {"numeric to tracking", "numeric to angle", "tracking to numeric", "tracking to angle",
          "angle to numeric", "angle to tracking", "DEMOD on", "DEMOD off", "CALIB on", "CALIB off",
          "ADC off", "steps", "LOOP", "thresholds", "JUDGE", "TURN_LIMIT", "FREEZE"})
      names.push_back(std::string(what) + when);
  return names;
}

std::vector<std::string> registers() {
  std::vector<std::string> names;
  for (const auto& entry : registers::coprocessor::table) names.emplace_back(entry.name);
  return names;
}

std::vector<std::string> steps() {
  std::vector<std::string> names;
  for (const char* weight : {"AU", "BU", "CU", "AV", "BV", "CV"})
    for (const char* value : {" 0", " 1", " largest"}) names.push_back(std::string(weight) + value);
  return names;
}

std::vector<std::string> strobes() {
  std::vector<std::string> names;
  for (uint8_t bytes = 0; bytes < coprocessor::all_strobes; ++bytes)
    names.push_back(fmt::format("{:04b}", bytes));
  return names;
}

std::vector<std::string> slews() {
  std::vector<std::string> names = {"no limit, full scale"};
  for (unsigned n = 1; n < 8; ++n)
    for (const char* where : {" above", " below", " at the top", " at the bottom", " within"})
      names.push_back(std::to_string(n) + where);
  for (const char* name : {"u alone", "v alone", "not written"}) names.emplace_back(name);
  return names;
}

constexpr std::array<const char*, 2> memories = {"a node of the correction", "a block's sum"};

std::vector<std::string> parities() {
  std::vector<std::string> names;
  names.reserve(coprocessor::parity_registers.size());
  for (const uint32_t offset : coprocessor::parity_registers)
    names.emplace_back(coprocessor::find_rule(offset)->about->name);
  for (const char* memory : memories) names.emplace_back(memory);
  return names;
}

std::vector<std::string> safety() {
  std::vector<std::string> names;
  for (const char* what : {"PARITY", "MISFIT", "JUMP", "MISSED"})
    for (const char* how : {" alone", " switched off"}) names.push_back(std::string(what) + how);
  for (const char* name : {"ANGLE kept after a flag", "trusted again"}) names.emplace_back(name);
  for (unsigned n = 1; n < 32; ++n)
    for (const char* where : {" top", " above", " bottom", " below"})
      names.push_back(fmt::format("error limit {}{}", n, where));
  for (unsigned n = 1; n < 30; ++n)
    for (const char* where : {" within", " beyond"})
      names.push_back(fmt::format("step limit {}{}", n, where));
  return names;
}

/// With ticks of `tick` cycles.
std::vector<std::string> spacings(unsigned tick) {
  const unsigned latency = coprocessor::latency_of(tick);
  const unsigned far = 200 * tick / coprocessor::tick_cycles;
  return {"1",
          fmt::format("2..{}", tick - 2),
          std::to_string(tick - 1),
          std::to_string(tick),
          std::to_string(tick + 1),
          fmt::format("{}..{}", tick + 2, 2 * tick - 1),
          std::to_string(2 * tick),
          fmt::format("{}..{}", 2 * tick + 1, latency - 1),
          std::to_string(latency),
          std::to_string(latency + 1),
          fmt::format("{}..{}", latency + 2, far),
          fmt::format("above {}", far)};
}

const std::vector<GroupNames>& groups() {
  static const std::vector<GroupNames> table = {
      {"sample quadrant", quadrants()},
      {"relative quadrant", quadrants()},
      {"angle quadrant", quadrants()},
      {"phi quadrant", quadrants()},
      {"beta quadrant", quadrants()},
      {"seam", {"below half a turn", "above minus half a turn", "below 0", "0 and above"}},
      {"saturation",
       {"error top", "error bottom", "CAL_S top", "CAL_S bottom", "CAL_C top", "CAL_C bottom",
        "weight top", "weight bottom", "frequency top", "frequency bottom", "amplitude",
        "a1 or a2"}},
      {"tie",
       {"weight to Q31, positive", "weight to Q31, negative", "phase to REF_PHASE", "err * step",
        "err * step, negative", "KP shift", "KI shift", "offset to b1", "S to CAL_S",
        "C to CAL_C"}},
      {"flag set", flags()},
      {"flag cleared", flags()},
      {"interrupt",
       {"high by result",     "high by lock",    "high by error",  "low with a flag masked",
        "low without a flag", "high by turn",    "high by alarm",  "high by safety",
        "result unmasked",    "lock unmasked",   "error unmasked", "turn unmasked",
        "alarm unmasked",     "safety unmasked", "result masked",  "lock masked",
        "error masked",       "turn masked",     "alarm masked",   "safety masked"}},
      {"mode", modes()},
      {"mode change", mode_changes()},
      {"LOAD at", moments()},
      {"soft reset at", moments()},
      {"pin reset at", moments()},
      {"collision",
       {"FLAGS written at a commit", "CLEAR at a commit", "coefficient at T3's end",
        "PHASE at T2's end", "FREQ at a tracking T2's end", "parameter at T4's end",
        "CTRL at a tick's start", "steps at a tick's start", "soft reset at a commit",
        "sample at a tick's start", "sample and write at one edge", "LOAD at a tick's start",
        "write one edge before a tick", "write one edge after a tick's start",
        "sample and soft reset at one edge"}},
      {"spacing", spacings(coprocessor::tick_cycles)},
      {"acceptance",
       {"ADC latched", "ADC dropped", "ADC ignored", "software latched", "software dropped",
        "latched by the edge that frees the holding register", "software with ADC on",
        "latched while LOAD runs"}},
      {"access",
       {"read", "write", "debug read", "unmapped read", "unmapped write", "misaligned read",
        "misaligned write", "write to a read-only register", "write of a reserved value"}},
      {"strobes", strobes()},
      {"read of", registers()},
      {"write of", registers()},
      {"pair",
       {"LO then HI written", "HI alone written", "LO written twice", "LO read after HI",
        "LO read alone", "commit between HI and LO read"}},
      {"loop",
       {"KP 0", "KP 1..15", "KP 16", "KP 17..30", "KP 31", "KI 0", "KI 1..15", "KI 16", "KI 17..30",
        "KI 31"}},
      {"step", steps()},
      {"event",
       {"zero, numeric", "zero, tracking", "zero, angle", "mirrored", "upright", "lock gained",
        "lock lost", "diverged", "sample 63", "sample 64", "not valid after valid", "clipped"}},
      {"turn",
       {"good",
        "octants missing",
        "clipped",
        "clipped 255",
        "TIMEOUT",
        "RADIUS",
        "WINDING",
        "MIRROR",
        "NOANGLE",
        "SAT",
        "winding 60",
        "winding 61",
        "winding 66",
        "winding 67",
        "winding -62",
        "winding -61",
        "winding -67",
        "winding -68",
        "GOOD_TURNS 3",
        "good after another",
        "other after a good one",
        "ended by the reference",
        "ended by the angle, forward",
        "ended by the angle, backward",
        "good by count",
        "more than 1.5 turns",
        "exactly one turn",
        "TURN_COUNT wraps",
        "RESIDUE",
        "lock lost within a window",
        "largest residue below RESIDUE",
        "least residue of RESIDUE"}},
      {"alarm",
       {"glitches and back", "raised", "fallen", "frozen", "lock lost with it",
        "flag cleared while it stands"}},
      {"slew", slews()},
      {"parity", parities()},
      {"safety", safety()},
      {"magnitude",
       {"a1 0", "a1 below 2^-20", "a1 below 0.01", "a1 0.01..0.5", "a1 0.5..0.99", "a1 above"}},
  };
  return table;
}

/// A pin reset comes an edge after a sample at the earliest, and then its first tick has begun.
/// What `paper` cannot reach: it has no AMPLITUDE, its coefficients have no bits below Q31, its
/// steps truncate, and U2 is a product of two words that are never the most negative one.
bool reachable(Arithmetic arithmetic, Group group, const std::string& bin) {
  if (group == Group::pin_reset_moment && bin == moments()[1]) return false;
  // The arctangents of both always converge.
  if ((group == Group::flag_set || group == Group::flag_cleared) && bin == "UNSETTLED")
    return false;
  if (arithmetic == Arithmetic::precise) return true;
  switch (group) {
    case Group::tie:
      return bin == "phase to REF_PHASE" || bin == "KP shift" || bin == "KI shift";
    case Group::parity:  // it has neither
      return std::find(memories.begin(), memories.end(), bin) == memories.end();
    case Group::saturation:
      return bin != "amplitude" && bin.rfind("CAL_S", 0) != 0;
    default:
      return true;
  }
}

}  // namespace

Coverage::Coverage(Arithmetic arithmetic, unsigned tick) : arithmetic_(arithmetic), tick_(tick) {
  for (size_t i = 0; i < hits_.size(); ++i) hits_[i].assign(groups()[i].bins.size(), 0);
}

void Coverage::add(const Coverage& other) {
  for (size_t i = 0; i < hits_.size(); ++i)
    for (size_t j = 0; j < hits_[i].size(); ++j) hits_[i][j] += other.hits_[i][j];
}

std::vector<uint64_t> Coverage::counts() const {
  std::vector<uint64_t> all;
  for (const auto& group : hits_) all.insert(all.end(), group.begin(), group.end());
  return all;
}

bool Coverage::add(const std::vector<uint64_t>& counts) {
  if (counts.size() != this->counts().size()) return false;
  auto next = counts.begin();
  for (auto& group : hits_)
    for (uint64_t& hits : group) hits += *next++;
  return true;
}

std::vector<Coverage::Bin> Coverage::bins() const {
  std::vector<Bin> result;
  for (size_t i = 0; i < hits_.size(); ++i) {
    GroupNames group = groups()[i];
    if (static_cast<Group>(i) == Group::spacing) group.bins = spacings(tick_);
    for (size_t j = 0; j < hits_[i].size(); ++j)
      if (reachable(arithmetic_, static_cast<Group>(i), group.bins[j]))
        result.push_back({group.name, group.bins[j], hits_[i][j]});
  }
  return result;
}

size_t register_index(uint32_t offset) {
  size_t index = 0;
  for (const auto& entry : registers::coprocessor::table) {
    if (entry.offset == offset) return index;
    ++index;
  }
  return index;
}

}  // namespace capsoc::regress
