// A recording at the pins of a design, interval by interval, as an APB and an ADC drive them. Each
// access has its setup phase, what no strobe covers is noise, and nothing is known but the pins.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "regress/recording.h"
#include "rtl/lockstep.h"
#include "rtl/rtl_library.h"

namespace capsoc::regress {

class PinReplay {
 public:
  explicit PinReplay(rtl::RtlLibrary::Handle library);

  /// Events in order of their edges, all of those before edge `known`. Does the intervals for which
  /// nothing can come any more, up to the first difference.
  void feed(const std::vector<Event>& events, uint64_t known);

  const std::optional<rtl::Difference>& difference() const { return difference_; }
  /// The difference and the last transfers and samples before it, several lines.
  std::string report() const;

  /// From edge `begin` on, an edge every `period_ns`. Error: cannot be written.
  std::optional<Error> open_waves(const std::string& file, uint64_t begin, unsigned period_ns);
  void close_waves();

  /// How much was compared.
  struct Counts {
    uint64_t edges = 0, reads = 0, writes = 0, samples = 0;
  };
  const Counts& counts() const { return counts_; }

 private:
  bool has(uint32_t pin) const { return (api_.absent_pins & pin) == 0; }
  void interval();
  void drive();
  void transfer(const Event& event, bool access);
  void check();
  void check_access(const Event& event);
  void clock();
  void differ(std::string what, uint64_t model, uint64_t rtl);

  rtl::RtlLibrary::Handle library_;
  const capsoc_rtl_api& api_;
  std::unique_ptr<capsoc_rtl, void (*)(capsoc_rtl*)> instance_;
  capsoc_rtl_pins& pins_;

  uint64_t now_ = 0;               ///< the interval, and the edge before it
  std::deque<Event> events_;       ///< from the present edge on
  const Event* access_ = nullptr;  ///< under way in this interval
  const Event* sample_ = nullptr;
  bool interrupt_ = false, idle_ = true;  ///< as the model has them
  std::optional<rtl::Difference> difference_;
  std::deque<Event> transfers_, samples_;  ///< the last ones
  Counts counts_;

  std::string waves_;  ///< the file; "": none
  uint64_t waves_begin_ = 0;
  unsigned period_ns_ = 0;
  bool waves_open_ = false;
};

}  // namespace capsoc::regress
