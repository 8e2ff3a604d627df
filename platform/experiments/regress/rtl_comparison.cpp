#include "regress/rtl_comparison.h"

#include <fmt/format.h>

#include "coprocessor/coprocessor.h"
#include "host/files.h"
#include "rtl/coprocessor_rtl.h"
#include "rtl/lockstep.h"
#include "trace/save_file.h"
#include "trace/wave_file.h"

namespace capsoc::regress {
namespace {

constexpr double cycle_ns = 40;  // PCLK of the platform, for the report only

class LockstepComparison final : public Comparison {
 public:
  LockstepComparison(const coprocessor::Options& options,
                     std::unique_ptr<coprocessor::Device> other, rtl::CoprocessorRtl* rtl)
      : lockstep_(std::make_unique<coprocessor::Coprocessor>(options), std::move(other)),
        rtl_(rtl) {}

  coprocessor::Device& device() override { return lockstep_; }
  bool differs() const override { return lockstep_.difference().has_value(); }

  std::optional<Finding> finding() const override {
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
        lockstep_.report("", cycle_ns),
        history.first_cycle,
        std::move(waves)};
  }

  Result<bool> write_waves(const std::string& file) override {
    const auto& difference = lockstep_.difference();
    if (!difference || rtl_ == nullptr) return false;
    const std::string name = file + ".fst";
    auto waves = trace::WaveFile::at(name);
    if (!waves) return Error{waves.error()};
    if (auto error = lockstep_.write_waves(waves.value().growing())) return *error;
    if (auto error = waves.value().finish()) return *error;
    if (auto error = host::write_whole(trace::save_file(name), save_text(name))) return *error;
    return true;
  }

  std::optional<Error> write_coverage(const std::string& file) override {
    if (rtl_ == nullptr) return std::nullopt;
    return rtl_->write_coverage(file);
  }

 private:
  static constexpr std::size_t most_nodes = 8;

  /// What to look at: the nodes that differ, model above RTL, then the pins.
  std::string save_text(const std::string& waves) const {
    constexpr uint64_t cycles_shown = 96;
    using Radix = trace::SaveText::Radix;
    trace::SaveText save(waves);
    save.show_around(difference_ns(), cycles_shown * static_cast<uint64_t>(cycle_ns));
    save.begin_group("nodes that differ");
    for (const rtl::NodeHistory& node : lockstep_.history(1, 1, most_nodes).nodes) {
      save.add(Radix::hexadecimal, fmt::format("rtl.model_{}_i[63:0]", node.name));
      save.add(Radix::hexadecimal, fmt::format("rtl.node_{}_o[63:0]", node.name));
    }
    save.end_group("nodes that differ");
    save.begin_group("pins");
    for (const char* bit : {"pclk_i", "presetn_i", "psel_i", "penable_i", "pwrite_i", "pslverr_o",
                            "sample_valid_i", "sample_ready_o", "irq_o", "idle_o"})
      save.add(Radix::binary, fmt::format("rtl.{}", bit));
    for (const char* word : {"paddr_i[11:0]", "pwdata_i[31:0]", "prdata_o[31:0]",
                             "sample_u_i[31:0]", "sample_v_i[31:0]"})
      save.add(Radix::hexadecimal, fmt::format("rtl.{}", word));
    save.end_group("pins");
    save.begin_group("sequencer");
    save.add(Radix::binary, "rtl.boundary_o");
    save.add(Radix::hexadecimal, "rtl.cycle_o[4:0]");
    save.add(Radix::binary, "rtl.stage_o[4:0]");
    save.add(Radix::binary, "rtl.load_o[2:0]");
    save.end_group("sequencer");
    return save.text();
  }

  uint64_t difference_ns() const {
    return lockstep_.difference()->cycle * static_cast<uint64_t>(cycle_ns);
  }

  rtl::Lockstep lockstep_;
  rtl::CoprocessorRtl* rtl_;  // inside of it; null if the other device is no RTL
};

}  // namespace

std::unique_ptr<Comparison> compare_with(const coprocessor::Options& options,
                                         std::unique_ptr<coprocessor::Device> other) {
  return std::make_unique<LockstepComparison>(options, std::move(other), nullptr);
}

std::unique_ptr<Comparison> compare_with_rtl(const coprocessor::Options& options,
                                             const rtl::RtlLibrary::Handle& library) {
  auto device = std::make_unique<rtl::CoprocessorRtl>(library);
  rtl::CoprocessorRtl* inside = device.get();
  return std::make_unique<LockstepComparison>(options, std::move(device), inside);
}

}  // namespace capsoc::regress
