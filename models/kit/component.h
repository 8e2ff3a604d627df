#pragma once

#include <vector>

#include "base/archive.h"
#include "kit/interrupt_line.h"

namespace capsoc::kit {

/// A part of a system that has a name, a reset and a state.
class Component {
 public:
  virtual ~Component() = default;

  /// Name of the part in its system, and of its section of saved state.
  virtual const char* component_name() const = 0;

  /// System reset. State that a reset does not reach stays: RAM, and data that waits outside the
  /// chip.
  virtual void reset() = 0;

  /// Saves or loads all state on which this part's behaviour depends, without wiring and
  /// construction parameters. Called only between two instants of simulated time.
  virtual void visit(Archive& archive) = 0;

  /// Called after all parts have loaded their state, at the simulated time at which it was saved.
  /// Schedules events again. Must not notify other components.
  virtual void restored() {}

  /// The interrupt outputs by their names, in the order in which the part declares them.
  struct Output {
    const char* name;
    InterruptLine* line;
  };
  const std::vector<Output>& outputs() const { return outputs_; }

  /// visit() and the levels of all outputs: the complete saved state of this part.
  void visit_all(Archive& archive) {
    visit(archive);
    for (const Output& output : outputs_) archive(output.name, *output.line);
  }

 protected:
  Component() = default;
  Component(const Component&) = default;
  Component& operator=(const Component&) = default;

 private:
  friend class InterruptLine;
  std::vector<Output> outputs_;
};

inline InterruptLine::InterruptLine(Component& owner, const char* name) {
  owner.outputs_.push_back({name, this});
}

}  // namespace capsoc::kit
