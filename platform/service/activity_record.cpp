#include "service/activity_record.h"

#include <algorithm>

namespace capsoc::service {
namespace {

/// Calls `each` with the numbers of the bits.
template <typename Each>
void for_bits(uint64_t bits, Each each) {
  for (; bits != 0; bits &= bits - 1) each(static_cast<unsigned>(__builtin_ctzll(bits)));
}

}  // namespace

void ActivityRecord::begin(uint64_t ps, uint64_t parts) {
  seen_ = 0;
  for (Level& level : levels_) level = {};
  see(parts);
  before_ = parts;
  since_.fill(ps);
  changes_.assign(1, {ps, parts, 0});
  changes_.reserve(most_changes + 1);
}

/// Slots follow the order of first appearance.
void ActivityRecord::see(uint64_t parts) {
  for_bits(parts & ~seen_, [this](unsigned part) {
    slots_[part] = static_cast<uint8_t>(__builtin_popcountll(seen_));
    seen_ |= bit(part);
  });
}

void ActivityRecord::change(uint64_t ps, uint64_t parts, unsigned entered) {
  if ((parts & ~seen_) != 0) see(parts);
  Change& last = changes_.back();
  ps = std::max(ps, last.ps);
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

/// Bits of the parts that begin with a change.
uint64_t ActivityRecord::begun(const Change& change, uint64_t before) {
  return (change.parts & ~before) | (change.entered == 0 ? 0 : bit(change.entered));
}

ActivityRecord::Stretch ActivityRecord::stretch(std::size_t index, uint64_t before,
                                                uint64_t now) const {
  const Change& change = changes_[index];
  const uint64_t end = index + 1 < changes_.size() ? changes_[index + 1].ps : now;
  return {change.ps, std::max(end, change.ps), change.parts, begun(change, before)};
}

/// The older half becomes shares. Windows that the newer half covers need none.
void ActivityRecord::drop_half() {
  constexpr std::size_t half = most_changes / 2;
  const uint64_t kept_ps = changes_[half].ps, covered = changes_.back().ps - kept_ps;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    Level& level = levels_[i];
    const uint64_t width = windows[i] / bin_count;
    if (covered >= windows[i] + width) {
      level = {};
      continue;
    }
    if (level.runs.empty()) level.begin_ps = changes_.front().ps;
    for (std::size_t k = 0; k < half; ++k)
      add(level, width, stretch(k, k == 0 ? before_ : changes_[k - 1].parts, kept_ps));
  }
  for (std::size_t k = 0; k < half; ++k) {
    for_bits(begun(changes_[k], before_), [&](unsigned part) { since_[part] = changes_[k].ps; });
    before_ = changes_[k].parts;
  }
  changes_.erase(changes_.begin(), changes_.begin() + half);
}

ActivityRecord::Run& ActivityRecord::run_at(Level& level, uint64_t bin) const {
  const bool is_new = level.runs.empty() || level.runs.back().first != bin;
  if (is_new) level.runs.push_back({bin, 1, {}});
  return level.runs.back();
}

void ActivityRecord::put(Run& run, const Stretch& stretch, uint64_t ps, uint64_t begun) const {
  if (const auto parts = static_cast<std::size_t>(__builtin_popcountll(seen_));
      run.shares.size() < parts)
    run.shares.resize(parts);
  for_bits(stretch.parts, [&](unsigned part) { run.shares[slots_[part]].ps += ps; });
  for_bits(begun, [&](unsigned part) { ++run.shares[slots_[part]].begun; });
}

void ActivityRecord::add(Level& level, uint64_t width, const Stretch& stretch) {
  // Most are short: without a division.
  if (level.edge != 0 && stretch.end <= level.edge)
    return put(level.runs.back(), stretch, stretch.end - stretch.begin, stretch.begun);
  const uint64_t first = stretch.begin / width, edge = (first + 1) * width;
  put(run_at(level, first), stretch, std::min(stretch.end, edge) - stretch.begin, stretch.begun);
  level.edge = edge;
  if (stretch.end <= edge) return;
  level.edge = 0;
  if (const uint64_t whole = (stretch.end - edge) / width; whole > 0) {
    level.runs.push_back({first + 1, whole, {}});
    put(level.runs.back(), stretch, width, 0);
  }
  if (const uint64_t rest = (stretch.end - edge) % width; rest > 0) {
    const uint64_t last = stretch.end / width;
    put(run_at(level, last), stretch, rest, 0);
    level.edge = (last + 1) * width;
  }
  const uint64_t end = level.runs.back().first + level.runs.back().count;
  while (level.runs.front().first + level.runs.front().count + bin_count < end)
    level.runs.pop_front();
}

ActivityRecord::View ActivityRecord::view(std::size_t window, uint64_t now_ps) const {
  View view;
  view.width_ps = windows[window] / bin_count;
  view.end_ps = std::max(now_ps, changes_.back().ps);
  const uint64_t bins = view.end_ps / view.width_ps + 1;
  view.begin_ps = (bins - std::min(bins, bin_count)) * view.width_ps;
  for_bits(seen_, [&view](unsigned part) { view.rows.push_back({part, 0, 0, {}, {}}); });
  std::sort(view.rows.begin(), view.rows.end(),
            [this](const Row& a, const Row& b) { return slots_[a.part] < slots_[b.part]; });
  const Level& level = levels_[window];
  const bool is_covered = level.runs.empty() || changes_.front().ps <= view.begin_ps;
  view.known_ps = std::max(view.begin_ps, is_covered ? changes_.front().ps : level.begin_ps);
  const std::size_t begin = first_in(view.begin_ps);
  view.has_slices = is_covered && slice(view, begin);
  if (!view.has_slices) {
    for (Row& row : view.rows) row.bins.assign(bin_count, 0);
    if (!is_covered) spread(view, level);
  }
  for (std::size_t i = begin; i < changes_.size(); ++i)
    spread(view, stretch(i, before(i), view.end_ps));
  std::sort(view.rows.begin(), view.rows.end(),
            [](const Row& a, const Row& b) { return a.part < b.part; });
  return view;
}

/// The last change at or before a time; the first one if none is.
std::size_t ActivityRecord::first_in(uint64_t begin_ps) const {
  const auto after =
      std::upper_bound(changes_.begin(), changes_.end(), begin_ps,
                       [](uint64_t ps, const Change& change) { return ps < change.ps; });
  const auto index = static_cast<std::size_t>(after - changes_.begin());
  return index - std::min<std::size_t>(index, 1);
}

/// False: there are too many.
bool ActivityRecord::slice(View& view, std::size_t first) const {
  std::array<uint64_t, part_count> since = since_;
  // What lasts at the first change has perhaps begun long before.
  uint64_t sought = before(first);
  for (std::size_t i = first; i-- > 0 && sought != 0;) {
    for_bits(sought & begun(changes_[i], before(i)),
             [&](unsigned part) { since[part] = changes_[i].ps; });
    sought &= ~begun(changes_[i], before(i));
  }
  std::size_t count = 0;
  const auto close = [&](uint64_t parts, uint64_t ps) {
    for_bits(parts, [&](unsigned part) {
      if (ps <= view.begin_ps || ps == since[part]) return;
      if (++count <= most_slices) row(view, part).slices.emplace_back(since[part], ps);
    });
  };
  for (std::size_t i = first; i < changes_.size(); ++i) {
    const Change& each = changes_[i];
    const uint64_t begins = begun(each, before(i));
    close(before(i) & (~each.parts | begins), each.ps);
    for_bits(begins, [&](unsigned part) { since[part] = each.ps; });
  }
  close(changes_.back().parts, view.end_ps);
  if (count <= most_slices) return true;
  for (Row& row : view.rows) row.slices.clear();
  return false;
}

void ActivityRecord::spread(View& view, const Level& level) const {
  const uint64_t first = view.begin_ps / view.width_ps;
  for (const Run& run : level.runs) {
    const uint64_t end = std::min(run.first + run.count, first + bin_count);
    for (uint64_t bin = std::max(run.first, first); bin < end; ++bin) {
      for (Row& row : view.rows) {
        if (slots_[row.part] >= run.shares.size()) continue;
        const Share& share = run.shares[slots_[row.part]];
        row.bins[bin - first] += share.ps;
        row.busy_ps += share.ps;
        row.begun += share.begun;
      }
    }
  }
}

/// Into the sums, and into bins if there are any.
void ActivityRecord::spread(View& view, const Stretch& stretch) const {
  if (stretch.end <= view.begin_ps) return;
  const uint64_t begin = std::max(stretch.begin, view.begin_ps);
  for_bits(stretch.parts, [&](unsigned part) { row(view, part).busy_ps += stretch.end - begin; });
  if (stretch.begin >= view.begin_ps)
    for_bits(stretch.begun, [&](unsigned part) { ++row(view, part).begun; });
  if (view.has_slices) return;
  for (uint64_t at = begin; at < stretch.end;) {
    const uint64_t bin = (at - view.begin_ps) / view.width_ps;
    const uint64_t end = std::min(stretch.end, view.begin_ps + (bin + 1) * view.width_ps);
    for_bits(stretch.parts, [&](unsigned part) { row(view, part).bins[bin] += end - at; });
    at = end;
  }
}

}  // namespace capsoc::service
