// The past of one simulation: what came from outside, with its instant, and snapshots from which a
// position in the past is reached again.
//
// A worker records its history while it advances. To go back, the session takes the history from
// the worker. It starts another worker from the last snapshot before the position and passes the
// history to it. That worker advances to the position and applies the logged inputs on the way.
// This code does not depend on sockets, processes or SystemC.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/result.h"
#include "service/message.h"

namespace capsoc::service {

/// An instant between two instructions. Time alone does not tell two instructions apart of which
/// one takes no cycle, nor do instructions tell two instants of a sleep apart.
struct Position {
  uint64_t time_ps = 0, cycles = 0, instructions = 0, samples = 0;

  bool operator==(const Position& other) const {
    return time_ps == other.time_ps && instructions == other.instructions;
  }
  bool operator<(const Position& other) const {
    return time_ps != other.time_ps ? time_ps < other.time_ps : instructions < other.instructions;
  }
  bool operator<=(const Position& other) const { return !(other < *this); }
};

/// time_s, time_ps, cycles, instructions, samples.
Json to_json(const Position& position);
/// Nothing: the value is no position.
std::optional<Position> position_in(const Json& value);

/// What a position is named by.
enum class Unit : uint8_t { time, cycles, instructions, samples };
uint64_t coordinate(const Position& position, Unit unit);

/// The first instant at which a coordinate has reached a value.
struct Target {
  Unit unit = Unit::time;
  uint64_t value = 0;
};

/// {"unit": a Unit's number, "value": 5}, between session and worker.
Json to_json(const Target& target);
Target target_in(const Json& goal);

/// A request that changed the simulation, and when.
struct Input {
  Position at;
  std::string method;
  Json parameters;
  Frames frames;
};

/// Inputs as the bytes of messages, and back. An Error: damaged bytes.
std::string to_bytes(const Input& input);
Result<std::vector<Input>> inputs_in(const std::string& bytes);

class History {
 public:
  /// Keeps the hand-over to another process short.
  static constexpr std::size_t most_snapshots = 256, most_left = 32;
  using Inputs = std::deque<std::shared_ptr<const Input>>;

  struct Snapshot {
    Position at;
    uint64_t inputs = 0;     ///< applied before it, since the first of all
    uint64_t effort_ns = 0;  ///< processor time of the host up to here
    std::string bytes;       ///< of the caller; "": the board out of reset
    uint64_t serial = 0;     ///< of the history, from 1; no other one has it, nor had
  };

  /// A history that was left: what came after it was left at `from` begins another one. It has no
  /// snapshots after `from`, and is simulated again from those before.
  struct Left {
    uint64_t number = 0;
    Position from;  ///< as far as it is the present one
    Position end;
    Inputs inputs;  ///< as inputs()
  };
  /// The end of a history that is the present one no more, and its number.
  struct Ended {
    Position at;
    uint64_t number = 0;
  };

  /// `budget`: bytes for snapshots and inputs together. 0: nothing is kept.
  explicit History(std::size_t budget = 0) : budget_(budget) {}

  std::size_t budget() const { return budget_; }
  bool is_on() const { return !snapshots_.empty(); }
  /// Begins the history. Without it nothing is kept.
  void begin(const Position& at, std::string bytes);

  void add_snapshot(const Position& at, uint64_t effort_ns, std::string bytes);
  /// Logs an input that was applied now. If anything lay after it, that history is left, and
  /// another one begins.
  std::optional<Ended> add(Input input);
  /// The number of the present history, from 1.
  uint64_t number() const { return number_; }
  /// Those that were left and can be reached, by their numbers; when there are too many, or they
  /// do not fit into the budget, the one that went least far is dropped.
  const std::vector<Left>& left() const { return left_; }
  /// Makes one of these the present history, of which it is simulated no more than what both had in
  /// common. False: there is none of that number. The caller goes to a snapshot then.
  bool select(uint64_t number);
  /// The simulation is here, perhaps further than ever in this history.
  void reach(const Position& at);

  /// The next input that is logged and not applied; null: there is none. Valid until the next call
  /// that changes the history.
  const Input* next() const;
  void pass_next() { ++applied_; }
  uint64_t passed() const { return applied_; }
  /// Of a history that has just begun: these come, and it ends at `end`. The budget grows by what
  /// they take.
  void expect(const std::vector<Input>& inputs, const Position& end);

  const std::vector<Snapshot>& snapshots() const { return snapshots_; }
  /// The last snapshot from which the first instant of a target, or a position, can be reached.
  std::size_t before(const Target& target) const;
  std::size_t before(const Position& position) const;
  /// The simulation stands at a snapshot: the inputs before it are applied.
  void stand_at(std::size_t snapshot) { applied_ = snapshots_[snapshot].inputs; }

  /// Only if is_on().
  const Position& beginning() const { return snapshots_.front().at; }
  const Position& end() const { return end_; }
  /// As far as it was simulated: to its end, unless that is expected.
  const Position& reached() const { return reached_; }
  /// Logged since the beginning.
  const Inputs& inputs() const { return inputs_; }
  /// How many of them came before a snapshot.
  std::ptrdiff_t kept_before(const Snapshot& snapshot) const {
    return static_cast<std::ptrdiff_t>(snapshot.inputs - dropped_);
  }
  std::size_t bytes() const { return snapshot_bytes_ + input_bytes_; }

  /// For another process, which has the bytes of these snapshots already, by their serials.
  Json pack(Frames& frames, const std::set<uint64_t>& known = {}) const;
  /// `known`: what the other process has. An Error: these are not what pack() made.
  static Result<History> unpack(const Json& about, Frames frames, History known = History());

 private:
  static std::size_t size_of(const Input& input);
  void fit();
  void remove(std::size_t snapshot);
  void move_beginning();
  std::size_t least_missed() const;
  void leave();
  void drop_least();
  void drop(const Inputs& inputs);
  void remeasure();

  std::size_t budget_;
  std::vector<Snapshot> snapshots_;  // in the order of their positions
  Inputs inputs_;                    // likewise
  std::vector<Left> left_;           // by number
  uint64_t number_ = 1, greatest_number_ = 1;
  uint64_t dropped_ = 0;  // inputs before inputs_
  uint64_t applied_ = 0;  // inputs, with those dropped
  uint64_t next_serial_ = 1;
  std::size_t snapshot_bytes_ = 0, input_bytes_ = 0;
  Position end_, reached_;
};

}  // namespace capsoc::service
