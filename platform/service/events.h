// What happened in a simulation, for the clients that subscribed to it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <systemc>
#include <utility>
#include <vector>

#include "armv7m/observer.h"
#include "base/result.h"
#include "kit/probe.h"
#include "metrics/sample_record.h"
#include "service/message.h"
#include "soc/soc.h"

namespace capsoc::service {

class UartTap;

/// Collects events of the kinds that were asked for, with their simulated times, until they are
/// taken. Looks only.
class Events final : private armv7m::Observer {
 public:
  /// Of all that are kept, written as JSON, where a byte of a line may take six: they fit a
  /// message.
  static constexpr std::size_t most_bytes = std::size_t{12} << 20;

  Events() = default;
  ~Events() override;
  Events(const Events&) = delete;
  Events& operator=(const Events&) = delete;

  static const std::vector<std::string>& kinds();

  void attach(soc::Soc& soc) { soc_ = &soc; }
  /// From now on these kinds and no others. An Error: there is no such kind.
  std::optional<Error> subscribe(const std::vector<std::string>& kinds,
                                 std::array<UartTap, soc::Soc::uart_count>& uarts);
  /// Those since the last call, in the order in which they came; the last one of kind "lost" says
  /// how many were too many.
  Json take();
  /// The kinds that are asked for.
  const std::vector<std::string>& subscribed() const { return subscribed_; }
  /// Time until which events were already reported: after going back they are not reported again.
  sc_core::sc_time told() const;
  void set_told(const sc_core::sc_time& told) { told_ = told; }

  /// A result of the coprocessor is there.
  void sample(uint64_t number, const metrics::RecordedSample& sample);
  /// What the program states of its results, as JSON; null: nothing. Before subscribe().
  void read_verdicts_by(std::function<Json()> read) { read_verdict_ = std::move(read); }
  /// The program may have stated another verdict: at a result of the coprocessor, at the end of the
  /// run.
  void look_for_verdict();

  /// Calls back when the processor enters this exception; below 0: never.
  void watch_exception(int number, std::function<void()> on_entry);

 private:
  void add(Json event, std::size_t line = 0);
  void look();
  void listen_to_guest(bool wanted);

  void issued(const armv7m::Core&, const armv7m::DecodedOp&) override {}
  void retired(const armv7m::Core&, const armv7m::DecodedOp&) override {}
  void entered(const armv7m::Core& core, unsigned exception, armv7m::Entry how,
               uint64_t since) override;
  void returned(const armv7m::Core&, unsigned) override {}
  void accessed(const armv7m::Core&, const armv7m::DirectAccess&) override {}
  void started(const armv7m::Core&) override {}

  soc::Soc* soc_ = nullptr;
  std::deque<Json> events_;
  std::size_t bytes_ = 0;  ///< of events_
  uint64_t lost_ = 0;
  std::vector<std::string> subscribed_;
  sc_core::sc_time told_;
  /// Kinds that are wanted.
  bool exceptions_ = false, faults_ = false, samples_ = false, verdicts_ = false;
  std::function<Json()> read_verdict_;
  Json verdict_;  ///< the last one that was seen
  bool looking_ = false, listening_to_guest_ = false;
  int watched_ = -1;
  std::function<void()> on_entry_;
  std::vector<kit::Listening> listening_;
};

}  // namespace capsoc::service
