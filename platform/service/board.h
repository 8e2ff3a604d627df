// One simulation in its worker process, with all that a session asks of it.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "debug/soc_target.h"
#include "host/file_uses.h"
#include "kit/probe.h"
#include "metrics/sample_record.h"
#include "service/activity.h"
#include "service/events.h"
#include "service/history.h"
#include "service/sensor_port.h"
#include "service/uart_tap.h"
#include "service/verb.h"
#include "session/run_settings.h"
#include "session/simulation.h"
#include "soc/register_index.h"
#include "source/variables.h"

namespace capsoc::service {

class Ticker;

/// The value of a setting as the command line would carry it; nothing: a value that it cannot be.
std::optional<std::string> setting_text(const Json& value);

/// The index in debug::registers of a register of the processor; an Error names the nearest ones.
Result<unsigned> processor_register(debug::Target& target, const std::string& name);

class Board {
 public:
  static constexpr std::size_t most_samples = 1'000'000;  ///< kept, the newest
  /// Of a history, unless the settings say otherwise.
  static constexpr uint64_t history_mb = 64, most_history_mb = 65536;

  /// The whole state of a board, to continue from with the same settings.
  struct Snapshot {
    /// As one text, for a history; "": out of reset. The text has to be of to_bytes().
    std::string to_bytes() const;
    static Snapshot of(const std::string& bytes);

    /// A checkpoint's bytes; "": out of reset.
    std::string state() const { return frames.empty() ? "" : frames.front(); }

    Json held;  ///< what came from outside and has not reached the chip, what it sent and no client
                ///< has read
    Frames frames;  ///< a checkpoint's bytes, then those that `held` refers to; empty: out of reset
  };

  /// `settings`: names and values as `capsoc run -C` takes them; `writes_in` as in Door. An Error
  /// as check_files() and run::Simulation::construct() have it. The only one of its process.
  static Result<std::unique_ptr<Board>> construct(const Json& settings, const Snapshot& from,
                                                  const std::string& writes_in = "");
  /// The same in steps: one that may do nothing but set_state() before begin(), which is perhaps
  /// called in a fork of this process, with the same snapshot.
  static Result<std::unique_ptr<Board>> prepare(const Json& settings, const std::string& writes_in);
  std::optional<Error> set_state(const Snapshot& from);
  std::optional<Error> begin(const Snapshot& from);
  /// Whether forks of this process may each begin a prepared one: nothing that its settings open
  /// is shared by them then.
  bool may_be_forked() const;
  ~Board();
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  run::Simulation& simulation() { return *simulation_; }
  soc::Soc& soc() { return simulation_->soc(); }
  debug::SocTarget& target() { return *target_; }
  SensorPort& sensor() { return *sensor_; }
  UartTap& uart(std::size_t number) { return uarts_[number]; }
  serial::KeptStream& itm() { return kept_.itm; }
  serial::KeptStream& console() { return kept_.console; }
  Events& events() { return events_; }
  Activity& activity() { return activity_; }
  const soc::RegisterIndex& registers() const { return *registers_; }
  source::Variables& variables() { return *variables_; }
  /// An Error as Events::subscribe() has it.
  std::optional<Error> subscribe(const std::vector<std::string>& kinds) {
    return events_.subscribe(kinds, uarts_);
  }
  /// Without side effects; nothing where nothing is.
  std::optional<uint32_t> read_word(uint32_t address);
  /// Follows pointers of the program.
  source::ReadPointer pointers() {
    return [this](uint32_t address) { return read_word(address); };
  }
  /// What a name in an expression stands for: $pc and the other registers of the processor, a
  /// register or a field of a device (COPROCESSOR.STATUS.LOCK), a variable that is a number.
  Result<double> number_of(const std::string& name);
  Position position() const;
  History& history() { return history_; }
  /// Why there is no history; "": there is one.
  const std::string& no_history() const { return no_history_; }
  /// Begins a history with the state that the board was constructed in, unless its settings allow
  /// none.
  void begin_history(const Snapshot& from);
  /// Continues a history from one of its snapshots, in whose state the board was constructed.
  void continue_history(History history, std::size_t snapshot);
  /// Adds a snapshot to the history if one is due. Between two instructions.
  void remember();
  /// Adds one now. An Error as snapshot() has it.
  std::optional<Error> keep();
  /// Asks for one now and then from here on, until an advance has ended.
  void tick(bool on);
  /// It has stopped at a BKPT, which takes cycles each time that it is tried.
  void stood_at_bkpt() { bkpt_ = {soc().cpu.core().cycles(), soc().cpu.core().reg(15)}; }
  void left_bkpt() { bkpt_ = {~uint64_t{0}, 0}; }
  /// And nothing has happened since.
  bool stands_at_bkpt() {
    return bkpt_ == std::pair(soc().cpu.core().cycles(), soc().cpu.core().reg(15));
  }
  /// Whether a client wants the advance under way to end.
  bool is_interrupted() const { return is_interrupted_ && is_interrupted_(); }
  void ask_for_interruption(std::function<bool()> asked) { is_interrupted_ = std::move(asked); }
  /// What a client knows of the outputs, for a board that takes the place of this one.
  Json told(Frames& frames);
  std::optional<Error> set_told(const Json& told, const Frames& frames);
  /// Reports nothing until set_told().
  void mute();
  /// An input has made another future: what comes now was never told.
  void forget_told();

  /// The clock of the processor changes; empty: there is no listener.
  std::function<void()> on_clock_change;
  run::RunSettings& settings() { return settings_; }

  /// Time, counts and place, as every answer about a state has them.
  Json state();
  /// What the program states of its results: pass, with bound_deg or reason; null: nothing yet.
  Json verdict();
  /// The run is closed, and this is its result. Afterwards nothing but state() may be asked.
  Json finish();
  bool is_finished() const { return result_.has_value(); }

  /// An Error as run::Simulation::packed_state() has it. `unread`: with the text of UARTs that no
  /// client has read.
  Result<Snapshot> snapshot(bool unread = true);
  /// Why a checkpoint alone would not be the whole state; "" if it is.
  std::string beside_the_checkpoint() const;

  const std::deque<metrics::RecordedSample>& samples() const { return samples_; }
  /// Of the first that is kept.
  uint64_t first_sample() const { return first_sample_; }
  uint64_t sample_count() const { return first_sample_ + samples_.size(); }

  /// The files of the settings and `more`, before one of these is opened. An Error: an output is
  /// an input or another output, or clients may not write there or load that library.
  std::optional<Error> check_files(const std::vector<host::FileUse>& more) const;

  /// An address: a number, or the name of a symbol.
  Result<uint32_t> address(const Json& place) const;

 private:
  Board();
  std::optional<Error> set(const Json& settings);
  std::optional<Error> make(const Snapshot& from, bool waits);
  std::optional<Error> start(const Snapshot& from);
  std::optional<Error> take_over(const Snapshot& from);
  /// What the program says, by where: the UARTs, the ITM, the console.
  std::vector<std::pair<std::string, serial::KeptStream*>> outputs();
  std::string why_no_history() const;
  uint64_t effort_ns() const;
  void attach();
  Result<double> number_of_variable(const std::string& name);

  run::RunSettings settings_;
  std::string writes_in_;  // as in Door
  serial::KeptStreams kept_;
  SensorPort* sensor_ = nullptr;  // the simulation's
  std::unique_ptr<run::Simulation> simulation_;
  std::unique_ptr<debug::SocTarget> target_;
  std::unique_ptr<source::Variables> variables_;
  std::unique_ptr<soc::RegisterIndex> registers_;
  std::array<UartTap, soc::Soc::uart_count> uarts_;
  Events events_;
  Activity activity_;
  std::deque<metrics::RecordedSample> samples_;
  uint64_t first_sample_ = 0;
  std::pair<uint64_t, uint32_t> bkpt_ = {~uint64_t{0}, 0};  // cycles and pc
  kit::Listening listening_;
  std::optional<Json> result_;
  std::size_t history_budget_;  // bytes
  History history_;
  std::string no_history_;
  std::unique_ptr<Ticker> ticker_;
  uint64_t effort_begin_ns_ = 0;  // of the history, minus this process's own
  std::function<bool()> is_interrupted_;
};

}  // namespace capsoc::service
