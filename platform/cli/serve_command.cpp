// capsoc serve: simulations under control from outside (docs/reference/protocol.md).
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "cli/commands.h"
#include "cli/refuse.h"
#include "host/console.h"
#include "host/end_signals.h"
#include "results/results.h"
#include "service/doors.h"
#include "service/session.h"

namespace capsoc::cli {
namespace {

struct ServeArguments {
  std::string socket;
  std::string writes_in;
  std::optional<uint16_t> port;
  bool schema = false;
};

int serve(const ServeArguments& arguments) {
  if (arguments.schema) {
    host::print("{}\n", service::Session::schema().dump(2));
    return run::exit_code::pass;
  }
  const bool has_door = !arguments.socket.empty() || arguments.port;
  if (!has_door && !arguments.writes_in.empty())
    return refuse(
        "--write is for clients of --socket or --port; a client on standard input may write where "
        "its process may");
  host::note_end_signals();
  service::Door door;
  std::optional<host::RemovedAtSignal> removed;
  if (has_door) {
    auto opened = arguments.port ? service::open_port(*arguments.port)
                                 : service::open_socket(arguments.socket);
    if (!opened) return refuse(opened.error());
    door = std::move(opened.value());
    door.writes_in =
        std::filesystem::canonical(arguments.writes_in.empty() ? "." : arguments.writes_in)
            .string();
  }
  service::Session(std::move(door)).serve();
  if (!arguments.socket.empty()) unlink(arguments.socket.c_str());
  const int signal = host::noted_signal();
  return signal == 0 ? run::exit_code::pass : run::exit_code::signal_base + signal;
}

}  // namespace

void add_serve(CLI::App& app, int& code) {
  auto arguments = std::make_shared<ServeArguments>();
  CLI::App* serve_command = app.add_subcommand(
      "serve", "Simulations under control from outside: JSON-RPC on standard input and output");
  CLI::Option* const socket =
      serve_command->add_option("--socket", arguments->socket, "Listen on a Unix socket instead")
          ->type_name("PATH");
  serve_command
      ->add_option_function<std::string>(
          "--port",
          [arguments](const std::string& text) {
            arguments->port = static_cast<uint16_t>(text.empty() ? 0 : std::stoul(text));
          },
          "Listen on a port of 127.0.0.1 instead (0: a free one), with a token")
      ->type_name("[PORT]")
      ->expected(0, 1)
      ->check(CLI::Range(0, 65535))
      ->excludes(socket);
  serve_command
      ->add_option("--write", arguments->writes_in,
                   "Folder below which clients of --socket and --port may have files written "
                   "(the present one)")
      ->type_name("FOLDER")
      ->check(CLI::ExistingDirectory);
  serve_command->add_flag("--schema", arguments->schema, "Print all methods as JSON and end");
  serve_command->callback([arguments, &code] { code = serve(*arguments); });
}

}  // namespace capsoc::cli
