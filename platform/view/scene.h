// The data of a run that the pages show, requested from its session.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "service/run_session.h"
#include "view/curves.h"
#include "view/hub.h"
#include "view/time_line.h"

namespace capsoc::view {

/// What the run is doing, in the page's words.
struct Status {
  std::string mode;      ///< waiting, running, paused, asleep, over, ended
  double speed = 0;      ///< simulated seconds a second of the host; 0: as fast as it can
  std::string reason;    ///< why it stands; "": nothing to say
  uint64_t command = 0;  ///< the last one that was carried out
  double host_s = 0;     ///< that it has been played for, frames included
  Json story;            ///< StoryCourse::shown()
  Json run;              ///< Choices::Chosen::shown; null: there is no choice
  Json choices;          ///< Choices::shown(), which pages get once
};

/// Collects a frame from the session's answers. Asks only what has no side effect on the run.
class Scene {
 public:
  explicit Scene(service::RunSession& session);
  /// Of another simulation of the session. What pages have is not of this one.
  void begin_anew();

  /// Publishes what is new. The simulation stands.
  void publish(Hub& hub, const Status& status);
  /// The same in two steps, so that the simulation stands only for the answers: what to ask, and
  /// what was answered, in this order. Nothing else is asked of the scene in between.
  using Questions = service::RunSession::Questions;
  using Answers = std::vector<service::Answer>;
  Questions questions(const Status& status);
  void publish(Hub& hub, const Status& status, const Answers& answers);
  /// The last frame, with the answer of simulation.finish; may be asked for without a simulation.
  void publish_end(Hub& hub, const Status& status, const Json& finished);

  /// The simulation went somewhere else, or its sensor changed.
  void moved();
  /// A peripheral by its SVD name. False: there is none.
  bool show_registers(const std::string& peripheral);
  /// How much of the past the time line shows. A sentence: it is refused.
  std::string show_window(double seconds);
  /// Of which the record has not all that the history has.
  bool lacks_past() const { return time_line_.lacks(history_.value("beginning_s", 0.0)); }
  /// A sentence for the pages, with the next frame.
  void say(const std::string& sentence) { said_.push_back(sentence); }

  /// Where the simulation is, as simulation.state answered last.
  const Json& state() const { return state_; }
  double time_s() const { return state_.value("time_s", 0.0); }
  /// The history continues after the present.
  bool is_past() const { return history_.value("end_s", 0.0) > time_s(); }
  /// Of the shaft, turns a second; 0: not known, or not one value.
  double frequency_hz() const;

 private:
  using Clock = std::chrono::steady_clock;

  void list_registers();
  Questions::value_type ask_activity() const;
  Questions::value_type ask_samples() const;
  void take(const Status& status, const Answers& answers);
  void take_samples(const service::Answer& answer);
  void take_registers(const Answers& answers, std::size_t first);
  Json update(const Status& status);
  void send(Hub& hub, const Status& status, const Json* finished);

  service::RunSession& session_;
  Curves curves_;
  TimeLine time_line_;
  std::size_t stream_count_ = 0;  ///< answers of streams, which come first
  uint64_t next_sample_ = 0;
  Json state_ = Json::object(), sensor_, history_, coprocessor_, status_register_, flags_register_;
  Json place_, registers_ = Json::array();
  std::map<std::string, std::vector<std::string>> peripherals_;
  std::string peripheral_ = "COPROCESSOR";
  std::map<std::string, std::string> new_text_, all_text_;
  std::vector<std::string> said_;
  bool is_moved_ = true, asks_registers_ = false, begins_ = false;
  Clock::time_point registers_read_;
};

}  // namespace capsoc::view
