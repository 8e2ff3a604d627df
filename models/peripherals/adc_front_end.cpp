#include "peripherals/adc_front_end.h"

#include <fmt/format.h>

#include <algorithm>

#include "capsoc_registers.h"
#include "kit/register_table.h"
#include "kit/seconds.h"
#include "peripherals/quantiser.h"

namespace capsoc::peripherals {

using namespace registers::adc;
using kit::describe;

namespace {

// One conversion takes a tick of the coprocessor's pipeline (32 cycles); faster samples would be
// dropped there.
constexpr uint32_t minimum_period = 32;

}  // namespace

AdcFrontEnd::AdcFrontEnd(const sc_core::sc_module_name& name, kit::ClockDomain& clock,
                         Source source)
    : RegisterBank(name, block_size, kit::AccessRule::word_only),
      id(*this, describe(table, ID_offset)),
      ctrl(*this, describe(table, CTRL_offset)),
      status(*this, describe(table, STATUS_offset)),
      flags(*this, describe(table, FLAGS_offset)),
      period(*this, describe(table, PERIOD_offset)),
      bits(*this, describe(table, BITS_offset)),
      data_u(*this, describe(table, DATA_U_offset)),
      data_v(*this, describe(table, DATA_V_offset)),
      count(*this, describe(table, COUNT_offset)),
      clock_(clock),
      source_(std::move(source)) {
  ctrl.on_write([this](uint32_t value) { write_ctrl(value); });
  period.on_write([this](uint32_t value) { write_period(value); });
  bits.on_write([this](uint32_t value) { write_bits(value); });
  flags.on_write([this](uint32_t value) {
    flags.store(value);
    update_interrupt();
  });
  clock_.on_change([this] {
    clock_changed_ = true;
    if (status.any(STATUS_RUNNING_mask)) schedule();
  });

  sc_core::sc_spawn_options options;
  options.spawn_method();
  options.dont_initialize();
  options.set_sensitivity(&sample_event_);
  sc_core::sc_spawn([this] { take_sample(); }, "take_sample", &options);
}

void AdcFrontEnd::reset() {
  stop();
  reset_registers();
  bits.set(fitted_bits_);
  update_interrupt();
}

void AdcFrontEnd::fit_converter(uint32_t width) {
  fitted_bits_ = std::clamp<uint32_t>(width, minimum_bits, maximum_bits);
  bits.set(fitted_bits_);
}

void AdcFrontEnd::write_ctrl(uint32_t value) {
  const bool was_running = ctrl.any(CTRL_RUN_mask);
  ctrl.store(value);
  const bool runs = ctrl.any(CTRL_RUN_mask);
  if (runs && !was_running) start();
  if (!runs && was_running) stop();
  update_interrupt();
}

void AdcFrontEnd::write_period(uint32_t value) {
  if (value >= minimum_period) {
    period.store(value);
    return;
  }
  report(fmt::format("PERIOD {} is below {} cycles and ignored", value, minimum_period));
  flags.raise(FLAGS_CONFIG_mask);
}

void AdcFrontEnd::write_bits(uint32_t value) {
  if (value >= minimum_bits && value <= maximum_bits) {
    bits.store(value);
    return;
  }
  report(fmt::format("BITS {} is not {} to {} and ignored", value, minimum_bits, maximum_bits));
  flags.raise(FLAGS_CONFIG_mask);
}

void AdcFrontEnd::start() {
  index_ = 0;
  count.set(0);
  status.clear(STATUS_ENDED_mask);
  status.raise(STATUS_RUNNING_mask);
  next_cycle_ = clock_.cycles_at(access_time()) + period.get();
  schedule();
}

void AdcFrontEnd::stop() {
  sample_event_.cancel();
  ctrl.clear(CTRL_RUN_mask);
  status.clear(STATUS_RUNNING_mask);
}

void AdcFrontEnd::schedule() {
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  const sc_core::sc_time due = clock_.time_of(next_cycle_);
  sample_event_.cancel();
  sample_event_.notify(due > now ? due - now : sc_core::SC_ZERO_TIME);
}

void AdcFrontEnd::take_sample() {
  if (index_ == 0) first_sample_ = sc_core::sc_time_stamp();
  const double seconds = sample_seconds();
  const std::optional<AdcInput> input = source_ ? source_(index_, seconds) : std::nullopt;
  if (!input) {
    finish();
    return;
  }
  // The next sample is planned first: a sink that stops the front-end then finds it to stop.
  if (index_ == 0 || clock_changed_ || period.get() != segment_.period) {
    segment_ = {index_, seconds, period.get(), clock_.frequency_hz()};
    clock_changed_ = false;
  }
  next_cycle_ += period.get();
  schedule();
  convert(*input);
}

double AdcFrontEnd::sample_seconds() const {
  if (index_ == 0) return 0.0;
  if (clock_changed_) return kit::to_seconds(sc_core::sc_time_stamp() - first_sample_);
  const uint64_t cycles = (index_ - segment_.index) * segment_.period;
  return segment_.seconds + static_cast<double>(cycles) / static_cast<double>(segment_.hz);
}

void AdcFrontEnd::convert(const AdcInput& input) {
  const Quantised u = quantise(input.u, bits.get());
  const Quantised v = quantise(input.v, bits.get());
  const uint64_t index = index_++;
  data_u.set(static_cast<uint32_t>(u.word));
  data_v.set(static_cast<uint32_t>(v.word));
  count.set(static_cast<uint32_t>(index_));
  flags.raise(FLAGS_SAMPLE_mask);
  if (u.clipped) flags.raise(FLAGS_CLIP_U_mask);
  if (v.clipped) flags.raise(FLAGS_CLIP_V_mask);
  update_interrupt();
  const SensorSample sample{u.word, v.word, u.clipped || v.clipped, input.number, input.channel};
  conversions(index, sample);
  if (sink_) sink_(sample);
}

void AdcFrontEnd::finish() {
  stop();
  status.raise(STATUS_ENDED_mask);
  flags.raise(FLAGS_END_mask);
  update_interrupt();
}

void AdcFrontEnd::update_interrupt() {
  const bool sample = flags.any(FLAGS_SAMPLE_mask) && ctrl.any(CTRL_IE_SAMPLE_mask);
  const bool end = flags.any(FLAGS_END_mask) && ctrl.any(CTRL_IE_END_mask);
  const bool clip = flags.any(FLAGS_CLIP_U_mask | FLAGS_CLIP_V_mask) && ctrl.any(CTRL_IE_CLIP_mask);
  interrupt.set(sample || end || clip);
}

void AdcFrontEnd::Segment::visit(Archive& archive) {
  archive("index", index);
  archive("seconds", seconds);
  archive("period", period);
  archive("hz", hz);
}

void AdcFrontEnd::visit(Archive& archive) {
  RegisterBank::visit(archive);
  archive("index", index_);
  archive("next_cycle", next_cycle_);
  archive("segment", segment_);
  archive("clock_changed", clock_changed_);
  uint64_t first_sample = first_sample_.value();
  archive("first_sample", first_sample);
  first_sample_ = sc_core::sc_time::from_value(first_sample);
  if (period.get() < minimum_period) archive.refuse("samples too fast");
  if (bits.get() < minimum_bits || bits.get() > maximum_bits)
    archive.refuse("has no such converter");
}

void AdcFrontEnd::restored() {
  sample_event_.cancel();
  if (status.any(STATUS_RUNNING_mask)) schedule();
}

}  // namespace capsoc::peripherals
