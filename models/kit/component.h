#pragma once

#include <vector>

#include "base/archive.h"
#include "kit/interrupt_line.h"

namespace capsoc::kit {

/// A part of a system that has a name, a reset and a state.
class Component {
 public:
  virtual ~Component() = default;

  /// Of the part in its system; names a section of saved state.
  virtual const char* component_name() const = 0;

  /// System reset. What a reset does not reach (RAM, what waits outside the chip) stays.
  virtual void reset() = 0;

  /// Everything that the future of this part depends on and that is not wired or chosen when the
  /// system is built. Called between two instants of simulated time only.
  virtual void visit(Archive& archive) = 0;

  /// After every part has its state again, at the simulated time at which it was saved: events are
  /// planned again. Must not notify other components.
  virtual void restored() {}

  /// The interrupt outputs by their names, in the order in which the part declares them.
  struct Output {
    const char* name;
    InterruptLine* line;
  };
  const std::vector<Output>& outputs() const { return outputs_; }

  /// visit() and the levels of all outputs: all that is to be saved of this part.
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
