#include "regress/bench.h"

#include <algorithm>
#include <utility>

#include "coprocessor/register_map.h"

namespace capsoc::regress {

using namespace coprocessor;

Bench::Bench(Device& device, Arithmetic arithmetic, Coverage& coverage,
             std::function<bool()> failed, Bus bus)
    : device_(device),
      tick_(device.tick()),
      arithmetic_(arithmetic),
      coverage_(coverage),
      failed_(std::move(failed)),
      setup_(bus == Bus::with_setup ? 1 : 0),
      bus_free_(setup_),
      shadow_(tick_) {
  steps_.fill(description::STEP_AU_reset);
}

// nodes() closes an edge, so results are fetched between the edge of their commit and the next one
// that is driven.
void Bench::advance(uint64_t edge) {
  if (edge <= edge_) return;
  while (!failed_()) {
    const uint64_t next = commit_seen_ ? turned_ : shadow_.busy() ? boundary_ : edge;
    if (next >= edge) break;
    device_.advance(next);
    if (!commit_seen_) turn();
    collect();
  }
  if (shadow_.busy() && boundary_ == edge) turn();
  device_.advance(edge);
  counts_.edges += edge - edge_;
  edge_ = edge;
  sampled_ = written_ = closed_ = false;
}

void Bench::open_edge() {
  if (closed_ || written_) advance(edge_ + 1);
}

void Bench::turn() {
  for (unsigned stage = 0; stage < stage_count; ++stage) ended_[stage] = shadow_.occupied(stage);
  commit_seen_ = ended_[4];
  turned_ = boundary_;
  shadow_.turn();
  if (shadow_.entered()) held_ = false;
  if (shadow_.load_stage() == 0u) load_waits_ = false;
  boundary_ += tick_;
}

void Bench::collect() {
  if (!commit_seen_) return;
  commit_seen_ = false;
  cover_commit();
}

void Bench::shadow_latch(bool latched) {
  if (!latched) return;
  if (!shadow_.busy()) boundary_ = edge_ + 1;
  shadow_.latch(edge_);
  held_ = true;
}

void Bench::shadow_reset() {
  shadow_.reset();
  held_ = load_waits_ = commit_seen_ = false;
  ended_ = {};
  ctrl_ = flags_ = status_ = 0;
  loop_ = description::LOOP_reset;
  steps_.fill(description::STEP_AU_reset);
  settled_at_ = edge_;
  staged_ = latched_ = {};
  since_reset_ = 0;
  turn_flags_ = 0;
  glitches_ = 0;
  judge_ = description::JUDGE_reset;
  safety_ = 0;
  unfit_ = 0;
  distrusted_ = false;
  last_angle_.reset();
}

std::optional<uint64_t> Bench::boundary() const {
  if (!shadow_.busy()) return std::nullopt;
  return boundary_;
}

bool Bench::sample(uint32_t u, uint32_t v, bool clip) {
  if (sampled_) advance(edge_ + 1);
  open_edge();
  sampled_ = true;
  ++counts_.samples;
  cover_spacing();
  const bool at_tick = turned_ == edge_ && ended_ != decltype(ended_){};
  const bool enabled = (ctrl_ & ctrl_adc) != 0;
  const bool expected = enabled && !held_;
  device_.submit(edge_, static_cast<int32_t>(u), static_cast<int32_t>(v), clip);
  coverage_.hit(Group::acceptance, !enabled ? 2 : expected ? 0 : 1);
  coverage_.hit_if(at_tick, Group::collision, 9);
  coverage_.hit_if(expected && turned_ == edge_ && shadow_.entered(), Group::acceptance, 5);
  coverage_.hit_if(expected && shadow_.load_stage().has_value(), Group::acceptance, 7);
  coverage_.hit_if(expected && clip, Group::event, 11);
  if (enabled && held_) flags_ |= flag_early;
  shadow_latch(expected);
  return expected;
}

// A write acts at the edge that ends its interval; that interval must not have had a read.
void Bench::write(uint32_t offset, uint32_t value, uint8_t strobes) {
  open_edge();
  if (edge_ < bus_free_ + 1) advance(bus_free_ + 1);
  written_ = true;
  bus_free_ = edge_ + setup_;
  ++counts_.accesses;
  if (strobes != all_strobes) {
    coverage_.hit(Group::strobes, strobes);
    device_.write_bytes(edge_, offset, value, strobes);
    return;
  }
  const bool soft_reset = offset == reg_ctrl && (value & ctrl_srst) != 0;
  cover_write(offset, value);
  const bool ok = device_.write(edge_, offset, value);
  if (!ok) return;
  if (soft_reset) {
    coverage_.hit(Group::soft_reset_moment, moment());
    coverage_.hit_if(sampled_ && held_, Group::collision, 14);
    shadow_reset();
    return;
  }
  if (offset == reg_soft_v) {
    const bool latched = !held_;
    coverage_.hit(Group::acceptance, latched ? 3 : 4);
    coverage_.hit_if(latched && (ctrl_ & ctrl_adc) != 0, Group::acceptance, 6);
    shadow_latch(latched);
  }
  if (offset == reg_cmd && (value & cmd_load) != 0) {
    coverage_.hit(Group::load_moment, moment());
    if (!shadow_.busy()) boundary_ = edge_ + 1;
    shadow_.request_load(edge_);
    load_waits_ = true;
  }
}

uint32_t Bench::read(uint32_t offset, bool debug) {
  if (edge_ < bus_free_) advance(bus_free_);
  closed_ = true;
  bus_free_ = edge_ + 1 + setup_;
  ++counts_.accesses;
  const RegisterAccess access = device_.read(edge_, offset, debug);
  cover_read(offset, debug, access.ok);
  if (access.ok && offset == reg_flags) cover_flags(access.value);
  if (access.ok && offset == reg_flags) flags_ = access.value;
  return access.value;
}

void Bench::pin_reset() {
  if (sampled_ || written_ || closed_) advance(edge_ + 1);
  coverage_.hit(Group::pin_reset_moment, moment());
  device_.reset();
  shadow_reset();
  closed_ = true;
  if (setup_ == 0) return;
  // The edge after it is made in reset, and a transfer begins again.
  advance(edge_ + 1);
  sampled_ = written_ = true;
  bus_free_ = edge_ + setup_;
}

bool Bench::interrupt() {
  closed_ = true;
  const bool level = device_.interrupt();
  cover_interrupt(level);
  return level;
}

void Bench::drain() {
  while (shadow_.busy() && !failed_()) advance(boundary_ + 1);
}

void Bench::write_pair(uint32_t low_offset, int64_t value) {
  const bool coefficient = low_offset >= reg_au_lo;
  if (coefficient) {
    const int64_t high = std::clamp<int64_t>((value + (1 << 14)) >> 15, INT32_MIN, INT32_MAX);
    write(low_offset, static_cast<uint32_t>(value - high * (1 << 15)));
    write(low_offset + 4, static_cast<uint32_t>(high));
  } else {
    write(low_offset, static_cast<uint32_t>(value & 0xFFFF));
    write(low_offset + 4, static_cast<uint32_t>(value >> 16));
  }
}

void Bench::soft_sample(uint32_t u, uint32_t v) {
  write(reg_soft_u, u);
  write(reg_soft_v, v);
  ++counts_.samples;
}

void Bench::complain(std::string what, std::string report) {
  complaint_ = Complaint{edge_, std::move(what), std::move(report)};
}

const Nodes& Bench::nodes() {
  closed_ = true;
  return device_.nodes();
}

}  // namespace capsoc::regress
