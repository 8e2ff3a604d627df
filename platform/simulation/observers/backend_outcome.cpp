#include "observers/backend_outcome.h"

#include <fmt/format.h>

#include <utility>

#include "trace/wave_file.h"

namespace capsoc::run {

BackendOutcome::BackendOutcome(CoprocessorBackend& backend, const CoprocessorSettings& settings,
                               const soc::Soc& soc, std::string command)
    : backend_(backend), settings_(settings), soc_(soc), command_(std::move(command)) {}

std::optional<Error> BackendOutcome::open() {
  if (backend_.lockstep != nullptr) backend_.lockstep->on_difference([] { sc_core::sc_stop(); });
  return std::nullopt;
}

std::optional<Error> BackendOutcome::write_waves(const std::string& path) const {
  auto file = trace::WaveFile::at(path);
  if (!file) return Error{file.error()};
  if (auto error = backend_.lockstep->write_waves(file.value().growing())) return error;
  return file.value().finish();
}

/// The report of lockstep's difference, "" if there is none.
std::string BackendOutcome::divergence() const {
  if (backend_.lockstep == nullptr || !backend_.lockstep->difference()) return "";
  const std::string waves = lockstep_waves(settings_);
  const auto error = write_waves(waves);
  return backend_.lockstep->report(command_, 1e9 / static_cast<double>(soc_.clock.frequency_hz())) +
         (error ? error->text + "\n" : fmt::format("waves of both sides: {}\n", waves));
}

void BackendOutcome::close(RunResult& result) {
  result.divergence = divergence();
  if (backend_.rtl != nullptr && backend_.lockstep == nullptr) backend_.rtl->close_waves();
  if (!backend_.waves) return;
  if (const auto error = backend_.waves->finish()) result.lost.push_back(error->text);
}

}  // namespace capsoc::run
