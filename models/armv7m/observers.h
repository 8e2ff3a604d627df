#pragma once

#include <vector>

#include "armv7m/observer.h"

namespace capsoc::armv7m {

/// Forwards to several observers. Each is notified of what it asked for, in the order of add().
class Observers final : private Observer {
 public:
  void add(Observer& observer, bool instructions, bool accesses);
  void remove(Observer& observer);

  /// The observer to notify; null: there is none. A single one is notified directly.
  Observer* all();
  bool see_instructions() const;
  bool see_accesses() const;

 private:
  void issued(const Core& core, const DecodedOp& op) override;
  void retired(const Core& core, const DecodedOp& op) override;
  void entered(const Core& core, unsigned exception, Entry how, uint64_t since) override;
  void returned(const Core& core, unsigned exception) override;
  void accessed(const Core& core, const DirectAccess& access) override;
  void started(const Core& core) override;

  struct Entrant {
    Observer* observer;
    bool instructions, accesses;
  };
  std::vector<Entrant> entrants_;
};

}  // namespace capsoc::armv7m
