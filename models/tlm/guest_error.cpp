#include "tlm/guest_error.h"

#include <spdlog/spdlog.h>

#include <map>
#include <mutex>

namespace capsoc::tlm_util {
namespace {

// One log for the process, like spdlog's own; locked, because tests and a debugger's thread may
// report as well.
struct Reports {
  std::mutex mutex;
  std::map<std::string, uint64_t, std::less<>> counts;
  std::function<std::string()> context;
};

Reports& reports() {
  static Reports instance;
  return instance;
}

}  // namespace

void guest_error(std::string_view source, std::string_view text) {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  auto entry = all.counts.find(source);
  if (entry == all.counts.end()) entry = all.counts.emplace(std::string(source), 0).first;
  const uint64_t count = ++entry->second;
  if (count > guest_error_limit) return;
  const std::string where = all.context ? " (" + all.context() + ")" : std::string();
  spdlog::warn(
      "{}: {}{}{}", source, text, where,
      count == guest_error_limit ? "; further messages of this source are only counted" : "");
}

uint64_t guest_error_count(std::string_view source) {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  const auto entry = all.counts.find(source);
  return entry == all.counts.end() ? 0 : entry->second;
}

uint64_t guest_error_total() {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  uint64_t total = 0;
  for (const auto& entry : all.counts) total += entry.second;
  return total;
}

void summarise_guest_errors() {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  for (const auto& [source, count] : all.counts) {
    if (count > guest_error_limit) {
      spdlog::warn("{}: {} further messages left out", source, count - guest_error_limit);
    }
  }
}

void clear_guest_errors() {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  all.counts.clear();
}

void set_guest_error_context(std::function<std::string()> context) {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  all.context = std::move(context);
}

}  // namespace capsoc::tlm_util
