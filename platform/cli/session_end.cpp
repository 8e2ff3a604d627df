#include "cli/session_end.h"

#include <fmt/format.h>

#include <string>

#include "host/console.h"
#include "host/end_signals.h"
#include "results/exit_codes.h"

namespace capsoc::cli {

int code_of_refusal() {
  if (const int signal = host::noted_signal(); signal != 0)
    return run::exit_code::signal_base + signal;
  return host::is_ending() ? run::exit_code::limit : run::exit_code::usage;
}

int tell_end(service::Json& answer) {
  if (const int signal = host::noted_signal(); signal != 0) {
    answer["code"] = run::exit_code::signal_base + signal;
    answer["result"]["exit"] = {{"code", answer["code"]},
                                {"reason", fmt::format("ended by signal {}", signal)}};
  }
  for (const service::Json& report : answer.value("reports", service::Json::array()))
    host::say("\n{}", report.get<std::string>());
  for (const service::Json& sentence : answer.value("lost", service::Json::array()))
    host::say("capsoc: {}\n", sentence.get<std::string>());
  host::say("{}", answer.value("table", ""));
  return answer.at("code").get<int>();
}

}  // namespace capsoc::cli
