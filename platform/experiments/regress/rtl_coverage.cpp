#include "regress/rtl_coverage.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "base/input_file.h"
#include "host/files.h"

namespace capsoc::regress {
namespace {

/// A point of a Verilator coverage file: C 'key' count, the key being \1 name \2 value ...
struct Point {
  std::string page, file, object, hierarchy;
  unsigned line = 0;
};

Point parse(const std::string& key) {
  Point point;
  std::istringstream parts(key);
  for (std::string part; std::getline(parts, part, '\1');) {
    const size_t split = part.find('\2');
    if (split == std::string::npos) continue;
    const std::string name = part.substr(0, split), value = part.substr(split + 1);
    if (name == "page") point.page = value.substr(0, value.find('/'));
    if (name == "f") point.file = value;
    if (name == "o") point.object = value;
    if (name == "h") point.hierarchy = value;
    if (name == "l") point.line = static_cast<unsigned>(std::strtoul(value.c_str(), nullptr, 10));
  }
  return point;
}

std::string base_name(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}

/// The RTL itself: rtl/*.sv without what verifies it.
bool counts(const Point& point) {
  const std::string folder = "rtl/" + base_name(point.file);
  return point.file.size() >= folder.size() &&
         point.file.compare(point.file.size() - folder.size(), folder.size(), folder) == 0;
}

/// Every file has the same points; one with fewer was cut short.
Result<std::map<std::string, uint64_t>> sum(const std::vector<std::string>& files) {
  std::map<std::string, uint64_t> points;
  for (const std::string& name : files) {
    std::ifstream file(name);
    if (!file)
      return Error{fmt::format("{} cannot be read: coverage needs a library built for it", name)};
    const size_t before = points.size();
    std::set<std::string> seen;
    for (std::string line; std::getline(file, line);) {
      const size_t end = line.rfind('\'');
      if (line.rfind("C '", 0) != 0 || end < 3) continue;
      const std::string key = line.substr(3, end - 3);
      points[key] += std::strtoull(line.c_str() + end + 1, nullptr, 10);
      seen.insert(key);
    }
    if (seen.size() != points.size() || (before != 0 && before != points.size()))
      return Error{fmt::format("{} or a file before it is cut short; make room on its disk", name)};
  }
  return points;
}

}  // namespace

Result<CoverageExceptions> CoverageExceptions::read(const std::string& file) {
  constexpr uint64_t largest = 1U << 24U;
  const auto text = read_input(file, {"name the points that cannot be reached", largest, true});
  if (!text) return Error{text.error()};
  std::istringstream in(text.value());
  CoverageExceptions exceptions;
  unsigned number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.empty() || line[0] == '#') continue;
    const size_t reason = line.find('#');
    std::istringstream words(line.substr(0, reason));
    Entry entry;
    words >> entry.kind;
    if (entry.kind == "precise" || entry.kind == "paper") {
      entry.arithmetic = entry.kind;
      words >> entry.kind;
    }
    words >> entry.file >> entry.what;
    if (entry.what.empty() || reason == std::string::npos || reason + 2 >= line.size())
      return Error{fmt::format(
          "{}:{}: write [precise or paper,] kind, file, line or signal, # and the reason", file,
          number)};
    exceptions.entries_.push_back(std::move(entry));
  }
  return exceptions;
}

// A signal without an index stands for all of its bits; "name[high:low]" for some, or for some
// words of a memory.
bool CoverageExceptions::holds(const std::string& arithmetic, const std::string& kind,
                               const std::string& file, unsigned line,
                               const std::string& name) const {
  for (const Entry& entry : entries_) {
    if (!entry.arithmetic.empty() && entry.arithmetic != arithmetic) continue;
    if (entry.kind != kind || entry.file != file) continue;
    if (entry.what == name || entry.what == std::to_string(line)) return true;
    const size_t bracket = name.find('[');
    if (bracket == std::string::npos) continue;
    const std::string signal = name.substr(0, bracket);
    if (entry.what == signal) return true;
    unsigned high = 0, low = 0;
    const std::string pattern = signal + "[%u:%u]";
    if (std::sscanf(entry.what.c_str(), pattern.c_str(), &high, &low) == 2) {
      const unsigned long bit = std::strtoul(name.c_str() + bracket + 1, nullptr, 10);
      if (entry.what.rfind(signal + "[", 0) == 0 && bit <= high && bit >= low) return true;
    }
  }
  return false;
}

Result<RtlCoverage> merge_coverage(const std::string& arithmetic,
                                   const std::vector<std::string>& files, const std::string& merged,
                                   const CoverageExceptions& exceptions) {
  const auto points = sum(files);
  if (!points) return Error{points.error()};
  std::string text = "# SystemC::Coverage-3\n";
  for (const auto& [key, hits] : points.value()) text += fmt::format("C '{}' {}\n", key, hits);
  if (auto error = host::write_whole(merged, text)) return *error;

  RtlCoverage coverage;
  coverage.arithmetic = arithmetic;
  coverage.kinds = {{"line", 0, 0, 0, {}}, {"toggle", 0, 0, 0, {}}};
  for (const auto& [key, hits] : points.value()) {
    const Point point = parse(key);
    if (!counts(point)) continue;
    const bool toggle = point.page == "v_toggle";
    if (!toggle && point.page != "v_line" && point.page != "v_branch") continue;
    RtlCoverage::Kind& kind = coverage.kinds[toggle ? 1 : 0];
    ++kind.points;
    const std::string file = base_name(point.file);
    if (hits > 0) {
      ++kind.covered;
    } else if (exceptions.holds(arithmetic, kind.name, file, point.line, point.object)) {
      ++kind.excepted;
    } else {
      kind.missing.push_back(
          fmt::format("{}:{} {} ({})", file, point.line, point.object, point.hierarchy));
    }
  }
  return coverage;
}

}  // namespace capsoc::regress
