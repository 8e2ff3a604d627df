// A simulation moved on until something is so.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <systemc>
#include <vector>

#include "armv7m/tlm/debugger.h"
#include "base/result.h"
#include "kit/probe.h"
#include "service/board.h"
#include "service/expression.h"
#include "service/history.h"
#include "service/verb.h"

namespace re2 {
class RE2;
}

namespace capsoc::service {

/// One advance. Whatever it stops at, it stops between two instructions, at the same one however
/// the way there is cut into pieces.
class Advance final : private armv7m::Debugger {
 public:
  Advance(Board& board, const Call& call) : board_(board), call_(&call) {}
  /// For go().
  explicit Advance(Board& board) : board_(board) {}
  ~Advance() override;
  Advance(const Advance&) = delete;
  Advance& operator=(const Advance&) = delete;

  Answer perform();

  /// To the first instant at which a target is reached, or to an instant where the simulation was
  /// before. Stops earlier if the run is over or interrupted. An Error: what was logged does not
  /// repeat.
  std::optional<Error> go(const Target& target);
  std::optional<Error> go(const Position& position);
  bool is_interrupted() const { return is_cut_; }

  /// As a debugger has the processor continue, one instruction after the other or at once, until
  /// its watcher says so; at the latest to a position where the simulation was before.
  std::optional<Error> resume(bool steps, const std::optional<Position>& end);
  /// What it stopped at: "debugger" (the watcher said so), "bkpt", "asleep" (nothing inside can
  /// wake it), "console" (a read of it waits for input); null: nothing.
  const char* hit() const { return hit_; }
  /// The run is over, ended by a debugger.
  std::optional<Error> kill();
  bool is_over() const { return is_over_; }

  /// Who observes: each end of a run of the processor, with the reason and whether anything was
  /// executed (true: the simulation stops there), and each logged input, before and after it is
  /// applied.
  struct Watcher {
    std::function<bool(armv7m::StopReason reason, bool advanced)> on_run;
    std::function<void(const Input& input, bool is_applied)> on_input;
  };
  void watch(Watcher watcher);

 private:
  /// The last ones of many instructions are executed one by one.
  static constexpr uint64_t stepped = 64;
  /// Why it stopped, as the answer has it; null: it did not.
  const char* hit_ = nullptr;

  std::optional<Answer> plan();
  std::optional<Answer> refuse_beside_gdb() const;
  std::optional<Answer> plan_times();
  std::optional<Answer> plan_counts();
  void plan_cycles(uint64_t until);
  void plan_samples(uint64_t count);
  std::optional<Answer> plan_places();
  std::optional<Answer> plan_uart();
  std::optional<Answer> plan_expression();
  void stop(const char* reason);
  void attach_debugger();
  uint64_t left() const;
  bool is_at_bkpt() const;
  bool asks_a_client() const;
  bool has_ended() const { return is_over_ || is_cut_ || hit_ != nullptr; }
  bool stands_at_bkpt();
  std::optional<Error> run();
  std::optional<Error> run_cycles();
  std::optional<Error> run_instructions();
  std::optional<Error> run_expression();
  std::optional<Error> advance_to(const sc_core::sc_time& time);
  std::optional<Error> meet(const Position& position);
  std::optional<Error> apply_next();
  std::optional<Error> apply_due();
  bool holds(const Result<double>& value, std::optional<Error>& error);
  Result<double> value();
  Answer answer();

  // armv7m::Debugger
  bool before_run() override { return steps_ || meets_ || (instruction_ && left() <= stepped); }
  bool after_run(armv7m::StopReason reason, bool advanced) override;
  bool asleep_for_good() override;
  bool wants_attention() const override { return false; }
  bool looks_at_sleep() const override { return false; }
  bool sees_stops_alone() const override { return !steps_ && !meets_ && !instruction_ && !kills_; }
  uint64_t longest_run() const override;
  bool ended() const override { return kills_; }

  Board& board_;
  const Call* call_ = nullptr;
  sc_core::sc_time limit_ = sc_core::sc_max_time();
  bool limit_is_goal_ = true;  // reaching it is what was asked for
  bool is_over_ = false, is_cut_ = false;
  bool clock_changed_ = false;
  bool waits_asleep_ = false, kills_ = false;    // of a debugger
  std::optional<uint64_t> cycle_, instruction_;  // to be reached
  std::optional<uint64_t> meets_;                // instructions of a position at the time of now
  uint64_t samples_left_ = 0;
  std::optional<uint32_t> breakpoint_;
  bool had_breakpoint_ = false, has_debugger_ = false, steps_ = false;
  std::shared_ptr<const re2::RE2> pattern_;
  std::optional<std::size_t> uart_;
  std::optional<Expression> expression_;
  sc_core::sc_time every_;
  std::vector<kit::Listening> listening_;
  Watcher watcher_;
};

}  // namespace capsoc::service
