#include "session/checkpoints.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>

#include "base/input_file.h"
#include "base/number.h"
#include "base/printable.h"
#include "base/split.h"
#include "host/console.h"
#include "host/end_signals.h"
#include "host/file_uses.h"
#include "host/files.h"
#include "kit/guest_error.h"
#include "kit/seconds.h"
#include "results/results.h"
#include "session/run_files.h"
#include "session/run_settings.h"

namespace capsoc::run {
namespace {

constexpr const char* gathered_prefix = "gathered.";

const sc_core::sc_time longest_wait(1, sc_core::SC_MS);

std::atomic<bool> save_wanted{false};

void want_save(int) {
  save_wanted = true;
  host::call_for_signal();
}

std::string seconds_of(const sc_core::sc_time& time) {
  return fmt::format("{:.12g}", kit::to_seconds(time));
}

}  // namespace

Result<std::vector<SavePoint>> save_points(const RunSettings& settings) {
  const Setting& setting = settings.checkpoint.save.about();
  std::vector<SavePoint> points;
  for (const std::string& entry : split(setting.value, ',')) {
    const std::size_t at = entry.rfind('@');
    const auto seconds =
        at == std::string::npos ? std::nullopt : finite_number(entry.substr(at + 1));
    constexpr double longest = 1e7;  // the kernel's time ends at 1.8e7 s
    if (at == 0 || !seconds || *seconds < 0 || *seconds > longest)
      return Error{fmt::format("{} {}: write FILE@SECONDS, for instance state.capsoc@1.5",
                               setting.name(), entry)};
    points.push_back({entry.substr(0, at), *seconds});
  }
  for (const SavePoint& point : points)
    if (std::count_if(points.begin(), points.end(),
                      [&](const SavePoint& other) { return other.file == point.file; }) > 1)
      return Error{fmt::format("{} {}: is named twice; give each checkpoint its own file",
                               setting.name(), point.file)};
  std::stable_sort(points.begin(), points.end(),
                   [](const SavePoint& a, const SavePoint& b) { return a.seconds < b.seconds; });
  return points;
}

Result<checkpoint::Identity> identity_of(const RunSettings& settings, const RunInputs& inputs) {
  checkpoint::Identity identity;
  for (const Setting& setting : settings.all())
    if (setting.kind == SettingKind::input && !setting.value.empty() &&
        setting.path.rfind("uart", 0) == 0)
      if (auto error = check_input(setting.value, {"name a file", UINT64_MAX, true})) return *error;
  for (const Input& input : input_files(settings, inputs))
    identity.emplace_back("the file of " + input.role, "SHA-256 " + input.sha256);
  for (const Setting& setting : settings.all()) {
    // What only says where something goes, how fast the host gets there or when it ends may differ.
    if (setting.bearing != Bearing::result || setting.is_path()) continue;
    if (setting.path == settings.firmware.load.about().path) continue;
    // Faults are injected into what continues from a run without them.
    if (setting.path == settings.inject.faults.about().path) continue;
    if (setting.optional && setting.source == SettingSource::built_in) continue;
    identity.emplace_back(setting.path, setting.value);
  }
  return identity;
}

Result<std::optional<checkpoint::Checkpoint>> checkpoint_to_restore(const RunSettings& settings,
                                                                    const RunInputs& inputs) {
  const std::string& file = settings.checkpoint.restore();
  if (file.empty()) return std::optional<checkpoint::Checkpoint>();
  if (settings.golden())
    return Error{
        "--golden needs all samples, and a restored run has the later ones; "
        "leave out one of --golden and --restore"};
  auto read = checkpoint::read(file);
  if (!read) return Error{read.error()};
  const auto here = identity_of(settings, inputs);
  if (!here) return Error{here.error()};
  const checkpoint::Identity& identity = here.value();
  const checkpoint::Identity& saved = read.value().identity;
  const auto value_in = [](const checkpoint::Identity& where, const std::string& name) {
    for (const auto& [key, value] : where)
      if (key == name) return value.empty() ? std::string("nothing") : value;
    return std::string("nothing");
  };
  for (const checkpoint::Identity* side : {&identity, &saved})
    for (const auto& [name, value] : *side)
      if (const std::string was = value_in(saved, name), is = value_in(identity, name); was != is)
        return Error{
            fmt::format("{}: was saved with another {} ({}, here {}); give the same as then", file,
                        printable(name, 80), printable(was, 80), printable(is, 80))};
  const double limit = settings.limits.simulated_s();
  const double begins = kit::to_seconds(sc_core::sc_time::from_value(read.value().time));
  if (limit > 0 && limit <= begins)
    return Error{
        fmt::format("{}: begins at {:g} s, where --simlimit {:g} has ended the run; "
                    "give a later limit",
                    file, begins, limit)};
  return std::optional<checkpoint::Checkpoint>(std::move(read.value()));
}

std::vector<checkpoint::Part> parts_of(soc::Soc& soc) {
  std::vector<checkpoint::Part> parts;
  parts.push_back({"board", [&soc](Archive& archive) { soc.visit(archive); }});
  for (kit::Component* part : soc.components())
    parts.push_back(
        {part->component_name(), [part](Archive& archive) { part->visit_all(archive); }});
  parts.push_back({"guest_errors", kit::visit_guest_errors});
  return parts;
}

bool is_gathered(const std::string& part) {
  return part.rfind(gathered_prefix, 0) == 0;
}

checkpoint::Part gathered_part(const std::string& name,
                               std::function<void(Archive& archive)> visit) {
  return {gathered_prefix + name, std::move(visit)};
}

std::vector<checkpoint::Part> gathered_parts(const Observers& observers) {
  std::vector<checkpoint::Part> parts;
  for (RunObserver* const each : observers.gatherers())
    parts.push_back(gathered_part(each->gathered(),
                                  [each](Archive& archive) { each->visit_gathered(archive); }));
  return parts;
}

Checkpoints::Checkpoints(const RunSettings& settings, const RunInputs& inputs, soc::Soc& soc,
                         std::vector<checkpoint::Part> parts,
                         std::vector<checkpoint::Part> gathered)
    : settings_(settings),
      inputs_(inputs),
      soc_(soc),
      parts_(std::move(parts)),
      gathered_(std::move(gathered)) {}

std::optional<Error> Checkpoints::plan() {
  auto points = save_points(settings_);
  if (!points) return Error{points.error()};
  points_ = std::move(points.value());
  if (const double every = settings_.checkpoint.every_s(); every > 0) {
    every_ = sc_core::sc_time(every, sc_core::SC_SEC);
    if (every_ < longest_wait)
      return Error{"--save-every: give at least 0.001 s from one checkpoint to the next"};
    plan_regular(sc_core::SC_ZERO_TIME);
  }
  if (!points_.empty() || every_ != sc_core::SC_ZERO_TIME)
    if (const auto& known = identity(); !known) return Error{known.error()};
  struct sigaction action {};
  action.sa_handler = want_save;
  action.sa_flags = SA_RESTART;
  sigaction(SIGUSR1, &action, nullptr);
  return std::nullopt;
}

const Result<checkpoint::Identity>& Checkpoints::identity() {
  if (!identity_) identity_ = identity_of(settings_, inputs_);
  return *identity_;
}

void Checkpoints::look_for_signal() {
  if (!save_wanted) return;
  save_wanted = false;
  signalled_ = true;
  soc_.cpu.pause_now();
}

sc_core::sc_time Checkpoints::next() const {
  if (signalled_) return sc_core::SC_ZERO_TIME;
  sc_core::sc_time soonest = next_regular_;
  if (next_point_ < points_.size())
    soonest = std::min(soonest, sc_core::sc_time(points_[next_point_].seconds, sc_core::SC_SEC));
  return soonest;
}

std::string Checkpoints::automatic_name(const sc_core::sc_time& now) const {
  return settings_.checkpoint.prefix() + seconds_of(now) + ".capsoc";
}

sc_core::sc_time Checkpoints::pause(const sc_core::sc_time& now) {
  if (const auto quiet = soc_.coprocessor.quiet_at(); quiet && next() <= now) {
    if (waits_since_ == sc_core::sc_max_time()) waits_since_ = now;
    if (now - waits_since_ < longest_wait) return *quiet;
  }
  waits_since_ = sc_core::sc_max_time();
  while (next_point_ < points_.size()) {
    const sc_core::sc_time wanted(points_[next_point_].seconds, sc_core::SC_SEC);
    if (wanted > now) break;
    save(points_[next_point_++].file, wanted, nullptr);
  }
  if (next_regular_ <= now) {
    save(automatic_name(next_regular_), next_regular_, "--save-every");
    plan_regular(now);
  }
  if (std::exchange(signalled_, false)) {
    const std::string file = automatic_name(now);
    if (save(file, now, "SIGUSR1")) host::say("capsoc: {}: saved\n", file);
  }
  return next();
}

bool Checkpoints::save(const std::string& file, const sc_core::sc_time& wanted, const char* by) {
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  if (now - wanted > sc_core::sc_time(1, sc_core::SC_US))
    host::say(
        "capsoc: {}: saved at {} s, when the processor and the coprocessor had come to an "
        "end\n",
        file, seconds_of(now));
  const auto error = by != nullptr ? save_beside(file, by) : save_now(file);
  if (error) failures_.push_back(error->text);
  return !error;
}

std::optional<Error> Checkpoints::save_beside(const std::string& file, const char* by) {
  std::vector<host::FileUse> uses = files_of(settings_);
  uses.push_back({host::FileUse::Kind::output, by, file});
  if (auto error = host::check_uses(uses)) return error;
  return save_now(file);
}

Result<std::string> Checkpoints::packed(bool with_gathered) {
  std::vector<checkpoint::Part> parts = parts_;
  if (with_gathered) parts.insert(parts.end(), gathered_.begin(), gathered_.end());
  auto saved = checkpoint::save(sc_core::sc_time_stamp().value(), parts);
  if (!saved) return Error{fmt::format("not saved: {}", saved.error())};
  const auto& known = identity();
  if (!known) return Error{known.error()};
  saved.value().identity = known.value();
  return checkpoint::pack(saved.value());
}

std::optional<Error> Checkpoints::save_now(const std::string& file) {
  const auto begin = std::chrono::steady_clock::now();
  const auto bytes = packed(false);
  if (!bytes) return Error{fmt::format("{}: {}", file, bytes.error())};
  auto error = host::write_whole(file, bytes.value());
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begin;
  if (!error) spdlog::info("{}: {} bytes in {:.1f} ms", file, bytes.value().size(), taken.count());
  return error;
}

std::optional<Error> Checkpoints::load(const checkpoint::Checkpoint& from) {
  std::vector<checkpoint::Part> parts = parts_;
  // Of a state in memory: an observer that is not here leaves its own.
  for (std::size_t i = parts_.size(); i < from.sections.size(); ++i) {
    const std::string& name = from.sections[i].name;
    if (!is_gathered(name)) break;
    const auto known =
        std::find_if(gathered_.begin(), gathered_.end(),
                     [&](const checkpoint::Part& part) { return part.name == name; });
    parts.push_back(known == gathered_.end() ? checkpoint::Part{name, nullptr} : *known);
  }
  if (auto error = checkpoint::load(from, parts))
    return Error{fmt::format("{}: {}", settings_.checkpoint.restore(), error->text)};
  return std::nullopt;
}

void Checkpoints::restored() {
  for (kit::Component* part : soc_.components()) part->restored();
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  while (next_point_ < points_.size() && points_[next_point_].seconds < kit::to_seconds(now))
    failures_.push_back(fmt::format("{}: not saved: the run resumes from a later time",
                                    points_[next_point_++].file));
  plan_regular(now);
}

void Checkpoints::plan_regular(const sc_core::sc_time& now) {
  if (every_ == sc_core::SC_ZERO_TIME) return;
  const uint64_t done = now.value() / every_.value();
  next_regular_ = sc_core::sc_time::from_value((done + 1) * every_.value());
}

std::vector<std::string> Checkpoints::failures() const {
  std::vector<std::string> sentences = failures_;
  for (std::size_t i = next_point_; i < points_.size(); ++i)
    sentences.push_back(fmt::format("{}: not saved: the run ended at {} s, before {:g} s",
                                    points_[i].file, seconds_of(sc_core::sc_time_stamp()),
                                    points_[i].seconds));
  return sentences;
}

}  // namespace capsoc::run
