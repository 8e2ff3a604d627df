// What a processor did in the recent past: sleep, thread and handlers, in memory that is bounded.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

namespace capsoc::service {

/// Changes are kept one by one while they are few, and as shares of time beyond that, in bins of a
/// width for each length of window. Times are in picoseconds and never go back.
class ActivityRecord {
 public:
  /// The parts that time is spent in are bits: these two, and the numbers of exceptions.
  static constexpr unsigned asleep = 0, thread = 1, part_count = 64;
  static constexpr uint64_t bin_count = 250;
  static constexpr std::size_t most_changes = 8192, most_slices = 600;
  /// Lengths of windows, in picoseconds: 1 ms to 100 s.
  static constexpr std::array<uint64_t, 6> windows = {1'000'000'000,      10'000'000'000,
                                                      100'000'000'000,    1'000'000'000'000,
                                                      10'000'000'000'000, 100'000'000'000'000};

  static constexpr uint64_t bit(unsigned part) { return uint64_t{1} << part; }

  /// Forgets everything. `parts`: bits of those that last at this time.
  void begin(uint64_t ps, uint64_t parts);
  /// From here on these parts last. `entered`: one of them that begins here even if it lasted
  /// before, as a handler that is entered again at once; 0: none.
  void change(uint64_t ps, uint64_t parts, unsigned entered = 0) {
    if ((parts & ~seen_) != 0) see(parts);
    Change& last = changes_.back();
    if (ps < last.ps) ps = last.ps;
    if (entered == 0) {
      if (parts == last.parts) return;
      // What lasted no time did not happen.
      if (ps == last.ps && last.entered == 0) {
        last.parts = parts;
        return;
      }
    }
    changes_.push_back({ps, parts, entered});
    if (changes_.size() > most_changes) drop_half();
  }

  /// One part in a window.
  struct Row {
    unsigned part = 0;
    uint64_t busy_ps = 0, begun = 0;  ///< in the window; how often it began there
    /// Begin and end of each time; empty if there are more than most_slices in all rows.
    std::vector<std::pair<uint64_t, uint64_t>> slices;
    std::vector<uint64_t> bins;  ///< instead: picoseconds in each
  };
  struct View {
    uint64_t begin_ps = 0, end_ps = 0;
    uint64_t known_ps = 0;  ///< nothing is known from before
    uint64_t width_ps = 0;  ///< of a bin
    bool has_slices = true;
    std::vector<Row> rows;  ///< of all parts that were seen since the record began, by number
  };
  /// `window`: an index. The window ends with the bin in which `now_ps` is.
  View view(std::size_t window, uint64_t now_ps) const;

 private:
  struct Change {
    uint64_t ps, parts;
    unsigned entered;
  };
  /// A time in which nothing changes.
  struct Stretch {
    uint64_t begin, end, parts, begun;
  };
  struct Share {
    uint64_t ps = 0, begun = 0;
  };
  /// Bins in a row that are equal.
  struct Run {
    uint64_t first, count;
    std::vector<Share> shares;  // by slot
  };
  /// The past that is no longer in changes_, for one length of window.
  struct Level {
    uint64_t begin_ps = 0;
    std::deque<Run> runs;
  };
  /// Shares of one bin, by part.
  struct Bin {
    uint64_t edge = 0;  ///< its end
    std::array<Share, part_count> shares{};
    void put(const Stretch& stretch, uint64_t ps, uint64_t begun);
  };

  /// Bits of the parts that begin with a change.
  static uint64_t begun(const Change& change, uint64_t before) {
    return (change.parts & ~before) | (change.entered == 0 ? 0 : bit(change.entered));
  }
  Stretch stretch(std::size_t index, uint64_t before, uint64_t now) const {
    const Change& change = changes_[index];
    const uint64_t end = index + 1 < changes_.size() ? changes_[index + 1].ps : now;
    return {change.ps, end > change.ps ? end : change.ps, change.parts, begun(change, before)};
  }
  void see(uint64_t parts);
  void drop_half();
  std::vector<Run> runs_of(std::size_t count, uint64_t width) const;
  void close(std::vector<Run>& runs, Bin& bin, uint64_t width) const;
  void add(Level& level, const Run& run, uint64_t ratio) const;
  void put(Level& level, uint64_t bin, uint64_t count, const Run& run, uint64_t times) const;
  std::size_t first_in(uint64_t begin_ps) const;
  uint64_t before(std::size_t index) const {
    return index == 0 ? before_ : changes_[index - 1].parts;
  }
  bool slice(View& view, std::size_t first) const;
  void spread(View& view, const Level& level) const;
  void spread(View& view, const Stretch& stretch) const;
  Row& row(View& view, unsigned part) const { return view.rows[slots_[part]]; }

  std::vector<Change> changes_;
  uint64_t before_ = 0;                       // parts before the first of them
  std::array<uint64_t, part_count> since_{};  // when each of these began
  uint64_t seen_ = 0;                         // parts
  uint8_t seen_count_ = 0;
  std::array<uint8_t, part_count> slots_{};  // of each part that was seen
  std::array<Level, windows.size()> levels_;
};

}  // namespace capsoc::service
