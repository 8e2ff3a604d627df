#include "observers/protocol_violations.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace capsoc::run {
namespace {

constexpr uint64_t logged_violations = 20;

}  // namespace

std::optional<Error> ProtocolViolations::open() {
  listening_ = protocol_.violated.listen([this](const kit::ProtocolViolation& violation) {
    if (protocol_.violations() <= logged_violations) spdlog::error("{}", violation.text);
  });
  return std::nullopt;
}

void ProtocolViolations::finish(RunResult& result) {
  spdlog::info("soc.monitor: {} calls, {} violations", protocol_.calls(), protocol_.violations());
  if (protocol_.violations() == 0) return;
  result.code = exit_code::internal;
  result.reason = fmt::format("{} violations of the TLM-2.0 base protocol; please report them",
                              protocol_.violations());
}

}  // namespace capsoc::run
