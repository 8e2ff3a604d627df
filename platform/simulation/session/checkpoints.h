// A run that is saved on its way, and one that continues from there.
#pragma once

#include <csignal>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/setting_fields.h"
#include "checkpoint/checkpoint_file.h"
#include "inputs/run_inputs.h"
#include "observers/run_observer.h"
#include "ports/host_ports.h"
#include "session/checkpoint_settings.h"
#include "soc/soc.h"

namespace capsoc::run {

class RunSettings;

/// FILE@SECONDS of checkpoint.save, in the order of time. An Error is what cannot be read.
struct SavePoint {
  std::string file;
  double seconds = 0;
};
Result<std::vector<SavePoint>> save_points(const RunSettings& settings);

/// What a run must have in common with the run that it continues: the program, the sensor and most
/// settings. Settings that only say where output goes, how fast the run is or when it ends are left
/// out. Reads all inputs. An Error: an input is no file.
Result<checkpoint::Identity> identity_of(const RunSettings& settings, const RunInputs& inputs);

/// The checkpoint that the settings name, or nothing. An Error: damaged, of another program or
/// another configuration.
Result<std::optional<checkpoint::Checkpoint>> checkpoint_to_restore(const RunSettings& settings,
                                                                    const RunInputs& inputs);

/// The parts of a board.
std::vector<checkpoint::Part> parts_of(soc::Soc& soc);

/// Parts that only states in memory have: what the observers have gathered.
bool is_gathered(const std::string& part);
std::vector<checkpoint::Part> gathered_parts(const Observers& observers);
checkpoint::Part gathered_part(const std::string& name,
                               std::function<void(Archive& archive)> visit);

/// Saves a run while it runs, between two instructions, when the coprocessor's pipeline is empty:
/// such a state any backend of it can continue from, whichever saved it. A pipeline that is still
/// busy a millisecond later is saved as it is, for the same backend only.
class Checkpoints {
 public:
  Checkpoints(const RunSettings& settings, const RunInputs& inputs, soc::Soc& soc,
              std::vector<checkpoint::Part> parts, std::vector<checkpoint::Part> gathered);
  Checkpoints(const Checkpoints&) = delete;
  Checkpoints& operator=(const Checkpoints&) = delete;

  /// What the settings ask for; SIGUSR1 saves from here on. An Error is a wrong setting.
  std::optional<Error> plan();
  /// When pause() is wanted; sc_max_time(): never.
  sc_core::sc_time next() const;
  /// Saves what is due, with the processor between two instructions. Returns when it is wanted
  /// again.
  sc_core::sc_time pause(const sc_core::sc_time& now);
  /// Handles a SIGUSR1 that was sent. Call it regularly.
  void look_for_signal();
  /// Saves at this instant to a file that no setting names, for a debugger that halts the
  /// processor. `by` begins the sentence of an error. An Error: a file of the run, or one that
  /// cannot be written.
  std::optional<Error> save_beside(const std::string& file, const char* by);

  /// The bytes of such a file. `with_gathered`: and what the observers have gathered. An Error: a
  /// part cannot be saved, or an input is gone.
  Result<std::string> packed(bool with_gathered);

  /// Gives every part its state, then lets them continue. Twice: as a test before the simulation
  /// starts, and when its time has come.
  std::optional<Error> load(const checkpoint::Checkpoint& from);
  void restored();

  /// A sentence for everything that could not be saved.
  std::vector<std::string> failures() const;

 private:
  std::optional<Error> save_now(const std::string& file);
  /// Why not, failures() says then. `by`: as for save_beside(); null: the file was checked.
  bool save(const std::string& file, const sc_core::sc_time& wanted, const char* by);
  /// The first regular checkpoint after `now`.
  void plan_regular(const sc_core::sc_time& now);
  /// Read once, before the run if it will save: the files may be others later.
  const Result<checkpoint::Identity>& identity();
  std::string automatic_name(const sc_core::sc_time& now) const;

  const RunSettings& settings_;
  const RunInputs& inputs_;
  soc::Soc& soc_;
  std::vector<checkpoint::Part> parts_, gathered_;
  std::optional<Result<checkpoint::Identity>> identity_;
  std::vector<SavePoint> points_;
  std::size_t next_point_ = 0;
  sc_core::sc_time every_, next_regular_ = sc_core::sc_max_time();
  bool signalled_ = false;
  sc_core::sc_time waits_since_ = sc_core::sc_max_time();
  std::vector<std::string> failures_;
};

}  // namespace capsoc::run
