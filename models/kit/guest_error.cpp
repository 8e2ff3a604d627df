#include "kit/guest_error.h"

#include <spdlog/spdlog.h>

#include <map>
#include <mutex>
#include <vector>

namespace capsoc::kit {
namespace {

// One log for the process, like spdlog's own; locked, because tests and a debugger's thread may
// report as well.
struct Reports {
  struct Source {
    uint64_t count = 0, logged = 0;
  };
  std::mutex mutex;
  std::map<std::string, Source, std::less<>> sources;
  std::function<std::string()> context;
  std::function<void(std::string_view, std::string_view)> listener;

  std::string where() const { return context ? " (" + context() + ")" : std::string(); }
};

Reports& reports() {
  static Reports instance;
  return instance;
}

void report(std::string_view name, std::string_view text, uint64_t limit) {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  auto entry = all.sources.find(name);
  if (entry == all.sources.end())
    entry = all.sources.emplace(std::string(name), Reports::Source{}).first;
  Reports::Source& source = entry->second;
  if (all.listener) all.listener(name, text);
  if (++source.count > limit) return;
  ++source.logged;
  spdlog::warn("{}: {}{}{}", name, text, all.where(),
               source.count == limit ? "; further messages of this source are only counted" : "");
}

}  // namespace

void guest_error(std::string_view source, std::string_view text) {
  report(source, text, guest_error_limit);
}

void guest_error_once(std::string_view source, std::string_view text) {
  report(source, text, 1);
}

void guest_note(std::string_view source, std::string_view text) {
  if (!spdlog::should_log(spdlog::level::info)) return;
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  spdlog::info("{}: {}{}", source, text, all.where());
}

uint64_t guest_error_count(std::string_view source) {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  const auto entry = all.sources.find(source);
  return entry == all.sources.end() ? 0 : entry->second.count;
}

uint64_t guest_error_total() {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  uint64_t total = 0;
  for (const auto& entry : all.sources) total += entry.second.count;
  return total;
}

void summarise_guest_errors() {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  for (const auto& [name, source] : all.sources)
    if (source.count > source.logged)
      spdlog::warn("{}: {} further messages left out", name, source.count - source.logged);
}

void clear_guest_errors() {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  all.sources.clear();
}

void set_guest_error_context(std::function<std::string()> context) {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  all.context = std::move(context);
}

void set_guest_error_listener(std::function<void(std::string_view, std::string_view)> listener) {
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  all.listener = std::move(listener);
}

void visit_guest_errors(Archive& archive) {
  struct Entry {
    std::string source;
    uint64_t count = 0, logged = 0;
    void visit(Archive& to) {
      to("source", source);
      to("count", count);
      to("logged", logged);
    }
  };
  Reports& all = reports();
  const std::lock_guard lock(all.mutex);
  std::vector<Entry> entries;
  for (const auto& [name, source] : all.sources)
    entries.push_back({name, source.count, source.logged});
  archive("sources", entries);
  if (!archive.loading() || !archive.ok()) return;
  all.sources.clear();
  for (const Entry& entry : entries) all.sources[entry.source] = {entry.count, entry.logged};
}

}  // namespace capsoc::kit
