// Injects the faults of a run.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backend/coprocessor_backend.h"
#include "base/archive.h"
#include "base/result.h"
#include "inject/bus_faults.h"
#include "inject/clock_faults.h"
#include "inject/fault.h"
#include "inject/inject_settings.h"
#include "inject/places.h"
#include "inject/stream_faults.h"
#include "kit/probe.h"
#include "loader/elf_image.h"
#include "results/results.h"
#include "soc/soc.h"

namespace capsoc::inject {

/// Changes bits of the chip, samples and interrupts at the instants that the faults name.
///
/// A bit changes at the first instant at or after its time at which the processor is between two
/// instructions: the same one whatever the quantum, the executor and the observers are. State that
/// the coprocessor's model and RTL share changes when the pipeline is empty as well. A stuck bit is
/// set again after each instruction; of the coprocessor after each result, once its pipeline is
/// empty. Samples and interrupts are changed on their way, at their own instant.
class Injector {
 public:
  /// Without faults; they come by add().
  explicit Injector(soc::Soc& soc);
  /// With the faults of the settings; null without any. `images`: the programs, loaded. Nothing
  /// passed in is owned. An Error names the option, or file and line.
  static Result<std::unique_ptr<Injector>> make(const run::InjectSettings& settings, soc::Soc& soc,
                                                const run::CoprocessorBackend& backend,
                                                const std::vector<const loader::ElfImage*>& images);
  ~Injector();
  Injector(const Injector&) = delete;
  Injector& operator=(const Injector&) = delete;

  /// A loaded state begins at `time`, after `sample` samples. `is_snapshot`: faults before it are
  /// part of it and passed over; else they are an Error.
  std::optional<Error> begin_from(const sc_core::sc_time& time, uint64_t sample, bool is_snapshot);
  /// Call when the state was loaded, at its time.
  void restored();

  /// Adds a fault, between two advances of the simulation; call pause() after it. `sample`: the
  /// number of the newest sample. No state can be saved until the fault is over: a run resumed from
  /// it would not have the fault. An Error is the end of a sentence, and nothing is added.
  std::optional<Error> add(Fault fault, const Places& places, uint64_t sample);
  /// Outcome so far of each added fault.
  std::vector<run::FaultOutcome> added() const;

  /// Time of the next pause(); sc_max_time(): none by time.
  sc_core::sc_time next() const;
  /// Applies what is due, with the processor between two instructions. Returns the time of the next
  /// call.
  sc_core::sc_time pause(const sc_core::sc_time& now);

  /// Refuses to save while a fault is active, or an added one waits. There is no other state: a
  /// restored run has the faults of its settings.
  void visit(Archive& archive);

  /// Every fault has acted, and none acts any more.
  bool is_over() const;

  void finish(run::RunResult& result);

 private:
  class Watch;
  struct Bit {
    Injected* injected;
    PlacedBit placed;
    bool holds = false;         ///< a stuck bit that has begun
    bool holds_itself = false;  ///< the place does it
    bool is_due = false;        ///< it is to be set again
  };

  bool is_past(const When& when) const;
  std::optional<Error> place(const Places& places, Injected& injected);
  void listen();
  void apply(Bit& bit);
  void raise(Injected& injected);
  void release(Bit& bit, const sc_core::sc_time& now);
  sc_core::sc_time time_of(const Injected& injected) const;
  sc_core::sc_time next_of(const Bit& bit) const;
  std::vector<const Injected*> waiting() const;
  bool wants_instructions() const;
  void watch_instructions();
  void retired();
  void wake();

  soc::Soc& soc_;
  Position position_;
  std::vector<std::unique_ptr<Injected>> faults_;
  std::size_t of_settings_ = 0;  ///< how many of them; the rest was added
  std::vector<Bit> bits_;
  std::vector<Injected*> raised_;
  SampleFaults samples_{position_};
  InterruptFaults interrupts_{position_};
  BusFaults accesses_{position_};
  ClockFaults clock_{position_};
  std::unique_ptr<Watch> watch_;
  bool is_watching_ = false;
  std::vector<kit::Listening> listening_;
};

}  // namespace capsoc::inject
