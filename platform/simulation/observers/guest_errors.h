// The errors of the guest in a run: where the program was at each, and a summary of the repeated.
#pragma once

#include <optional>

#include "explain/program_view.h"
#include "observers/run_observer.h"

namespace capsoc::run {

/// Gives each message of kit::guest_error() the program's place while it lives. One at a time in a
/// process. The counts of the messages are a part of the checkpoint of their own (parts_of()).
class GuestErrors final : public RunObserver {
 public:
  explicit GuestErrors(const ProgramView& view) : view_(view) {}
  ~GuestErrors() override;

  std::optional<Error> open() override;
  void close(RunResult& result) override;

 private:
  const ProgramView& view_;
};

}  // namespace capsoc::run
