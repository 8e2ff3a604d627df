// State that nothing reads in the run without a fault: a flipped bit there changes nothing else.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/archive.h"
#include "kit/probe.h"
#include "session/simulation.h"

namespace capsoc::fault {

/// Places of faults, with the reason.
struct Unread {
  std::vector<std::string> places;  ///< names, or beginnings of names that end with a dot
  std::string reason;

  void visit(Archive& archive);
  bool has(const std::string& place) const;
};

/// Observes the settings that decide what is read, from its beginning to the end of the run.
class UnreadWatch {
 public:
  explicit UnreadWatch(run::Simulation& simulation);

  /// What was never read, at the end of the run.
  std::vector<Unread> unread() const;

 private:
  void written(uint32_t word);  ///< to CTRL

  uint32_t ctrl_address_ = 0;
  bool corrects_ = false;  ///< CTRL.CORRECT was set at some time
  double from_s_ = 0;
  kit::Listening listening_;
};

/// Why nothing reads a place; "": something may.
std::string reason_not_read(const std::string& place, const std::vector<Unread>& unread);

}  // namespace capsoc::fault
