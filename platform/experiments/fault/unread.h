// State that nothing reads in the run without a fault: a flipped bit there changes nothing else.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "armv7m/observer.h"
#include "base/archive.h"
#include "inject/places.h"
#include "kit/probe.h"
#include "session/simulation.h"

namespace capsoc::fault {

/// Places of faults, with the reason.
struct Unread {
  std::vector<std::string> places;  ///< names, or beginnings of names that end with a dot
  std::string reason;
  /// Of a memory: a byte for each of the place's words, not 0 where it does not hold. Empty: the
  /// whole place.
  std::string used;

  void visit(Archive& archive);
  bool has(const std::string& place, unsigned bit) const;
};

/// Notes which words of the memories the processor reads, executes or writes.
class MemoryUse final : public armv7m::Observer {
 public:
  /// `places`: those whose names are addresses of memory. Begins and ends with this object.
  MemoryUse(soc::Soc& soc, const std::vector<inject::ListedPlace>& places);
  ~MemoryUse() override;
  MemoryUse(const MemoryUse&) = delete;
  MemoryUse& operator=(const MemoryUse&) = delete;

  /// The words without any use up to now.
  std::vector<Unread> unused(const std::string& span) const;

  void issued(const armv7m::Core& core, const armv7m::DecodedOp& op) override;
  void retired(const armv7m::Core&, const armv7m::DecodedOp&) override {}
  void entered(const armv7m::Core&, unsigned, armv7m::Entry, uint64_t) override {}
  void returned(const armv7m::Core&, unsigned) override {}
  void accessed(const armv7m::Core& core, const armv7m::DirectAccess& access) override;
  void started(const armv7m::Core&) override {}

 private:
  struct Words {
    std::string place;
    uint32_t address;
    std::string used;  ///< as in Unread
  };
  void use(uint32_t address, unsigned size);

  soc::Soc& soc_;
  std::vector<Words> memories_;
};

/// Observes the settings that decide what is read, from its beginning to the end of the run.
class UnreadWatch {
 public:
  UnreadWatch(run::Simulation& simulation, const std::vector<inject::ListedPlace>& places);

  /// What was never read, at the end of the run.
  std::vector<Unread> unread() const;

 private:
  void written(uint32_t word);  ///< to CTRL

  uint32_t ctrl_address_ = 0;
  bool corrects_ = false;  ///< CTRL.CORRECT was set at some time
  double from_s_ = 0;
  kit::Listening listening_;
  MemoryUse memory_;
};

/// Why nothing reads a bit of a place; "": something may.
std::string reason_not_read(const std::string& place, unsigned bit,
                            const std::vector<Unread>& unread);

}  // namespace capsoc::fault
