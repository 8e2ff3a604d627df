#include "service/board.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <utility>

#include "base/nearest.h"
#include "base/printable.h"
#include "kit/seconds.h"
#include "metrics/program_verdict.h"
#include "results/results.h"
#include "service/ticker.h"
#include "service/value.h"
#include "session/run_files.h"

namespace capsoc::service {
namespace {

constexpr const char* origin = "settings";

std::vector<double> column(const std::deque<std::pair<double, double>>& pairs,
                           double std::pair<double, double>::*member) {
  std::vector<double> values;
  values.reserve(pairs.size());
  for (const auto& pair : pairs) values.push_back(pair.*member);
  return values;
}

}  // namespace

std::optional<std::string> setting_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean() || value.is_number()) return value.dump();
  return std::nullopt;
}

Result<unsigned> processor_register(debug::Target& target, const std::string& name) {
  std::vector<std::string> names;
  for (unsigned i = 0; i < debug::registers.size(); ++i) {
    if (!target.has_register(i)) continue;
    names.emplace_back(debug::registers[i].name);
    if (names.back() == name) return i;
  }
  return Error{fmt::format("the processor has no register '{}'; did you mean {}?",
                           printable(name, 80), nearest_names(printable(name, 80), names))};
}

Result<std::unique_ptr<Board>> Board::construct(const Json& settings, const Snapshot& from,
                                                const std::string& writes_in) {
  std::unique_ptr<Board> board(new Board);
  board->writes_in_ = writes_in;
  if (auto error = board->set(settings)) return *error;
  if (auto error = board->make(from, false)) return *error;
  if (auto error = board->start(from)) return *error;
  return board;
}

Result<std::unique_ptr<Board>> Board::prepare(const Json& settings, const std::string& writes_in) {
  std::unique_ptr<Board> board(new Board);
  board->writes_in_ = writes_in;
  if (auto error = board->set(settings)) return *error;
  if (auto error = board->make({}, true)) return *error;
  return board;
}

std::optional<Error> Board::set_state(const Snapshot& from) {
  return simulation_->set_state(from.state());
}

std::optional<Error> Board::begin(const Snapshot& from) {
  if (auto error = simulation_->begin()) return error;
  return start(from);
}

std::optional<Error> Board::make(const Snapshot& from, bool waits) {
  if (auto error = check_files({})) return error;
  const auto lay_over = [this](run::RunInputs& inputs) {
    const run::SensorSettings& sensor = settings_.sensor;
    auto port = std::make_unique<SensorPort>(std::move(inputs.source), inputs.sensor_file,
                                             sensor.keys(), sensor.recording().value());
    sensor_ = port.get();
    inputs.source = std::move(port);
  };
  auto simulation = run::Simulation::construct(settings_, {lay_over, from.state(), &kept_, waits});
  if (!simulation) return Error{simulation.error()};
  simulation_ = std::move(simulation.value());
  attach();
  return std::nullopt;
}

/// To its first instant: out of reset, or out of the state that it continues from.
std::optional<Error> Board::start(const Snapshot& from) {
  const auto begun = simulation_->advance_to(sc_core::SC_ZERO_TIME);
  if (!begun) return Error{begun.error()};
  return take_over(from);
}

Board::Board() : history_budget_(std::size_t{history_mb} << 20U) {}

Board::~Board() = default;

std::optional<Error> Board::set(const Json& settings) {
  // Standard output belongs to the session.
  const std::string console = settings_.uarts.lines[0].backend.about().path;
  if (auto error = settings_.set(console, "null", SettingSource::file, "built-in")) return error;
  for (const auto& [name, value] : settings.items()) {
    if (name == "history_mb") {
      if (!value.is_number_unsigned() || value.get<uint64_t>() > most_history_mb)
        return Error{fmt::format("settings: 'history_mb' has to be a whole number from 0 to {}",
                                 most_history_mb)};
      history_budget_ = value.get<std::size_t>() << 20U;
      continue;
    }
    const std::optional<std::string> text = setting_text(value);
    if (!text)
      return Error{fmt::format("settings: '{}' has to be a text, a number, true or false",
                               printable(name, 80))};
    if (auto error = settings_.set(name, *text, SettingSource::command_line, origin)) return error;
  }
  for (const TextField* file :
       {&settings_.results.json, &settings_.results.html, &settings_.results.session})
    if (!file->empty())
      return Error{
          fmt::format("{}: a session writes no result files; simulation.finish answers with "
                      "the result",
                      file->about().path)};
  for (const run::UartSettings::Line& line : settings_.uarts.lines)
    if (line.backend() == "stdout" || line.backend() == "stdio")
      return Error{
          fmt::format("{}: {}: standard output belongs to the session; read the UART with "
                      "uart.read",
                      line.backend.about().path, line.backend())};
  return std::nullopt;
}

std::optional<Error> Board::check_files(const std::vector<host::FileUse>& more) const {
  std::vector<host::FileUse> uses = run::files_of(settings_);
  uses.insert(uses.end(), more.begin(), more.end());
  if (auto error = host::check_uses(uses)) return error;
  if (writes_in_.empty()) return std::nullopt;
  for (const Setting& setting : settings_.all())
    if (setting.kind == SettingKind::directory)
      uses.push_back({host::FileUse::Kind::output, setting.name(), setting.value});
  const TextField& prefix = settings_.checkpoint.prefix;
  if (settings_.checkpoint.every_s() > 0 || prefix.about().source != SettingSource::built_in)
    uses.push_back({host::FileUse::Kind::output, prefix.about().path, prefix()});
  if (auto error = host::check_within(uses, writes_in_)) return error;
  const TextField& library = settings_.coprocessor.rtl_library;
  if (library.empty()) return std::nullopt;
  return Error{
      fmt::format("{}: clients of this session may name no library, which is code; "
                  "start it by capsoc run, or by a session on standard input",
                  library.about().path)};
}

void Board::attach() {
  if (settings_.semihosting.console() == "stdio")
    kept_.console.ask_by([this] { simulation_->stop_soon(); });
  simulation_->expect_inputs();
  target_ = std::make_unique<debug::SocTarget>(soc());
  variables_ = std::make_unique<source::Variables>(simulation_->view().program().images());
  registers_ = std::make_unique<soc::RegisterIndex>(soc());
  events_.attach(soc());
  activity_.attach(soc());
  events_.read_verdicts_by([this] { return verdict(); });
  soc().clock.on_change([this] {
    activity_.clock_changed();
    if (on_clock_change) on_clock_change();
  });
  for (std::size_t n = 0; n < uarts_.size(); ++n)
    uarts_[n].attach(*soc().uarts()[n],
                     [this, n] { return simulation_->ports().next_uart_input(n); });
  listening_ =
      simulation_->observation().samples.listen([this](const metrics::RecordedSample& sample) {
        if (samples_.size() == most_samples) {
          samples_.pop_front();
          ++first_sample_;
        }
        events_.sample(sample_count(), sample);
        events_.look_for_verdict();
        samples_.push_back(sample);
      });
}

/// That of the program's object `program_verdict`.
Json Board::verdict() {
  const auto images = simulation_->view().program().images();
  if (images.empty()) return nullptr;
  static const metrics::Metrics unknown(std::nullopt, 1);
  const auto read = [this](uint32_t address, void* bytes, uint32_t size) {
    return soc().read_memory(address, bytes, size);
  };
  const auto stated = metrics::read_verdict(*images.front(), read, unknown);
  if (!stated) return nullptr;
  Json verdict = {{"pass", stated->pass}};
  if (stated->pass)
    verdict["bound_deg"] = stated->bound_deg;
  else
    verdict["reason"] = stated->reason;
  return verdict;
}

std::optional<uint32_t> Board::read_word(uint32_t address) {
  const std::string bytes = target_->read_memory(address, 4);
  if (bytes.size() < 4) return std::nullopt;
  uint32_t word = 0;
  for (std::size_t i = 4; i-- > 0;) word = word << 8U | static_cast<uint8_t>(bytes[i]);
  return word;
}

Result<double> Board::number_of(const std::string& name) {
  if (name.front() == '$') {
    const auto index = processor_register(*target_, name.substr(1));
    if (!index) return Error{index.error()};
    return static_cast<double>(target_->read_register(index.value()));
  }
  if (!registers_->has_peripheral(name.substr(0, name.find('.')))) return number_of_variable(name);
  const auto place = registers_->find(name);
  if (!place) return Error{place.error()};
  const auto word = read_word(place.value().reg->address);
  if (!word) return Error{fmt::format("{} cannot be read", name)};
  const soc::RegisterField* const field = place.value().field;
  return static_cast<double>(field != nullptr ? soc::value_in(*field, *word) : *word);
}

Result<double> Board::number_of_variable(const std::string& name) {
  const auto variable = variables_->find(name, pointers());
  if (!variable) return Error{variable.error()};
  const source::Variable& found = variable.value();
  const std::string bytes = target_->read_memory(found.address, std::max(8U, found.type->size));
  const Json value = value_of(found, bytes);
  if (value.is_number()) return value.get<double>();
  for (const auto& [enumerator, number] : found.type->enumerators)
    if (value.is_string() && value == Json(enumerator)) return static_cast<double>(number);
  if (value.is_boolean()) return value.get<bool>() ? 1.0 : 0.0;
  return Error{fmt::format("{} is {}, which is no number", printable(name, 80), found.type->name)};
}

std::vector<std::pair<std::string, serial::KeptStream*>> Board::outputs() {
  std::vector<std::pair<std::string, serial::KeptStream*>> all = {{"itm", &kept_.itm},
                                                                  {"console", &kept_.console}};
  for (std::size_t n = 0; n < uarts_.size(); ++n)
    all.emplace_back(fmt::format("uart{}", n), &uarts_[n].output());
  return all;
}

Result<Board::Snapshot> Board::snapshot(bool unread) {
  for (const Setting& setting : settings_.all())
    if (setting.kind == SettingKind::output && !setting.value.empty())
      return Error{
          fmt::format("{} names a file that a simulation restored from here would write, too; "
                      "construct the simulation without it",
                      setting.path)};
  auto state = simulation_->packed_state(true);
  if (!state) return Error{state.error()};
  Answer held;
  held.frames.push_back(std::move(state.value()));
  Json sensor = Json::object();
  Json& sent = held.result["outputs"] = Json::object();
  for (const auto& [name, output] : outputs()) {
    Json each = {{"sent", output->sent()}};
    held.add_bytes(each, "said", unread ? output->said() : "");
    sent[name] = std::move(each);
  }
  Json& waiting = held.result["waiting"] = Json::array();
  for (const UartTap& uart : uarts_) {
    Json each;
    held.add_bytes(each, "bytes", uart.waiting());
    waiting.push_back(std::move(each));
  }
  held.add_bytes("console", kept_.console.given());
  held.result["console_ended"] = kept_.console.has_ended();
  for (const sensor::KeyValue& key : sensor_->changed()) sensor[key.name] = key.value;
  using Pair = std::pair<double, double>;
  held.add_array("u", column(sensor_->injected(), &Pair::first));
  held.add_array("v", column(sensor_->injected(), &Pair::second));
  held.result["sensor"] = std::move(sensor);
  const SensorPort::Course& course = sensor_->course();
  held.result["course"] = {course.factor, course.from_s, course.described_s, course.newest_s};
  held.result["samples"] = sample_count();
  held.result["bkpt"] = stands_at_bkpt();
  held.result["debugged"] = soc().cpu.core().debugging().halting();
  static_assert(std::is_trivially_copyable_v<metrics::RecordedSample>);
  if (!unread && !samples_.empty())
    held.add_bytes("newest", {reinterpret_cast<const char*>(&samples_.back()),
                              sizeof(metrics::RecordedSample)});
  return Snapshot{std::move(held.result), std::move(held.frames)};
}

std::string Board::beside_the_checkpoint() const {
  for (std::size_t n = 0; n < uarts_.size(); ++n)
    if (const std::size_t bytes = uarts_[n].waiting().size(); bytes > 0)
      return fmt::format("uart{} has {} bytes that the program has not received", n, bytes);
  if (const std::size_t bytes = kept_.console.given().size(); bytes > 0)
    return fmt::format("{} bytes for the console are not read yet", bytes);
  if (kept_.console.has_ended()) return "the console's input is at its end";
  if (!sensor_->changed().empty() || sensor_->speed() != 1 || sensor_->course().from_s != 0)
    return "the sensor was changed on the way";
  if (!sensor_->injected().empty())
    return fmt::format("{} injected samples are not taken yet", sensor_->injected().size());
  return "";
}

std::optional<Error> Board::take_over(const Snapshot& from) {
  if (from.frames.empty()) return std::nullopt;
  const Json& held = from.held;
  for (std::size_t n = 0; n < uarts_.size(); ++n)
    uarts_[n].send(bytes_in(held.at("waiting").at(n).at("bytes"), from.frames));
  kept_.console.give(bytes_in(held.at("console"), from.frames));
  if (held.at("console_ended").get<bool>()) kept_.console.end_input();
  for (const auto& [name, output] : outputs()) {
    const Json& each = held.at("outputs").at(name);
    output->go_on_from(each.at("sent").get<uint64_t>(), bytes_in(each.at("said"), from.frames));
  }
  std::vector<sensor::KeyValue> keys;
  for (const auto& [name, value] : held.at("sensor").items())
    keys.push_back({name, value.get<std::string>(), name});
  sensor_->inject(numbers_in(held.at("u"), from.frames), numbers_in(held.at("v"), from.frames));
  const auto course = held.at("course").get<std::vector<double>>();
  sensor_->set_course({course.at(0), course.at(1), course.at(2), course.at(3)});
  first_sample_ = held.at("samples").get<uint64_t>();
  if (held.at("bkpt").get<bool>()) stood_at_bkpt();
  soc().cpu.core().debugging().set_halting(held.at("debugged").get<bool>());
  soc().cpu.core().debugging().set_halted(held.at("debugged").get<bool>());
  if (const auto newest = held.find("newest"); newest != held.end()) {
    metrics::RecordedSample sample;
    std::memcpy(&sample, bytes_in(*newest, from.frames).data(), sizeof sample);
    samples_.push_front(sample);
    --first_sample_;
  }
  return keys.empty() ? std::nullopt : sensor_->change(keys);
}

Json Board::state() {
  const armv7m::Core& core = soc().cpu.core();
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  return {{"time_s", kit::to_seconds(now)}, {"time_ps", now.value()},
          {"cycles", core.cycles()},        {"instructions", core.instructions()},
          {"samples", sample_count()},      {"pc", core.reg(15)},
          {"asleep", core.sleeping()},      {"over", is_finished() || simulation_->is_over()}};
}

Json Board::finish() {
  if (result_) return *result_;
  const run::RunResult result = simulation_->finish();
  Json reports = Json::array();
  for (const std::string* text : {&result.divergence, &result.fault_report, &result.place_report})
    if (!text->empty()) reports.push_back(*text);
  result_ = {{"code", result.code},
             {"reason", result.reason},
             {"reports", std::move(reports)},
             {"lost", result.lost},
             {"table", run::to_table(result)},
             {"result", run::to_json(result, settings_)}};
  return *result_;
}

Result<uint32_t> Board::address(const Json& place) const {
  if (place.is_number()) return place.get<uint32_t>();
  const auto name = place.get<std::string>();
  if (const auto found = simulation_->view().program().address_of(name)) return *found;
  return Error{fmt::format("there is no symbol '{}' in the program", printable(name, 80))};
}

}  // namespace capsoc::service
