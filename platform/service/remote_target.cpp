#include "service/remote_target.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>
#include <string_view>
#include <utility>

#include "base/number.h"
#include "service/stop_points.h"

namespace capsoc::service {
namespace {

std::optional<double> seconds(std::string_view text) {
  if (!text.empty() && text.back() == 's') text.remove_suffix(1);
  return finite_number(text);
}

constexpr const char* position_form = "a time as 0.25s, #INSTRUCTION, cycle N or sample N";

/// A position from word `at` on, which moves after it, as simulation.goto takes it; null: none.
Json position_from(const std::vector<std::string>& words, std::size_t& at) {
  if (at >= words.size()) return nullptr;
  const std::string& first = words[at++];
  if (first.front() == '#') {
    const auto count = whole_number(std::string_view(first).substr(1));
    return count ? Json{{"instructions", *count}} : Json();
  }
  if (first == "cycle" || first == "sample") {
    const auto count = at < words.size() ? whole_number(words[at++]) : std::nullopt;
    return count ? Json{{first == "cycle" ? "cycles" : "sample", *count}} : Json();
  }
  const auto time = seconds(first);
  return time ? Json{{"time_s", *time}} : Json();
}

/// {"one"} or {"one", "other"} from the words after a command; null: they are something else.
Json positions_from(const std::vector<std::string>& words) {
  std::size_t at = 1;
  Json positions = {{"one", position_from(words, at)}};
  if (at < words.size()) positions["other"] = position_from(words, at);
  if (at != words.size()) return nullptr;
  for (const Json& each : positions)
    if (each.is_null()) return nullptr;
  return positions;
}

std::string text_of(const Json& position) {
  return fmt::format("{:.12g} s, instruction {}, cycle {}, sample {}",
                     position.at("time_s").get<double>(),
                     position.at("instructions").get<uint64_t>(),
                     position.at("cycles").get<uint64_t>(), position.at("samples").get<uint64_t>());
}

/// Bytes as hexadecimal digits in the order of addresses, numbers as they are.
std::string text_of_value(const Json& value) {
  if (value.is_number_float()) return fmt::format("{:.12g}", value.get<double>());
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const Json& byte : value) text += fmt::format("{:02x}", byte.get<unsigned>());
  return text;
}

/// Who changed a register, or what a signal changed with.
std::string who(const Json& change) {
  if (!change.contains("by"))
    return fmt::format("the result of sample {}", change.at("position").at("samples").dump());
  const auto by = change.at("by").get<std::string>();
  if (by == "instruction")
    return fmt::format("a {} of {} by {}", change.at("access").get<std::string>(),
                       change.at("accessed").get<std::string>(),
                       change.at("place").get<std::string>());
  if (by != "device") return by + ", from outside";
  return change.contains("sample")
             ? fmt::format("the device, with the result of sample {}", change.at("sample").dump())
             : "the device";
}

std::string what_happened(const Json& event) {
  const auto kind = event.at("kind").get<std::string>();
  const auto text = [&](const char* name) { return event.at(name).get<std::string>(); };
  const auto number = [&](const char* name) { return event.at(name).get<uint64_t>(); };
  if (kind == "exception" || kind == "fault")
    return fmt::format("{} {}, {}", kind, number("exception"), text("name"));
  if (kind == "sample")
    return event.at("angle_deg").is_null() ? fmt::format("sample {}: no angle", number("sample"))
                                           : fmt::format("sample {}: {:.6f} deg", number("sample"),
                                                         event.at("angle_deg").get<double>());
  if (kind == "uart") return fmt::format("uart{}: {}", number("uart"), text("line"));
  if (kind == "pins")
    return fmt::format("gpio{}: {:#06x} of {:#06x}", number("gpio"), number("levels"),
                       number("driven"));
  if (kind == "verdict")
    return event.at("pass") == Json(true)
               ? fmt::format("verdict: pass, bound {:.3g} deg", event.at("bound_deg").get<double>())
               : fmt::format("verdict: fail, {}", text("reason"));
  if (kind == "guest_error") return fmt::format("{}: {}", text("source"), text("text"));
  return kind + ' ' + event.value("count", Json()).dump();
}

/// "T1 relative = 12.5 deg, from s_high s_low"
std::string text_of_step(const Json& step) {
  std::string text = fmt::format("{} {} = ", step.at("stage").get<std::string>(),
                                 step.at("name").get<std::string>());
  if (step.contains("value"))
    text += fmt::format("{:.9g}{}", step.at("value").get<double>(),
                        step.at("is_angle").get<bool>() ? " deg" : "");
  else
    text += fmt::format("{:#x}", step.at("word").get<int64_t>());
  const auto sources = step.at("made_from").get<std::vector<std::string>>();
  return fmt::format("{}{}{}\n", text, sources.empty() ? "" : ", from ", fmt::join(sources, " "));
}

std::string text_of_event(const Json& event) {
  return fmt::format("{:.9f} s  {}\n", event.at("time_s").get<double>(), what_happened(event));
}

void add_differences(std::string& text, const Json& list) {
  for (const auto& [name, both] : list.items())
    text += fmt::format("{}: {} -> {}\n", name, both.at(0).dump(), both.at(1).dump());
}

}  // namespace

Answer RemoteTarget::ask(const std::string& method, Json parameters) {
  parameters["simulation"] = simulation_;
  return session_.call(method, std::move(parameters));
}

/// Something that is written in the past begins another history.
Answer RemoteTarget::change(const std::string& method, Json parameters) {
  forget();
  Answer answer = ask(method, std::move(parameters));
  if (const auto ended = answer.result.find("ended_history"); ended != answer.result.end())
    say_(fmt::format(
        "a new history begins here; history {0} is kept, until {1}: monitor history {0}\n",
        ended->at("history").get<uint64_t>(), text_of(*ended)));
  return answer;
}

void RemoteTarget::change_or_say(const std::string& method, Json parameters) {
  if (const Answer answer = change(method, std::move(parameters)); !answer.ok())
    say_(answer.sentence + "\n");
}

const RemoteTarget::Registers& RemoteTarget::read_registers() {
  static const Registers nothing{};
  if (registers_) return *registers_;
  const Answer answer = ask("processor.read", Json::object());
  if (!answer.ok()) return nothing;
  registers_.emplace();
  const Json& values = answer.result.at("registers");
  for (std::size_t i = 0; i < debug::registers.size(); ++i)
    if (const auto value = values.find(debug::registers[i].name); value != values.end())
      (*registers_)[i] = value->get<uint32_t>();
  return *registers_;
}

bool RemoteTarget::has_register(unsigned index) {
  return read_registers().at(index).has_value();
}

uint32_t RemoteTarget::read_register(unsigned index) {
  return read_registers().at(index).value_or(0);
}

std::string RemoteTarget::processor() {
  if (!processor_.empty()) return processor_;
  const Answer answer = ask("debugger.about", Json::object());
  if (answer.ok()) processor_ = answer.result.at("processor").get<std::string>();
  return processor_;
}

void RemoteTarget::write_register(unsigned index, uint32_t value) {
  change_or_say("processor.write", {{"register", debug::registers[index].name}, {"value", value}});
}

std::string RemoteTarget::read_memory(uint32_t address, uint32_t size) {
  const Answer answer = ask("memory.read", {{"address", address}, {"size", size}, {"short", true}});
  return answer.ok() ? bytes_in(answer.result.at("bytes"), answer.frames) : "";
}

bool RemoteTarget::write_memory(uint32_t address, const std::string& bytes) {
  Json list = Json::array();
  for (const char byte : bytes) list.push_back(static_cast<uint8_t>(byte));
  return change("memory.write", {{"address", address}, {"bytes", std::move(list)}}).ok();
}

bool RemoteTarget::set(debug::StopPoint kind, uint32_t address, uint32_t size) {
  if (!is_breakpoint(kind) && size == 0) return false;
  ++points_[{kind, address, size}];
  return true;
}

void RemoteTarget::clear(debug::StopPoint kind, uint32_t address, uint32_t size) {
  const auto found = points_.find({kind, address, size});
  if (found != points_.end() && --found->second == 0) points_.erase(found);
}

Json RemoteTarget::points() const {
  Json list = Json::array();
  for (const auto& [point, count] : points_) {
    const auto& [kind, address, size] = point;
    list.push_back({{"kind", name_of(kind)}, {"address", address}, {"size", size}});
  }
  return list;
}

void RemoteTarget::reset() {
  change_or_say("processor.reset", Json::object());
}

std::string RemoteTarget::save(const std::string& file) {
  const Answer answer = ask("simulation.save", {{"file", file}});
  return answer.ok() ? file + ": saved\n" : answer.sentence + "\n";
}

std::string RemoteTarget::state() {
  const Answer answer = ask("debugger.about", Json::object());
  return answer.ok() ? answer.result.at("state").get<std::string>() : answer.sentence;
}

std::vector<debug::MemoryRange> RemoteTarget::memory_ranges() {
  if (!ranges_.empty()) return ranges_;
  const Answer answer = ask("debugger.about", Json::object());
  if (answer.ok())
    for (const Json& range : answer.result.at("memory"))
      ranges_.push_back({range.at(0).get<uint64_t>(), range.at(1).get<uint64_t>()});
  return ranges_;
}

std::string RemoteTarget::show_stimulus(uint32_t, bool) {
  return "itm: with a history the port is enabled from the start: capsoc run --itm stdout\n";
}

std::string RemoteTarget::command_help() const {
  return "when             where the simulation is in its history\n"
         "goto POSITION    back or forward: a time as 0.25s, #INSTRUCTION, cycle N, sample N\n"
         "history [NUMBER] the histories that were left, or to the end of one of them\n"
         "last-write ADDRESS|VARIABLE|$REGISTER [SIZE]  which instruction wrote it last\n"
         "last-change NAME the last change of PERIPHERAL.REGISTER[.FIELD] or of a signal\n"
         "who-set NAME     who made it: an instruction, the device, the debugger\n"
         "timeline POSITION [POSITION]  exceptions, samples, lines of UARTs, pins between them\n"
         "why SIGNAL [SAMPLE]  the values of the coprocessor that made it, back to the sample\n"
         "diff POSITION [POSITION]  what differs between then and then, or now\n"
         "record FILE      the session until now, for capsoc replay\n";
}

std::optional<std::string> RemoteTarget::command(const std::string& line) {
  std::istringstream stream(line);
  Words words;
  for (std::string word; stream >> word;) words.push_back(word);
  if (words.empty()) return std::nullopt;
  static const std::map<std::string, std::string (RemoteTarget::*)(const Words&)> commands = {
      {"goto", &RemoteTarget::go_to},
      {"history", &RemoteTarget::histories},
      {"last-write", &RemoteTarget::last_write},
      {"last-change", &RemoteTarget::last_change},
      {"who-set", &RemoteTarget::last_change},
      {"timeline", &RemoteTarget::timeline},
      {"why", &RemoteTarget::why},
      {"diff", &RemoteTarget::differences},
      {"record", &RemoteTarget::record}};
  if (words[0] == "when") return when();
  const auto found = commands.find(words[0]);
  if (found == commands.end()) return std::nullopt;
  return (this->*found->second)(words);
}

std::string RemoteTarget::when() {
  const Answer answer = ask("history.when", Json::object());
  if (!answer.ok()) return answer.sentence + "\n";
  const Json& about = answer.result;
  return fmt::format(
      "now:       {}\nbeginning: {}\nend:       {}\n{} inputs, {} snapshots, {:.1f} MB\n",
      text_of(about.at("now")), text_of(about.at("beginning")), text_of(about.at("end")),
      about.at("inputs").get<uint64_t>(), about.at("snapshots").get<uint64_t>(),
      static_cast<double>(about.at("bytes").get<uint64_t>()) * 1e-6);
}

std::string RemoteTarget::go_to(const Words& words) {
  std::size_t at = 1;
  Json position = position_from(words, at);
  if (position.is_null() || at != words.size())
    return fmt::format("goto: write {}\n", position_form);
  return jump("simulation.goto", std::move(position));
}

/// Somewhere else, of which the debugger has no notice.
std::string RemoteTarget::jump(const std::string& method, Json parameters) {
  forget();
  const Answer answer = ask(method, std::move(parameters));
  if (!answer.ok()) return answer.sentence + "\n";
  const Answer where = ask("simulation.state", Json::object());
  std::string place = where.ok() ? where.result.at("place").get<std::string>() : "";
  if (!place.empty() && place.back() != '\n') place += '\n';
  return fmt::format(
      "{}\n{}GDB still shows the old registers: maintenance flush register-cache, which "
      "history.gdb "
      "does after each monitor command\n",
      text_of(answer.result.at("state")), place);
}

std::string RemoteTarget::histories(const Words& words) {
  if (words.size() > 1) {
    const auto number = words.size() == 2 ? whole_number(words[1]) : std::nullopt;
    return number ? jump("history.select", {{"number", *number}})
                  : "history: write the number of one, or nothing\n";
  }
  const Answer answer = ask("history.list", Json::object());
  if (!answer.ok()) return answer.sentence + "\n";
  std::string text;
  for (const Json& each : answer.result.at("histories"))
    text += fmt::format(
        "{}{}: {} inputs, until {}{}\n", each.at("present") == Json(true) ? "* " : "  ",
        each.at("history").get<uint64_t>(), each.at("inputs").get<uint64_t>(),
        text_of(each.at("end")),
        each.contains("from") ? "; the present one until " + text_of(each.at("from")) : "");
  return text;
}

std::string RemoteTarget::last_write(const Words& words) {
  constexpr const char* form =
      "last-write: write an address with a size, a variable or $register\n";
  if (words.size() < 2 || words.size() > 3) return form;
  Json what;
  const auto address = whole_number(words[1]);
  const auto size = words.size() == 3 ? whole_number(words[2]) : std::nullopt;
  if (words.size() == 3 && (!size || !address)) return form;
  if (address)
    what = {{"address", *address}, {"size", size.value_or(4)}};
  else if (words[1].front() == '$')
    what = {{"register", words[1].substr(1)}};
  else
    what = {{"variable", words[1]}};
  const Answer answer = ask("history.last_write", std::move(what));
  if (!answer.ok()) return answer.sentence + "\n";
  const Json& found = answer.result;
  if (!found.at("found").get<bool>()) return "nothing wrote it since the history began\n";
  const std::string by = found.at("by") == Json("instruction")
                             ? found.at("place").get<std::string>()
                             : found.at("by").get<std::string>() + ", from outside";
  return fmt::format("{} -> {}: {}\nat {}\n", text_of_value(found.at("old")),
                     text_of_value(found.at("new")), by, text_of(found.at("position")));
}

std::string RemoteTarget::last_change(const Words& words) {
  if (words.size() != 2)
    return fmt::format("{}: write PERIPHERAL.REGISTER[.FIELD] or a signal of the coprocessor\n",
                       words[0]);
  const bool is_register = words[1].find('.') != std::string::npos;
  const Answer answer = ask("history.last_change", {{is_register ? "name" : "signal", words[1]}});
  if (!answer.ok()) return answer.sentence + "\n";
  const Json& found = answer.result;
  if (!found.at("found").get<bool>()) return "it did not change since the history began\n";
  return fmt::format("{} -> {}: {}\nat {}\n", text_of_value(found.at("old")),
                     text_of_value(found.at("new")), who(found), text_of(found.at("position")));
}

std::string RemoteTarget::timeline(const Words& words) {
  Json between = positions_from(words);
  if (between.is_null())
    return fmt::format("timeline: write one or two positions: {}\n", position_form);
  const Answer answer = ask("history.timeline", std::move(between));
  if (!answer.ok()) return answer.sentence + "\n";
  constexpr std::size_t most = 1000;
  const Json& events = answer.result.at("events");
  std::string text;
  for (std::size_t i = 0; i < std::min(events.size(), most); ++i) text += text_of_event(events[i]);
  if (events.size() > most) text += fmt::format("and {} more\n", events.size() - most);
  return text.empty() ? "nothing happened there\n" : text;
}

std::string RemoteTarget::why(const Words& words) {
  const auto sample = words.size() == 3 ? whole_number(words[2]) : std::nullopt;
  if (words.size() < 2 || words.size() > 3 || (words.size() == 3 && !sample))
    return "why: write a signal of the coprocessor, and perhaps the number of a sample\n";
  Json asked = {{"signal", words[1]}};
  if (sample) asked["sample"] = *sample;
  const Answer answer = ask("history.why", std::move(asked));
  if (!answer.ok()) return answer.sentence + "\n";
  const Json& found = answer.result;
  std::string text = fmt::format("result {} at {}\n", found.at("sample").get<uint64_t>(),
                                 text_of(found.at("position")));
  for (const Json& step : found.at("steps")) text += text_of_step(step);
  for (const auto& [name, value] : found.at("inputs").items())
    text += fmt::format("{}{}\n", name, value.is_null() ? "" : " = " + value.dump());
  return text;
}

std::string RemoteTarget::differences(const Words& words) {
  Json positions = positions_from(words);
  if (positions.is_null())
    return fmt::format("diff: write one or two positions: {}\n", position_form);
  const Answer answer = ask("history.diff", std::move(positions));
  if (!answer.ok()) return answer.sentence + "\n";
  std::string text =
      fmt::format("{}\n{}\n", text_of(answer.result.at("one")), text_of(answer.result.at("other")));
  add_differences(text, answer.result.at("processor"));
  add_differences(text, answer.result.at("devices"));
  for (const Json& each : answer.result.at("memory"))
    text += fmt::format("{}: {} -> {}\n",
                        each.at("name").is_null()
                            ? fmt::format("{:#010x}", each.at("address").get<uint32_t>())
                            : each.at("name").get<std::string>(),
                        each.at("one").dump(), each.at("other").dump());
  if (const auto more = answer.result.at("left_out").get<uint64_t>(); more > 0)
    text += fmt::format("and {} more\n", more);
  return text;
}

std::string RemoteTarget::record(const Words& words) {
  if (words.size() != 2) return "record: give one file, without blanks in its name\n";
  const Answer answer = ask("simulation.record", {{"file", words[1]}});
  return answer.ok() ? fmt::format("{}: {} inputs; simulate it again by capsoc replay {}\n",
                                   words[1], answer.result.at("inputs").get<uint64_t>(), words[1])
                     : answer.sentence + "\n";
}

}  // namespace capsoc::service
