#include "coprocessor/tlm/coprocessor_tlm.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/printable.h"
#include "capsoc_registers.h"
#include "coprocessor/channel_register.h"
#include "coprocessor/sequencer.h"

namespace capsoc::coprocessor {

CoprocessorTlm::CoprocessorTlm(const sc_core::sc_module_name& name, kit::ClockDomain& clock,
                               std::unique_ptr<Device> device)
    : RegisterTarget(name, registers::coprocessor::block_size, kit::AccessRule::word_only),
      clock_(clock),
      device_(std::move(device)) {
  clock.on_change([this] { follow(); });
  sc_core::sc_spawn_options method;
  method.spawn_method();
  method.dont_initialize();
  method.set_sensitivity(&event_);
  const auto on_event = [this] {
    catch_up();
    follow();
  };
  sc_core::sc_spawn(on_event, "on_event", &method);
}

// A second sample in an interval, like a second access, carries the device one edge ahead of
// simulated time, where it waits: no sample and no access is lost.
void CoprocessorTlm::sample(const peripherals::SensorSample& sample) {
  catch_up();
  if (clock_.is_stopped()) return samples(clock_.domain_cycle(interval_ + 1), false, sample.number);
  if (sample_) run_to(interval_ + 1);
  sample_ = sample;
  follow();
}

void CoprocessorTlm::reset() {
  catch_up();
  sample_.reset();
  write_.reset();
  device_->reset();
  commits_ = 0;
  taken_.clear();
  follow();
}

void CoprocessorTlm::catch_up() {
  run_to(clock_.cycles_at(access_time()));
  if (!clock_.is_behind() || clock_.is_stopped() || waiting() || !device_->idle()) return;
  clock_.catch_up();
  run_to(clock_.cycles_at(access_time()));
}

/// What is on the pins at an edge that does not come.
void CoprocessorTlm::drop_inputs() {
  if (sample_) samples(clock_.domain_cycle(interval_ + 1), false, sample_->number);
  sample_.reset();
  write_.reset();
}

void CoprocessorTlm::lose_clock_edge() {
  catch_up();
  drop_inputs();
  clock_.lose_edge();
  follow();
}

void CoprocessorTlm::stop_clock() {
  catch_up();
  drop_inputs();
  clock_.stop(sc_core::sc_time_stamp());
  follow();
}

void CoprocessorTlm::start_clock() {
  clock_.start(sc_core::sc_time_stamp());
  follow();
}

bool CoprocessorTlm::is_behind_clock() {
  catch_up();
  follow();
  return clock_.is_behind();
}

// Event by event, so that the observer misses no sample even when an access comes first in an
// instant.
void CoprocessorTlm::run_to(uint64_t cycle) {
  while (interval_ < cycle) {
    uint64_t edge = cycle;
    if (waiting()) {
      edge = interval_ + 1;
    } else if (const auto next = device_->next_event()) {
      edge = std::clamp(*next, interval_ + 1, cycle);
    }
    pass(edge);
  }
}

void CoprocessorTlm::pass(uint64_t edge) {
  device_->advance(edge);
  if (sample_) take(edge);
  if (write_) {
    device_->write(edge, write_->offset, write_->value);
    write_.reset();
  }
  interval_ = edge;
  const Nodes& nodes = device_->nodes();
  const bool result = nodes.commits > commits_;
  commits_ = nodes.commits;
  if (result) results(clock_.domain_cycle(edge), nodes, number_of(nodes));
}

void CoprocessorTlm::take(uint64_t edge) {
  const peripherals::SensorSample sample = *sample_;
  sample_.reset();
  const bool latched = device_->submit_of(sample.channel, edge, sample.u, sample.v, sample.clip);
  if (latched) {
    // One waits and one is in each stage; more were lost by soft resets.
    if (taken_.size() == 1 + stage_count) taken_.pop_front();
    taken_.push_back({edge, sample.number});
  }
  samples(clock_.domain_cycle(edge), latched, sample.number);
}

/// Results come in the order of their samples.
uint64_t CoprocessorTlm::number_of(const Nodes& nodes) {
  while (!taken_.empty() && taken_.front().edge < nodes.taken) taken_.pop_front();
  if (taken_.empty() || taken_.front().edge != nodes.taken) return 0;
  const uint64_t number = taken_.front().number;
  taken_.pop_front();
  return number;
}

void CoprocessorTlm::begin_access() {
  catch_up();
  if (write_ || accessed_ == interval_) run_to(interval_ + 1);
  accessed_ = interval_;
}

void CoprocessorTlm::follow() {
  interrupt.set(device_->interrupt());
  event_.cancel();
  std::optional<uint64_t> next = device_->next_event();
  if (waiting()) next = interval_ + 1;
  if (!next || clock_.is_stopped()) return;
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  const sc_core::sc_time due = clock_.time_of(*next);
  event_.notify(due > now ? due - now : sc_core::SC_ZERO_TIME);
}

bool CoprocessorTlm::read_word(uint32_t offset, uint32_t& value, bool debug) {
  // Without a clock nothing latches what the bus reads.
  const bool latches = !debug && !clock_.is_stopped();
  if (latches) begin_access();
  const RegisterAccess result = device_->read(interval_, offset, !latches);
  if (latches) follow();
  value = result.value;
  if (!result.ok && !debug) report(fmt::format("read at 0x{:03x}, where no register is", offset));
  return result.ok;
}

// Whether a write is answered with an error depends on its address alone, so the answer need not
// wait for the edge.
bool CoprocessorTlm::write_word(uint32_t offset, uint32_t value, uint32_t /*lanes: always all*/) {
  const bool mapped = is_register(offset) || is_channel_register(offset, device_->channels());
  if (!clock_.is_stopped()) {
    begin_access();
    write_ = Write{offset, value};
    follow();
  }
  if (!mapped) {
    report(fmt::format("write of 0x{:08x} at 0x{:03x}, where no register is", value, offset));
  } else if (const auto complaint = write_complaint(offset, value); !complaint.empty()) {
    report(fmt::format("write of 0x{:08x} at 0x{:03x}: {}", value, offset, complaint));
  }
  return mapped;
}

std::optional<sc_core::sc_time> CoprocessorTlm::quiet_at() const {
  if (waiting()) return clock_.time_of(interval_ + 1);
  if (device_->idle()) return std::nullopt;
  return clock_.time_of(device_->next_event().value_or(interval_ + 1));
}

bool CoprocessorTlm::change_idle(const Device::IdleChange& change) {
  catch_up();
  if (waiting() || !device_->change_idle(change)) return false;
  follow();
  return true;
}

void CoprocessorTlm::visit(Archive& archive) {
  if (archive.loading()) clock_.forget_faults();
  // Idle, it is the same whatever device is here; in between every device has its own.
  IdleState state;
  if (device_->channels() > 1) state.contexts.resize(device_->channels());
  bool idle = device_->save_idle(state);
  archive("idle", idle);
  std::string kind = idle ? "any" : device_->kind();
  archive("device", kind);
  if (!archive.ok()) return;
  if (!idle && kind != device_->kind())
    return archive.refuse(fmt::format(
        "was saved while the coprocessor computed; only --coprocessor {} can resume from there",
        printable(kind)));
  archive("interval", interval_);
  archive("sample", sample_);
  if (sample_ && device_->channels() > 1)
    archive.at_most("channel", sample_->channel, device_->channels() - 1);
  archive("write", write_);
  archive("accessed", accessed_);
  archive("commits", commits_);
  archive.sequence("taken", taken_, 1 + stage_count);
  if (interval_ > clock_.cycles_at(sc_core::sc_time::from_value(archive.time())) + 2)
    archive.refuse("is ahead of time");
  if (!idle) return device_->visit(archive);
  archive("state", state);
  if (!archive.loading() || !archive.ok()) return;
  if (state.cycle != interval_) return archive.refuse("has the state of another time");
  if (!device_->load_idle(state)) archive.refuse("cannot be loaded");
}

}  // namespace capsoc::coprocessor
