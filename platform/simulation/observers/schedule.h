// Who had the processor, and how long interrupts waited for it.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "armv7m/observer.h"
#include "base/result.h"
#include "base/setting_fields.h"
#include "explain/program_view.h"
#include "observers/run_observer.h"
#include "observers/schedule_settings.h"
#include "results/results.h"

namespace capsoc::run {

/// Is notified only of exceptions, so it costs next to nothing.
class Schedule final : public RunObserver, private armv7m::Observer {
 public:
  Schedule(const ProgramView& view, const ScheduleSettings& settings)
      : view_(view), settings_(settings) {}
  ~Schedule() override;

  /// Observes nothing unless the settings ask for it. An Error: tasks.current is neither a symbol
  /// nor an address.
  std::optional<Error> open() override;
  const char* gathered() const override { return "schedule"; }
  void visit_gathered(Archive& archive) override;
  void finish(RunResult& result) override;

 private:
  struct Task {
    std::string name;
    uint64_t cycles = 0, switches = 0;
    void visit(Archive& archive);
  };
  struct Waits {
    uint64_t count = 0, sum = 0, least = UINT64_MAX, most = 0;
    std::array<uint64_t, 64> by_size{};  ///< by the wait's number of binary digits
    void visit(Archive& archive);
  };
  struct Entry {
    unsigned exception = 0;
    uint64_t waited = 0;
    void visit(Archive& archive);
  };

  void issued(const armv7m::Core&, const armv7m::DecodedOp&) override {}
  void retired(const armv7m::Core&, const armv7m::DecodedOp&) override {}
  void entered(const armv7m::Core& core, unsigned exception, armv7m::Entry how,
               uint64_t since) override;
  void returned(const armv7m::Core& core, unsigned exception) override;
  void accessed(const armv7m::Core&, const armv7m::DirectAccess&) override {}
  void started(const armv7m::Core& core) override;

  void pended(unsigned exception);
  void charge(uint64_t until);
  void look_at_task();
  void note_entry();
  std::optional<uint32_t> read_word(uint32_t address) const;
  std::string name_of(uint32_t task) const;

  const ProgramView& view_;
  const ScheduleSettings& settings_;
  std::optional<uint32_t> current_;  ///< the pointer's address
  bool times_interrupts_ = false;
  std::map<uint32_t, Task> tasks_;  ///< 0: handlers and what ran before the first task
  uint32_t running_ = 0, last_task_ = 0;
  uint64_t since_ = 0;
  std::array<uint64_t, 64> pended_at_{};  ///< by exception; `never`: it does not wait
  std::array<Waits, 64> waits_{};
  std::optional<Entry> entry_;  ///< of the handler that has just been entered
};

}  // namespace capsoc::run
