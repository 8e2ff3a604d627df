// What happened last in a part of a history: the simulation advances over it and is observed.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "armv7m/observer.h"
#include "base/result.h"
#include "service/advance.h"
#include "service/board.h"

namespace capsoc::service {

/// The part of a history that a search looks at: from where the simulation is to `end`. A search on
/// a grid of times continues to the first one at or after `end`, so that what it finds does not
/// depend on where the parts of a history meet.
struct Part {
  Position end;
  Position now;           ///< the end of the last part
  bool is_first = false;  ///< it begins at the beginning of the history
};

/// In a board that is used for nothing else.
class Search final : private armv7m::Observer {
 public:
  Search(Board& board, const Part& part) : board_(board), part_(part) {}
  ~Search() override;
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;

  /// Searches for:
  /// - {"points"}: the last instant at which debugger.resume would have stopped
  /// - {"write": [address, size]}: the last write to one of these bytes
  /// - {"register": index}: the last instruction that changed it; with {"narrow": true} only the
  ///   last stretch in which one may have changed it, which needs no observer: {"hit": null,
  ///   "stretch": [position, position]}, or null
  /// - {"expression", "every_ps"}: the last instant of the grid at which it was not 0
  /// - {"name" or "signal", "every_ps"}: the last change of a register or field of a device, or of
  ///   a signal of the coprocessor
  /// The result: {"hit": null}, or {"hit": position} and what else is known; "from", where it
  /// began.
  Answer perform(const Json& what);

 private:
  using Value = std::function<Result<Json>()>;
  std::optional<Error> run();
  std::optional<Error> find_points(const Json& points);
  std::optional<Error> find_write(uint32_t address, uint32_t size);
  std::optional<Error> find_register(unsigned index);
  std::optional<Error> narrow(unsigned index);
  std::optional<Error> find_expression(const Json& what);
  std::optional<Error> find_change(const Json& what);
  std::optional<Error> find_signal(const std::string& name);
  std::optional<Error> walk_grid(uint64_t every_ps,
                                 const std::function<std::optional<Error>()>& look);
  void watch_input(const std::function<Json()>& value);
  void hit(const Json& more = Json::object());

  void issued(const armv7m::Core& core, const armv7m::DecodedOp& op) override;
  void retired(const armv7m::Core& core, const armv7m::DecodedOp& op) override;
  void entered(const armv7m::Core&, unsigned, armv7m::Entry, uint64_t) override { is_old_ = true; }
  void returned(const armv7m::Core&, unsigned) override { is_old_ = true; }
  void accessed(const armv7m::Core&, const armv7m::DirectAccess&) override {}
  void started(const armv7m::Core&) override { is_old_ = true; }
  uint32_t value_of_register() const;

  Board& board_;
  Part part_;
  Json found_ = {{"hit", nullptr}};
  Advance::Watcher watcher_;
  bool is_cut_ = false, observes_ = false;
  Json before_input_;
  unsigned register_ = 0;
  uint32_t register_before_ = 0;
  bool is_old_ = true;                  // not an instruction alone may have changed it since
  std::optional<uint64_t> changed_by_;  // instructions, with the one that changed it
};

/// What a request asks for, as perform() takes it: symbols and variables are addresses, as they are
/// now. An Error: there is none of that name, or nothing can be found for it.
Result<Json> resolve(Board& board, const Json& asked);

/// Memory as a list of numbers.
Json bytes_at(Board& board, uint32_t address, uint32_t size);

}  // namespace capsoc::service
