#include "observers/run_observer.h"

#include <utility>

namespace capsoc::run {

std::optional<Error> Observers::add(std::unique_ptr<RunObserver> observer) {
  if (auto error = observer->open()) return error;
  all_.push_back(std::move(observer));
  return std::nullopt;
}

void Observers::visit(Archive& archive) {
  for (const auto& observer : all_) observer->visit(archive);
}

void Observers::restored() {
  for (const auto& observer : all_) observer->restored();
}

std::vector<RunObserver*> Observers::gatherers() const {
  std::vector<RunObserver*> gatherers;
  for (const auto& observer : all_)
    if (observer->gathered() != nullptr) gatherers.push_back(observer.get());
  return gatherers;
}

void Observers::close(RunResult& result) {
  for (const auto& observer : all_) observer->close(result);
}

void Observers::finish(RunResult& result) {
  for (const auto& observer : all_) observer->finish(result);
}

std::string Observers::crash() const {
  for (const auto& observer : all_)
    if (std::string reason = observer->crash(); !reason.empty()) return reason;
  return "";
}

Findings Observers::findings() const {
  Findings findings;
  for (const auto& observer : all_)
    if (auto finding = observer->finding()) findings.push_back(std::move(*finding));
  return findings;
}

}  // namespace capsoc::run
