// The observers of a run.
#pragma once

#include <optional>
#include <string>

#include "backend/coprocessor_backend.h"
#include "base/result.h"
#include "explain/program_view.h"
#include "inputs/run_inputs.h"
#include "observers/observation.h"
#include "observers/run_observer.h"
#include "ports/uart_lines.h"
#include "soc/soc.h"

namespace capsoc::run {

class RunSettings;

/// Makes the observers that the settings ask for. Everything that it is given must outlive it.
class RunWatch {
 public:
  RunWatch(const RunSettings& settings, const RunInputs& inputs, soc::Soc& soc,
           const ProgramView& view, CoprocessorBackend& backend)
      : settings_(settings), inputs_(inputs), soc_(soc), view_(view), backend_(backend) {}

  /// Those of the board, before programs are loaded.
  std::optional<Error> observe_board();
  /// Those of the program, when it is loaded.
  std::optional<Error> observe_program();
  /// Those whose outputs are opened after the host's ports.
  std::optional<Error> observe_outputs(const UartLines& uarts);

  Observation& observation() { return *observation_; }
  Observers& all() { return observers_; }
  const Observers& all() const { return observers_; }

 private:
  template <typename T, typename... Arguments>
  std::optional<Error> add(Arguments&&... arguments);

  const RunSettings& settings_;
  const RunInputs& inputs_;
  soc::Soc& soc_;
  const ProgramView& view_;
  CoprocessorBackend& backend_;
  Observers observers_;
  Observation* observation_ = nullptr;  ///< one of them
};

}  // namespace capsoc::run
