#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "base/archive.h"

namespace capsoc::kit {

class Component;

/// A level that a device drives and others follow. Low at the start.
class InterruptLine {
 public:
  InterruptLine() = default;
  /// An output of a part by its name, which the part knows from then on (component.h).
  InterruptLine(Component& owner, const char* name);
  InterruptLine(const InterruptLine&) = delete;
  InterruptLine& operator=(const InterruptLine&) = delete;

  bool level() const { return level_; }

  /// Sinks run on a change only, so a device may set its line as often as it likes.
  void set(bool level) {
    if (level == level_) return;
    level_ = level;
    for (const auto& sink : sinks_) sink(level);
  }

  /// A sink that comes late to a line already high hears it at once.
  void connect(std::function<void(bool)> sink) {
    if (level_) sink(true);
    sinks_.push_back(std::move(sink));
  }
  /// The level alone: what the sinks made of it is their own state.
  void visit(Archive& archive) { archive("level", level_); }

 private:
  bool level_ = false;
  std::vector<std::function<void(bool)>> sinks_;
};

}  // namespace capsoc::kit
