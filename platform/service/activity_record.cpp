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
  seen_ = seen_count_ = 0;
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
    slots_[part] = seen_count_++;
    seen_ |= bit(part);
  });
}

/// The older half becomes shares. Windows that the newer half covers need none. A bin of one window
/// has whole bins of the shorter ones, so the changes are added up once.
void ActivityRecord::drop_half() {
  constexpr std::size_t half = most_changes / 2;
  const uint64_t kept_ps = changes_[half].ps, covered = changes_.back().ps - kept_ps;
  uint64_t finest = 0;
  std::vector<Run> runs;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    Level& level = levels_[i];
    const uint64_t width = windows[i] / bin_count;
    if (covered >= windows[i] + width) {
      level = {};
      continue;
    }
    if (finest == 0) runs = runs_of(half, finest = width);
    if (level.runs.empty()) level.begin_ps = changes_.front().ps;
    for (const Run& run : runs) add(level, run, width / finest);
  }
  // The newest beginning of each part.
  uint64_t sought = seen_;
  for (std::size_t k = half; k-- > 0 && sought != 0;) {
    const uint64_t found = sought & begun(changes_[k], before(k));
    for_bits(found, [&](unsigned part) { since_[part] = changes_[k].ps; });
    sought &= ~found;
  }
  before_ = changes_[half - 1].parts;
  changes_.erase(changes_.begin(), changes_.begin() + half);
}

void ActivityRecord::Bin::put(const Stretch& stretch, uint64_t ps, uint64_t begun) {
  for_bits(stretch.parts, [&](unsigned part) { shares[part].ps += ps; });
  for_bits(begun, [&](unsigned part) { ++shares[part].begun; });
}

/// The bins of a number of changes from the first one on.
std::vector<ActivityRecord::Run> ActivityRecord::runs_of(std::size_t count, uint64_t width) const {
  std::vector<Run> runs;
  Bin bin;
  bin.edge = (changes_.front().ps / width + 1) * width;
  for (std::size_t k = 0; k < count; ++k) {
    Stretch left = stretch(k, before(k), changes_[count].ps);
    if (left.begin == bin.edge) close(runs, bin, width);
    while (left.end > bin.edge) {
      bin.put(left, bin.edge - left.begin, left.begun);
      left.begun = 0;
      left.begin = bin.edge;
      close(runs, bin, width);
      const uint64_t whole = (left.end - left.begin) / width;
      if (whole <= 1) continue;
      // Equal ones are one run; the last bin may continue.
      bin.put(left, width, 0);
      close(runs, bin, width);
      runs.back().count = whole - 1;
      left.begin += (whole - 1) * width;
      bin.edge = left.begin + width;
    }
    bin.put(left, left.end - left.begin, left.begun);
  }
  close(runs, bin, width);
  return runs;
}

/// Begins the next bin.
void ActivityRecord::close(std::vector<Run>& runs, Bin& bin, uint64_t width) const {
  Run run{bin.edge / width - 1, 1, std::vector<Share>(seen_count_)};
  for_bits(seen_, [&](unsigned part) { run.shares[slots_[part]] = bin.shares[part]; });
  runs.push_back(std::move(run));
  bin = {};
  bin.edge = (runs.back().first + 2) * width;
}

/// `ratio`: bins of the run in one of the level.
void ActivityRecord::add(Level& level, const Run& run, uint64_t ratio) const {
  const uint64_t end = run.first + run.count;
  uint64_t at = run.first;
  const auto put_until = [&](uint64_t next) {
    if (next <= at) return;
    const uint64_t bins = std::max<uint64_t>(1, (next - at) / ratio);
    put(level, at / ratio, bins, run, (next - at) / bins);
    at = next;
  };
  put_until(std::min(end, (at + ratio - 1) / ratio * ratio));
  put_until(std::max(at, end / ratio * ratio));
  put_until(end);
  const uint64_t newest = level.runs.back().first + level.runs.back().count;
  while (level.runs.front().first + level.runs.front().count + bin_count < newest)
    level.runs.pop_front();
}

/// Into each of some bins a run's shares, several times.
void ActivityRecord::put(Level& level, uint64_t bin, uint64_t count, const Run& run,
                         uint64_t times) const {
  const bool is_new = level.runs.empty() || level.runs.back().first != bin;
  if (is_new) level.runs.push_back({bin, count, {}});
  std::vector<Share>& shares = level.runs.back().shares;
  if (shares.size() < run.shares.size()) shares.resize(run.shares.size());
  for (std::size_t slot = 0; slot < run.shares.size(); ++slot) {
    shares[slot].ps += run.shares[slot].ps * times;
    shares[slot].begun += run.shares[slot].begun * times;
  }
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
