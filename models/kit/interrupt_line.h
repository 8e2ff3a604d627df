#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "base/archive.h"

namespace capsoc::kit {

class Component;

/// A level that a device drives and its sinks receive. Initially low.
class InterruptLine {
 public:
  InterruptLine() = default;
  /// Registers the line as a named output of its part (component.h).
  InterruptLine(Component& owner, const char* name);
  InterruptLine(const InterruptLine&) = delete;
  InterruptLine& operator=(const InterruptLine&) = delete;

  bool level() const { return level_; }

  /// Sinks are called only on a change, so a device may set its line at any time.
  void set(bool level) {
    if (level == level_) return;
    level_ = level;
    for (const auto& sink : sinks_) sink(level);
  }

  /// Connects a sink. If the line is high, the sink is called at once.
  void connect(std::function<void(bool)> sink) {
    if (level_) sink(true);
    sinks_.push_back(std::move(sink));
  }
  /// Only the level: sinks save their state themselves.
  void visit(Archive& archive) { archive("level", level_); }

 private:
  bool level_ = false;
  std::vector<std::function<void(bool)>> sinks_;
};

}  // namespace capsoc::kit
