#include "regress/rtl_comparison.h"

#include <fmt/format.h>

#include "coprocessor/coprocessor.h"
#include "host/files.h"
#include "regress/pin_replay.h"
#include "regress/recording.h"
#include "rtl/coprocessor_rtl.h"
#include "rtl/lockstep.h"
#include "trace/save_file.h"
#include "trace/wave_file.h"

namespace capsoc::regress {
namespace {

constexpr unsigned period_ns = 40;  // PCLK of the platform, for reports only
constexpr uint64_t cycles_shown = 96;

using Radix = trace::SaveText::Radix;

void add_pins(trace::SaveText& save) {
  save.begin_group("pins");
  for (const char* bit : {"pclk_i", "presetn_i", "psel_i", "penable_i", "pwrite_i", "pslverr_o",
                          "sample_valid_i", "sample_ready_o", "irq_o", "idle_o"})
    save.add(Radix::binary, fmt::format("rtl.{}", bit));
  for (const char* word : {"paddr_i[11:0]", "pwdata_i[31:0]", "prdata_o[31:0]", "sample_u_i[31:0]",
                           "sample_v_i[31:0]"})
    save.add(Radix::hexadecimal, fmt::format("rtl.{}", word));
  save.end_group("pins");
}

/// FILE.fst by `write`, whole or not at all, and next to it what GTKWave shows of it.
template <typename Write, typename AddMore>
Result<bool> write_both(const std::string& file, const Write& write, const AddMore& add_more) {
  const std::string name = file + ".fst";
  auto waves = trace::WaveFile::at(name);
  if (!waves) return Error{waves.error()};
  if (auto error = write(waves.value().growing())) return *error;
  if (auto error = waves.value().finish()) return *error;
  trace::SaveText save(name);
  add_more(save);
  add_pins(save);
  if (auto error = host::write_whole(trace::save_file(name), save.text())) return *error;
  return true;
}

class LockstepComparison final : public Comparison {
 public:
  LockstepComparison(const coprocessor::Options& options,
                     std::unique_ptr<coprocessor::Device> other, rtl::CoprocessorRtl* rtl)
      : lockstep_(std::make_unique<coprocessor::Coprocessor>(options), std::move(other)),
        rtl_(rtl) {}

  coprocessor::Device& device() override { return lockstep_; }
  bool differs() override { return lockstep_.difference().has_value(); }

  std::optional<Finding> finding() override {
    const auto& difference = lockstep_.difference();
    if (!difference) return std::nullopt;
    constexpr uint64_t before = 24, after = 16;
    rtl::History history = lockstep_.history(before, after, most_nodes);
    std::vector<Wave> waves;
    for (rtl::NodeHistory& node : history.nodes)
      waves.push_back({std::move(node.name), std::move(node.model), std::move(node.rtl)});
    return Finding{
        Finding::Kind::difference,
        difference->cycle,
        fmt::format("{}: model {}, RTL {}", difference->what, difference->model, difference->rtl),
        difference->node,
        lockstep_.report("", period_ns),
        history.first_cycle,
        std::move(waves)};
  }

  Result<bool> write_waves(const std::string& file, const Again&) override {
    const auto& difference = lockstep_.difference();
    if (!difference || rtl_ == nullptr) return false;
    return write_both(
        file, [&](const std::string& growing) { return lockstep_.write_waves(growing); },
        [&](trace::SaveText& save) { add_nodes(save); });
  }

  std::optional<Error> write_coverage(const std::string& file) override {
    if (rtl_ == nullptr) return std::nullopt;
    return rtl_->write_coverage(file);
  }

 private:
  static constexpr std::size_t most_nodes = 8;

  /// The nodes that differ, model above RTL, and where the pipeline is.
  void add_nodes(trace::SaveText& save) const {
    save.show_around(lockstep_.difference()->cycle * period_ns, cycles_shown * period_ns);
    save.begin_group("nodes that differ");
    for (const rtl::NodeHistory& node : lockstep_.history(1, 1, most_nodes).nodes) {
      save.add(Radix::hexadecimal, fmt::format("rtl.model_{}_i[63:0]", node.name));
      save.add(Radix::hexadecimal, fmt::format("rtl.node_{}_o[63:0]", node.name));
    }
    save.end_group("nodes that differ");
    save.begin_group("sequencer");
    save.add(Radix::binary, "rtl.boundary_o");
    save.add(Radix::hexadecimal, "rtl.cycle_o[5:0]");
    save.add(Radix::binary, "rtl.stage_o[4:0]");
    save.add(Radix::binary, "rtl.load_o[2:0]");
    save.end_group("sequencer");
  }

  rtl::Lockstep lockstep_;
  rtl::CoprocessorRtl* rtl_;  // inside of it; null if the other device is no RTL
};

/// The model answers, and what it was asked and answered goes to the pins of the design.
class PinComparison final : public Comparison {
 public:
  PinComparison(const coprocessor::Options& options, const rtl::RtlLibrary::Handle& library)
      : options_(options),
        library_(library),
        recorder_(options, recording_, Looks::as_reads),
        replay_(library) {}

  Bench::Bus bus() const override { return Bench::Bus::with_setup; }
  coprocessor::Device& device() override { return recorder_; }

  bool differs() override {
    constexpr std::size_t events_at_once = 4096;
    if (recording_.events.size() >= events_at_once) replay(recorder_.edge());
    return replay_.difference().has_value();
  }

  std::optional<Finding> finding() override {
    finish();
    const auto& difference = replay_.difference();
    if (!difference) return std::nullopt;
    return Finding{
        Finding::Kind::difference,
        difference->cycle,
        fmt::format("{}: model {}, RTL {}", difference->what, difference->model, difference->rtl),
        "",
        replay_.report(),
        0,
        {}};
  }

  Result<bool> write_waves(const std::string& file, const Again& again) override {
    if (!replay_.difference()) return false;
    constexpr uint64_t edges_before = 2000;
    const uint64_t at = replay_.difference()->cycle;
    const auto write = [&](const std::string& growing) -> std::optional<Error> {
      PinComparison second(options_, library_);
      const uint64_t begin = at > edges_before ? at - edges_before : 0;
      if (auto error = second.replay_.open_waves(growing, begin, period_ns)) return error;
      again(second.device(), [&second] { return second.differs(); });
      second.finish();
      second.replay_.close_waves();
      return std::nullopt;
    };
    return write_both(file, write, [&](trace::SaveText& save) {
      save.show_around(at * period_ns, cycles_shown * period_ns);
    });
  }

 private:
  void replay(uint64_t known) {
    replay_.feed(recording_.events, known);
    recording_.events.clear();
  }

  /// Until nothing moves any more.
  void finish() {
    constexpr uint64_t edges_behind = 400;  // results are read, which takes two edges each
    recorder_.advance(recorder_.edge() + edges_behind);
    recorder_.close();
    replay(recorder_.edge());
  }

  coprocessor::Options options_;
  rtl::RtlLibrary::Handle library_;
  Recording recording_;
  Recorder recorder_;
  PinReplay replay_;
};

}  // namespace

std::unique_ptr<Comparison> compare_with(const coprocessor::Options& options,
                                         std::unique_ptr<coprocessor::Device> other) {
  return std::make_unique<LockstepComparison>(options, std::move(other), nullptr);
}

std::unique_ptr<Comparison> compare_with_rtl(const coprocessor::Options& options,
                                             const rtl::RtlLibrary::Handle& library) {
  if (library->api().inside == nullptr) return std::make_unique<PinComparison>(options, library);
  auto device = std::make_unique<rtl::CoprocessorRtl>(library);
  rtl::CoprocessorRtl* inside = device.get();
  return std::make_unique<LockstepComparison>(options, std::move(device), inside);
}

Subject subject_of(coprocessor::Arithmetic arithmetic, const rtl::RtlLibrary::Handle& library) {
  const capsoc_rtl_api& api = library->api();
  Subject subject{arithmetic, api.source_hash, "pins and inside"};
  if (api.inside != nullptr) return subject;
  subject.seen = "pins";
  constexpr std::pair<uint32_t, const char*> may_be_absent[] = {
      {CAPSOC_RTL_PSTRB, "pstrb"},     {CAPSOC_RTL_PREADY, "pready"},
      {CAPSOC_RTL_PSLVERR, "pslverr"}, {CAPSOC_RTL_SAMPLE_READY, "sample_ready"},
      {CAPSOC_RTL_IRQ, "irq"},         {CAPSOC_RTL_IDLE, "idle"}};
  const char* separator = " without ";
  for (const auto& [pin, name] : may_be_absent) {
    if ((api.absent_pins & pin) == 0) continue;
    subject.seen += separator + std::string(name);
    separator = ", ";
  }
  return subject;
}

}  // namespace capsoc::regress
