#include "armv7m/observers.h"

#include <algorithm>

namespace capsoc::armv7m {

void Observers::add(Observer& observer, bool instructions, bool accesses) {
  remove(observer);
  entrants_.push_back({&observer, instructions, accesses});
}

void Observers::remove(Observer& observer) {
  entrants_.erase(
      std::remove_if(entrants_.begin(), entrants_.end(),
                     [&](const Entrant& entrant) { return entrant.observer == &observer; }),
      entrants_.end());
}

Observer* Observers::all() {
  if (entrants_.empty()) return nullptr;
  return entrants_.size() == 1 ? entrants_.front().observer : this;
}

bool Observers::see_instructions() const {
  return std::any_of(entrants_.begin(), entrants_.end(),
                     [](const Entrant& entrant) { return entrant.instructions; });
}

bool Observers::see_accesses() const {
  return std::any_of(entrants_.begin(), entrants_.end(),
                     [](const Entrant& entrant) { return entrant.accesses; });
}

void Observers::issued(const Core& core, const DecodedOp& op) {
  for (const Entrant& entrant : entrants_)
    if (entrant.instructions) entrant.observer->issued(core, op);
}

void Observers::retired(const Core& core, const DecodedOp& op) {
  for (const Entrant& entrant : entrants_)
    if (entrant.instructions) entrant.observer->retired(core, op);
}

void Observers::entered(const Core& core, unsigned exception, Entry how, uint64_t since) {
  for (const Entrant& entrant : entrants_) entrant.observer->entered(core, exception, how, since);
}

void Observers::returned(const Core& core, unsigned exception) {
  for (const Entrant& entrant : entrants_) entrant.observer->returned(core, exception);
}

void Observers::accessed(const Core& core, const DirectAccess& access) {
  for (const Entrant& entrant : entrants_)
    if (entrant.accesses) entrant.observer->accessed(core, access);
}

void Observers::started(const Core& core) {
  for (const Entrant& entrant : entrants_) entrant.observer->started(core);
}

}  // namespace capsoc::armv7m
