#include "inject/fault.h"

#include <fmt/format.h>

#include <array>
#include <sstream>

#include "base/input_file.h"
#include "base/number.h"
#include "base/printable.h"
#include "serial/script_time.h"

namespace capsoc::inject {
namespace {

using Kind = Fault::Kind;
using Unit = When::Unit;

constexpr const char* form =
    "write WHAT PLACE at WHEN [for SECONDS], for instance flip cpu.r3[5] at 0.25s";
constexpr const char* kinds =
    "flip, stuck0 or stuck1 PLACE[BIT], read REGISTER[BIT] or write REGISTER[BIT]; lose or double "
    "sample; freeze sin or cos; lose clock, irq NAME, write REGISTER; raise irq NAME; fail read "
    "or write REGISTER";
constexpr const char* times = "write 0.25s, cycle N, instruction N, sample N or sample N cycle M";

struct NamedKind {
  const char* word;
  const char* object;  ///< the word that follows; null: a place with a bit
  Kind kind;
};
constexpr std::array<NamedKind, 13> named_kinds = {{{"flip", nullptr, Kind::flip},
                                                    {"stuck0", nullptr, Kind::stuck0},
                                                    {"stuck1", nullptr, Kind::stuck1},
                                                    {"lose", "sample", Kind::lose_sample},
                                                    {"double", "sample", Kind::double_sample},
                                                    {"lose", "clock", Kind::lose_clock},
                                                    {"freeze", "sin", Kind::freeze},
                                                    {"freeze", "cos", Kind::freeze},
                                                    {"lose", "irq", Kind::lose_interrupt},
                                                    {"raise", "irq", Kind::raise_interrupt},
                                                    {"lose", "write", Kind::lose_write},
                                                    {"fail", "read", Kind::fail_access},
                                                    {"fail", "write", Kind::fail_access}}};

struct NamedUnit {
  const char* word;
  Unit unit;
};
constexpr std::array<NamedUnit, 3> named_units = {
    {{"cycle", Unit::cycle}, {"instruction", Unit::instruction}, {"sample", Unit::sample}}};

struct NamedWay {
  const char* word;
  Fault::Way way;
};
constexpr std::array<NamedWay, 2> named_ways = {
    {{"read", Fault::Way::read}, {"write", Fault::Way::write}}};

/// Of the word of an access; none: it is no such word.
Fault::Way way_of(const std::string& word) {
  for (const NamedWay& way : named_ways)
    if (word == way.word) return way.way;
  return Fault::Way::none;
}

bool is_of_access(Kind kind) {
  return kind == Kind::lose_write || kind == Kind::fail_access;
}

bool is_about_interrupt(Kind kind) {
  return kind == Kind::lose_interrupt || kind == Kind::raise_interrupt;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream text(line);
  std::vector<std::string> words;
  for (std::string word; text >> word;) words.push_back(word);
  return words;
}

std::optional<uint64_t> decimal_number(const std::string& text) {
  if (text.empty() || text.size() > 18 || text.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  return std::stoull(text);
}

/// "0.25s" or "0.25", ps.
std::optional<uint64_t> time_in(const std::string& word) {
  if (!word.empty() && word.back() == 's')
    return serial::script_time(word.substr(0, word.size() - 1));
  return serial::script_time(word);
}

/// The words of a fault, taken one after the other.
class Reader {
 public:
  explicit Reader(const std::string& line) : words_(words_of(line)) {}

  bool at_end() const { return next_ == words_.size(); }
  std::string take() { return at_end() ? "" : words_[next_++]; }
  bool is_next(const char* word) const { return !at_end() && words_[next_] == word; }
  bool take(const char* word) {
    if (!is_next(word)) return false;
    ++next_;
    return true;
  }

 private:
  std::vector<std::string> words_;
  std::size_t next_ = 0;
};

/// "cpu.r3[5]": the last brackets are the bit.
std::optional<Error> take_place(const std::string& word, Fault& fault) {
  if (word.empty() || word == "at")
    return fault.way == Fault::Way::none
               ? Error{"names no place; write PLACE[BIT], for instance cpu.r3[5]"}
               : Error{"names no register; write DEVICE.REGISTER[BIT], for instance ADC.CTRL[0]"};
  const std::size_t open = word.rfind('[');
  const auto bit = word.back() != ']' || open == std::string::npos || open == 0
                       ? std::nullopt
                       : decimal_number(word.substr(open + 1, word.size() - open - 2));
  if (!bit || *bit > INT32_MAX)
    return Error{fmt::format("'{}' names no bit; write PLACE[BIT], for instance cpu.r3[5]",
                             printable(word, 80))};
  fault.place = word.substr(0, open);
  fault.bit = static_cast<unsigned>(*bit);
  return std::nullopt;
}

std::optional<Error> take_kind(Reader& words, Fault& fault) {
  const std::string first = words.take();
  for (const NamedKind& kind : named_kinds) {
    if (first != kind.word) continue;
    fault.kind = kind.kind;
    if (kind.object == nullptr) {
      std::string word = words.take();
      fault.way = way_of(word);
      if (fault.way != Fault::Way::none) word = words.take();
      return take_place(word, fault);
    }
    if (!words.take(kind.object)) continue;
    if (kind.kind == Kind::freeze) fault.place = kind.object;
    if (is_of_access(kind.kind)) fault.way = way_of(kind.object);
    if (is_about_interrupt(kind.kind) || is_of_access(kind.kind)) fault.place = words.take();
    return std::nullopt;
  }
  return Error{fmt::format("'{}' is no fault; there are {}", printable(first, 80), kinds)};
}

/// "sample 500 cycle 40".
std::optional<Error> take_cycles(Reader& words, Fault& fault) {
  if (!words.take("cycle")) return std::nullopt;
  const std::string word = words.take();
  const auto cycles = decimal_number(word);
  if (!cycles)
    return Error{fmt::format("'cycle {}' is no time; write sample N cycle M", printable(word, 40))};
  fault.when.cycles = *cycles;
  return std::nullopt;
}

std::optional<Error> take_time(Reader& words, Fault& fault) {
  if (!words.take("at")) return Error{fmt::format("has no time; {}", form)};
  std::string word = words.take();
  for (const NamedUnit& unit : named_units) {
    if (word != unit.word) continue;
    word = words.take();
    const auto number = decimal_number(word);
    if (!number || (unit.unit == Unit::sample && *number == 0))
      return Error{fmt::format("'{} {}' is no time; {}", unit.word, printable(word, 40), times)};
    fault.when = {unit.unit, *number, 0};
    return unit.unit == Unit::sample ? take_cycles(words, fault) : std::nullopt;
  }
  const auto time = time_in(word);
  if (!time) return Error{fmt::format("'{}' is no time; {}", printable(word, 40), times)};
  fault.when = {Unit::time, *time, 0};
  return std::nullopt;
}

std::optional<Error> take_duration(Reader& words, Fault& fault) {
  if (!words.take("for")) return std::nullopt;
  const std::string word = words.take();
  const auto time = time_in(word);
  if (!time || *time == 0)
    return Error{fmt::format("'for {}' is no duration; write for 0.1s", printable(word, 40))};
  if (fault.kind == Kind::flip || fault.kind == Kind::double_sample ||
      fault.kind == Kind::raise_interrupt)
    return Error{"happens once; leave out 'for'"};
  fault.duration = *time;
  return std::nullopt;
}

std::string time_text(uint64_t picoseconds) {
  return fmt::format("{}s", static_cast<double>(picoseconds) / 1e12);
}

std::string object_text(const Fault& fault) {
  std::string way;
  for (const NamedWay& each : named_ways)
    if (fault.way == each.way) way = std::string(each.word) + " ";
  switch (fault.kind) {
    case Kind::flip:
      return fmt::format("flip {}{}[{}]", way, fault.place, fault.bit);
    case Kind::stuck0:
      return fmt::format("stuck0 {}{}[{}]", way, fault.place, fault.bit);
    case Kind::stuck1:
      return fmt::format("stuck1 {}{}[{}]", way, fault.place, fault.bit);
    case Kind::lose_sample:
      return "lose sample";
    case Kind::double_sample:
      return "double sample";
    case Kind::lose_clock:
      return "lose clock";
    case Kind::freeze:
      return "freeze " + fault.place;
    case Kind::lose_interrupt:
      return "lose irq " + fault.place;
    case Kind::raise_interrupt:
      return "raise irq " + fault.place;
    case Kind::lose_write:
      return "lose write " + fault.place;
    case Kind::fail_access:
      return fmt::format("fail {}{}", way, fault.place);
  }
  return "";
}

}  // namespace

uint64_t with_bit(const Fault& fault, uint64_t value, unsigned bit) {
  const uint64_t mask = uint64_t{1} << bit;
  switch (fault.kind) {
    case Kind::stuck0:
      return value & ~mask;
    case Kind::stuck1:
      return value | mask;
    default:
      return value ^ mask;
  }
}

Result<Fault> parse_fault(const std::string& line, const std::optional<When>& now) {
  Reader words(line);
  Fault fault;
  if (words.at_end()) return Error{fmt::format("is empty; {}", form)};
  if (auto error = take_kind(words, fault)) return *error;
  if (is_about_interrupt(fault.kind) && fault.place.empty())
    return Error{"names no interrupt; write its line or its device, for instance irq coprocessor"};
  if (is_of_access(fault.kind) && fault.place.empty())
    return Error{"names no register; write DEVICE.REGISTER, for instance COPROCESSOR.CTRL"};
  if (now && !words.is_next("at"))
    fault.when = *now;
  else if (auto error = take_time(words, fault))
    return *error;
  if (auto error = take_duration(words, fault)) return *error;
  if (!words.at_end())
    return Error{fmt::format("has '{}' after its end; {}", printable(words.take(), 40), form)};
  return fault;
}

std::string to_text(const Fault& fault) {
  std::string text = object_text(fault) + " at ";
  if (fault.when.unit == Unit::time) text += time_text(fault.when.value);
  for (const NamedUnit& unit : named_units)
    if (fault.when.unit == unit.unit) text += fmt::format("{} {}", unit.word, fault.when.value);
  if (fault.when.cycles != 0) text += fmt::format(" cycle {}", fault.when.cycles);
  if (fault.duration) text += " for " + time_text(*fault.duration);
  return text;
}

Result<std::vector<Fault>> parse_faults(const std::string& file, const std::string& text) {
  std::vector<Fault> faults;
  std::istringstream lines{std::string(without_byte_order_mark(text))};
  unsigned number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    line = line.substr(0, line.find('#'));
    if (words_of(line).empty()) continue;
    const std::string origin = fmt::format("{}:{}", file, number);
    auto fault = parse_fault(line);
    if (!fault) return Error{fmt::format("{}: {}", origin, fault.error())};
    fault.value().origin = origin;
    faults.push_back(std::move(fault.value()));
  }
  if (faults.empty()) return Error{fmt::format("{}: has no fault; {}", file, form)};
  return faults;
}

}  // namespace capsoc::inject
