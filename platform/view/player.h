// A run under the hands of its pages: played, paused, stepped and taken back.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "service/run_session.h"
#include "view/choices.h"
#include "view/hub.h"
#include "view/scene.h"
#include "view/story.h"

namespace capsoc::view {

class Player {
 public:
  /// `speed`: as Status::speed. The run begins when a page is open. `choices`: for further runs;
  /// null: there is none. `story`: null for none.
  Player(service::RunSession session, Hub& hub, double speed, const Choices* choices,
         const Story* story);
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;

  /// Until a page or a signal ends it. The answer of simulation.finish.
  Json perform();

 private:
  using Clock = std::chrono::steady_clock;

  void obey(const Command& command);
  std::string obey_transport(const std::string& what, const Json& body);
  std::string obey_goto(const Json& body);
  std::string begin_new(const Json& body);
  std::string set_speed(const Json& body);
  std::string set_window(const Json& body);
  void play();
  void play_paced();
  void play_at_once();
  void begin_advance();
  void pass();
  void settle();
  void stand();
  /// Advances, for at most one slice, or less if a command comes. False: it stands for good.
  bool advance(const std::string& method, Json parameters, std::chrono::milliseconds longest);
  bool conclude(const service::Answer& answer);
  void stop(const char* mode, const std::string& reason);
  std::string step(Json parameters, const std::string& what);
  bool is_interrupted() const;
  bool is_wanted() const;
  std::chrono::milliseconds slice() const;
  void begin_pace();
  void publish();
  void tell_story();

  service::RunSession session_;
  Hub& hub_;
  Scene scene_;
  Status status_;
  const Choices* choices_;
  StoryCourse story_;
  std::chrono::milliseconds looked_for_{0};  ///< what the last frame cost
  std::optional<uint64_t> under_way_;        ///< an advance that was asked for, at full speed
  Clock::time_point advanced_, pace_begin_;
  double pace_begin_s_ = 0;
  bool is_ended_ = false, is_gone_ = false, has_news_ = true, is_cut_ = false;
};

}  // namespace capsoc::view
