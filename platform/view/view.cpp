#include "view/view.h"

#include <fmt/format.h>

#include <utility>

#include "host/console.h"
#include "host/end_signals.h"
#include "service/run_session.h"
#include "view/http_server.h"
#include "view/hub.h"
#include "view/player.h"

namespace capsoc::view {

namespace {

Result<service::Json> show(const run::RunSettings& settings, const std::string& recorded,
                           const Choices* choices, const Story* story) {
  const std::string option = settings.view.port.about().name();
  if (settings.gdb.port() >= 0)
    return Error{option + ": a debugger cannot steer the same run; leave out --gdb"};
  if (const TextField& console = settings.semihosting.console; console() == "stdio")
    return Error{
        fmt::format("{}: stdio reads standard input, which {} has no place for; take "
                    "stderr or stdout",
                    console.about().name(), option)};
  host::note_end_signals();
  auto session = service::RunSession::start(settings, option, recorded);
  if (!session) return Error{session.error()};
  if (session.value().is_gone()) return session.value().finish();
  Hub hub;
  auto server = HttpServer::start(static_cast<uint16_t>(settings.view.port()), hub);
  if (!server) return Error{server.error()};
  host::say("view: {}\n", server.value()->url());
  return Player(std::move(session.value()), hub, settings.limits.realtime(), choices, story)
      .perform();
}

}  // namespace

Result<service::Json> run_in_view(const run::RunSettings& settings, const Choices* choices,
                                  const Story* story) {
  return show(settings, "", choices, story);
}

Result<service::Json> replay_in_view(const run::RunSettings& settings,
                                     const std::string& recorded) {
  return show(settings, recorded, nullptr, nullptr);
}

}  // namespace capsoc::view
