// One simulation in its worker process, with all that a session asks of it.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "debug/soc_target.h"
#include "kit/probe.h"
#include "metrics/sample_record.h"
#include "service/events.h"
#include "service/register_index.h"
#include "service/sensor_port.h"
#include "service/uart_tap.h"
#include "service/verb.h"
#include "session/run_settings.h"
#include "session/simulation.h"
#include "source/variables.h"

namespace capsoc::service {

/// The index in debug::registers of a register of the processor; an Error names the nearest ones.
Result<unsigned> processor_register(const std::string& name);

class Board {
 public:
  static constexpr std::size_t most_samples = 1'000'000;  ///< kept, the newest

  /// The whole state of a board, to go on from with the same settings.
  struct Snapshot {
    Json held;  ///< what came from outside and has not reached the chip, what it sent and nobody
                ///< has read
    Frames frames;  ///< a checkpoint's bytes, then those that `held` refers to; empty: out of reset
  };

  /// `settings`: names and values as `capsoc run -C` takes them. An Error as
  /// run::Simulation::construct() has it. The only one of its process.
  static Result<std::unique_ptr<Board>> construct(const Json& settings, const Snapshot& from);
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
  const RegisterIndex& registers() const { return *registers_; }
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
  /// The clock of the processor changes; empty: nobody asks.
  std::function<void()> on_clock_change;
  run::RunSettings& settings() { return settings_; }

  /// Time, counts and place, as every answer about a state has them.
  Json state();
  /// The run is closed, and this is its result. Afterwards nothing but state() may be asked.
  Json finish();
  bool is_finished() const { return result_.has_value(); }

  /// An Error as run::Simulation::packed_state() has it.
  Result<Snapshot> snapshot();
  /// Why a checkpoint alone would not be the whole state; "" if it is.
  std::string beside_the_checkpoint() const;

  const std::deque<metrics::RecordedSample>& samples() const { return samples_; }
  /// Of the first that is kept.
  uint64_t first_sample() const { return first_sample_; }
  uint64_t sample_count() const { return first_sample_ + samples_.size(); }

  /// An address: a number, or the name of a symbol.
  Result<uint32_t> address(const Json& place) const;

 private:
  Board() = default;
  std::optional<Error> set(const Json& settings);
  std::optional<Error> take_over(const Snapshot& from);
  void attach();
  Result<double> number_of_variable(const std::string& name);

  run::RunSettings settings_;
  serial::KeptStreams kept_;
  SensorPort* sensor_ = nullptr;  // the simulation's
  std::unique_ptr<run::Simulation> simulation_;
  std::unique_ptr<debug::SocTarget> target_;
  std::unique_ptr<source::Variables> variables_;
  std::unique_ptr<RegisterIndex> registers_;
  std::array<UartTap, soc::Soc::uart_count> uarts_;
  Events events_;
  std::deque<metrics::RecordedSample> samples_;
  uint64_t first_sample_ = 0;
  kit::Listening listening_;
  std::optional<Json> result_;
};

}  // namespace capsoc::service
