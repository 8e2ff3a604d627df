// A run of the command line as one simulation of a session, seen from the program that was started.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "service/message.h"
#include "service/session_client.h"
#include "session/run_settings.h"

namespace capsoc::service {

/// Owns the session and its one simulation. What the program says on standard streams is written
/// there once, however often the past is simulated again.
class RunSession {
 public:
  /// Text that a stream of the program sent: "uart0" to "uart4", "itm", "semihosting".
  using Heard = std::function<void(const std::string& stream, const std::string& bytes)>;

  /// Constructs the simulation. `asked_by`: the option that needs the history, for sentences.
  /// `recorded`: a session file to repeat, whose settings these come over; "": none. An Error: a
  /// wrong input, or settings that allow no history; nothing was simulated. Before this process
  /// has a thread.
  static Result<RunSession> start(const run::RunSettings& settings, const std::string& asked_by,
                                  const std::string& recorded = "");

  /// Of a run's settings what the session is given.
  static Json settings_of(const run::RunSettings& settings);
  /// Constructs another simulation, with what settings_of() answers, in the place of this one,
  /// which ends. An Error as start() has it: then this one stays.
  std::optional<Error> renew(const Json& settings);

  SessionClient& client() { return session_.client(); }
  uint64_t simulation() const { return simulation_; }
  /// The simulation's process ended before the simulation was constructed, for any reason.
  bool is_gone() const { return !gone_.is_null(); }

  /// Asks about the simulation, and waits for the answer.
  Answer ask(const std::string& method, Json parameters = Json::object());
  /// Sends all questions before it waits for the first answer.
  using Questions = SessionClient::Requests;
  using Numbers = std::vector<uint64_t>;
  std::vector<Answer> ask_all(Questions questions);
  /// The same in two steps.
  Numbers send_all(Questions questions);
  std::vector<Answer> take_all(const Numbers& numbers);
  /// Reads all UARTs from here on, also those that standard streams do not show.
  void hear(Heard heard);
  /// Writes what the program said to the standard streams.
  void show();
  /// The same in two steps: its questions, and what to do with the answers, the first of these.
  Questions stream_questions() const;
  void show(const std::vector<Answer>& answers);
  /// Sends what was typed, if a UART reads standard input.
  void read_keys();
  bool reads_keys() const { return keyboard_ >= 0; }
  /// The program reads its console, which is standard input: sends what was typed, or that nothing
  /// will be. Nothing was typed in that time: does nothing.
  void answer_console(std::chrono::milliseconds patience);
  /// Something was typed that is to be sent.
  bool has_keys() const;
  /// A sentence about an output that is not whole; the run is no pass.
  void lose(std::string sentence) { lost_.push_back(std::move(sentence)); }
  /// Writes the recording that the settings ask for, and ends the run. `before`: is done between
  /// both. The answer of simulation.finish.
  Json finish(const std::function<void()>& before = nullptr);

 private:
  /// A stream of the program: how it is read, and where it is shown.
  struct Stream {
    enum class Place { nowhere, output, error };
    std::string name, method;
    Json parameters;
    Place place;
  };

  RunSession(ChildSession session, const run::RunSettings& settings);
  std::optional<Error> construct(const std::string& asked_by, const std::string& recorded);
  std::string why_no_history();
  void divide(const run::RunSettings& settings);
  static Stream::Place place_of(const std::string& backend);
  bool is_read(const Stream& stream) const;
  void record();

  ChildSession session_;
  uint64_t simulation_ = 0;
  Json settings_ = Json::object(), gone_;
  std::vector<Stream> streams_;
  std::string session_file_;  ///< "": none
  double keep_last_s_ = 0;    ///< of that; 0: all
  std::string typed_;         ///< for the console, and not sent yet
  int keyboard_ = -1;         ///< the UART that reads standard input; -1: none
  Heard heard_;
  std::vector<std::string> lost_;  ///< a sentence for each output that is not whole
  uint64_t bytes_lost_ = 0;
};

}  // namespace capsoc::service
