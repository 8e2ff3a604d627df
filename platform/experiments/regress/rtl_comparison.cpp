#include "regress/rtl_comparison.h"

#include <fmt/format.h>

#include "coprocessor/coprocessor.h"
#include "rtl/coprocessor_rtl.h"
#include "rtl/lockstep.h"

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
    constexpr std::size_t most_nodes = 8;
    rtl::History history = lockstep_.history(before, after, most_nodes);
    std::vector<Wave> waves;
    for (rtl::NodeHistory& node : history.nodes)
      waves.push_back({std::move(node.name), std::move(node.model), std::move(node.rtl)});
    return Finding{
        difference->cycle,
        fmt::format("{}: model {}, RTL {}", difference->what, difference->model, difference->rtl),
        difference->node,
        lockstep_.report("", cycle_ns),
        true,
        history.first_cycle,
        std::move(waves)};
  }

  std::optional<Error> write_coverage(const std::string& file) override {
    if (rtl_ == nullptr) return std::nullopt;
    return rtl_->write_coverage(file);
  }

 private:
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
