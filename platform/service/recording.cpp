#include "service/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/input_file.h"
#include "base/printable.h"
#include "checkpoint/checkpoint_file.h"
#include "host/files.h"
#include "host/sha256.h"
#include "host/temporary_folder.h"
#include "sensor/load.h"
#include "service/advance.h"
#include "service/board_verbs.h"
#include "session/checkpoints.h"
#include "version/version.h"

namespace capsoc::service {
namespace {

constexpr double picoseconds = 1e12;

std::string seconds_of(const Position& at) {
  return fmt::format("{:.12g} s", static_cast<double>(at.time_ps) / picoseconds);
}

/// The hash of each part of a packed state, without what observers have gathered: those of a replay
/// are others.
Result<std::map<std::string, std::string>> parts_of(const std::string& state) {
  const auto checkpoint = checkpoint::unpack(state, "the state");
  if (!checkpoint) return Error{checkpoint.error()};
  std::map<std::string, std::string> parts;
  for (const checkpoint::Section& section : checkpoint.value().sections)
    if (!run::is_gathered(section.name)) parts[section.name] = host::sha256_of(section.bytes);
  return parts;
}

Result<std::map<std::string, std::string>> parts_now(Board& board) {
  const auto state = board.simulation().packed_state();
  if (!state) return Error{state.error()};
  return parts_of(state.value());
}

SessionFile::Text uart_text(Board& board, std::size_t uart) {
  const serial::SerialLine& line = board.simulation().ports().uarts().line(uart);
  return {line.bytes(), line.sha256()};
}

/// Whether a setting decides what is simulated, and is no place that a replay would write to.
bool is_recorded(const run::RunSettings& settings, const Setting& setting) {
  // The session's own stream; that of the ITM enables its port.
  if (setting.path == settings.itm.backend.about().path) return setting.value == "stdout";
  // Whether reads of the console wait.
  if (setting.path == settings.semihosting.console.about().path) return setting.value == "stdio";
  if (setting.is_path() || setting.kind == SettingKind::backend) return false;
  if (setting.path == settings.firmware.load.about().path) return false;
  const std::string ends[] = {settings.coprocessor.backend.about().path,
                              settings.limits.simulated_s.about().path,
                              settings.uarts.until.about().path, settings.uarts.fail.about().path};
  return setting.bearing == Bearing::result ||
         std::find(std::begin(ends), std::end(ends), setting.path) != std::end(ends);
}

/// Whether a setting names a file that is recorded by content. A library is not: replaying a
/// session from another user would execute its code.
bool is_recorded_file(const run::RunSettings& settings, const Setting& setting) {
  return setting.kind == SettingKind::input &&
         setting.path != settings.coprocessor.rtl_library.about().path &&
         setting.path != settings.checkpoint.restore.about().path &&
         setting.path != settings.firmware.load.about().path;
}

/// Also of the sensor that is built in.
Result<std::string> content_of(const std::string& input) {
  if (const auto own = sensor::built_in(input)) return std::string(*own);
  return read_input(input, {"it is recorded with the session", SessionFile::largest, true});
}

std::optional<Error> record_settings(Board& board, SessionFile& session) {
  const run::RunSettings& settings = board.settings();
  for (const TextField* each : {&settings.firmware.load, &settings.checkpoint.restore})
    if (!each->empty())
      return Error{each->about().path + " is not recorded; construct the simulation without it"};
  for (const Setting& setting : settings.all()) {
    if (setting.value.empty()) continue;
    if (setting.kind == SettingKind::backend && setting.value.rfind("script:", 0) == 0)
      return Error{setting.path + ": a script is not recorded; send what it does as requests"};
    if (is_recorded_file(settings, setting)) {
      auto bytes = content_of(setting.value);
      if (!bytes) return Error{bytes.error()};
      const std::string name = std::filesystem::path(setting.value).filename().string();
      session.files.push_back({setting.path, name, std::move(bytes.value())});
    } else if (setting.source != SettingSource::built_in && is_recorded(settings, setting)) {
      session.settings[setting.path] = setting.value;
    }
  }
  return std::nullopt;
}

/// The last one that is so long back, otherwise the beginning.
const History::Snapshot& first_snapshot(const History& history, const Position& now,
                                        std::optional<double> last_s) {
  const History::Snapshot* first = &history.snapshots().front();
  if (!last_s) return *first;
  const double latest_ps = static_cast<double>(now.time_ps) - *last_s * picoseconds;
  for (const History::Snapshot& snapshot : history.snapshots())
    if (static_cast<double>(snapshot.at.time_ps) <= latest_ps) first = &snapshot;
  return *first;
}

/// Without the newest sample, whose bytes only the program that wrote them may believe.
std::string state_to_record(const std::string& bytes) {
  if (bytes.empty()) return "";
  Board::Snapshot snapshot = Board::Snapshot::of(bytes);
  snapshot.held.erase("newest");
  return snapshot.to_bytes();
}

/// Settings and files of a session that no recording has: it would write, or load code.
std::optional<Error> complain(const SessionFile& session) {
  run::RunSettings known;
  for (const TextField* stream : {&known.itm.backend, &known.semihosting.console}) {
    const std::string path = stream->about().path;
    if (const auto found = session.settings.find(path); found != session.settings.end())
      if (auto error = known.set(path, found->second, SettingSource::command_line, "settings"))
        return error;
  }
  for (const Setting& setting : known.all()) {
    const bool is_value = session.settings.count(setting.path) != 0;
    const bool is_file =
        std::any_of(session.files.begin(), session.files.end(),
                    [&](const auto& content) { return content.setting == setting.path; });
    if ((is_value && !is_recorded(known, setting)) ||
        (is_file && !is_recorded_file(known, setting)))
      return Error{fmt::format("the session sets {}, which no recorded one does", setting.path)};
  }
  return std::nullopt;
}

/// The path of a file with this content in a folder.
Result<std::string> add(const host::TemporaryFolder& folder, std::size_t number,
                        const SessionFile::Content& content) {
  std::error_code failure;
  const std::filesystem::path place = std::filesystem::path(folder.path()) / std::to_string(number);
  if (!std::filesystem::create_directory(place, failure))
    return Error{fmt::format("{}: {}", place.string(), failure.message())};
  std::string file = (place / content.name).string();
  if (auto error = host::write_whole(file, content.bytes)) return *error;
  return file;
}

/// Why the inputs of a file are none.
std::optional<Error> complain(const std::vector<Input>& inputs) {
  for (const Input& input : inputs) {
    const BoardVerb* const verb = board_verb(input.method);
    if (verb == nullptr || verb->effect != Effect::input)
      return Error{
          fmt::format("the session has an input '{}', which this program does not know; "
                      "replay it with the program that recorded it",
                      printable(input.method, 80))};
    const Call call(verb->about, input.parameters, input.frames);
    if (std::string why = call.complaint(); !why.empty()) return Error{"the session: " + why};
  }
  return std::nullopt;
}

class Replay {
 public:
  Replay(const SessionFile& session, Board& board,
         const std::function<void(const std::string& text)>& on_text)
      : session_(session), board_(board), on_text_(on_text) {}

  std::optional<Error> run(std::optional<double> until_s) {
    Position last;
    for (const SessionFile::Mark& mark : session_.marks) {
      const bool is_beyond =
          until_s && static_cast<double>(mark.at.time_ps) > std::round(*until_s * picoseconds);
      if (is_beyond) {
        const Target target{Unit::time,
                            static_cast<uint64_t>(std::llround(*until_s * picoseconds))};
        return go([&](Advance& advance) { return advance.go(target); });
      }
      if (auto error = go([&](Advance& advance) { return advance.go(mark.at); })) return error;
      if (!replayed_.difference.empty()) return std::nullopt;
      if (auto error = compare(mark, last)) return error;
      if (!replayed_.difference.empty()) return std::nullopt;
      last = mark.at;
    }
    compare_texts();
    return std::nullopt;
  }

  Replayed take() {
    replayed_.inputs = board_.history().passed();
    replayed_.end_s = static_cast<double>(board_.position().time_ps) / picoseconds;
    return std::move(replayed_);
  }

 private:
  template <typename Go>
  std::optional<Error> go(Go go_there) {
    Advance advance(board_);
    if (const auto error = go_there(advance))
      replayed_.difference =
          fmt::format("differs before {}: {}", seconds_of(board_.position()), error->text);
    uint64_t lost = 0;
    on_text_(board_.uart(0).take(lost));
    return std::nullopt;
  }

  std::optional<Error> compare(const SessionFile::Mark& mark, const Position& last) {
    if (!(board_.position() == mark.at)) {
      replayed_.difference = fmt::format("ends at {}, the recorded session at {} or later",
                                         seconds_of(board_.position()), seconds_of(mark.at));
      return std::nullopt;
    }
    if (mark.parts.empty()) return std::nullopt;
    const auto now = parts_now(board_);
    if (!now) return Error{now.error()};
    ++replayed_.marks;
    std::string differ;
    for (const auto& [name, hash] : mark.parts) {
      const auto found = now.value().find(name);
      if (found == now.value().end() || found->second != hash)
        differ += (differ.empty() ? "" : ", ") + printable(name, 80);
    }
    if (!differ.empty())
      replayed_.difference = fmt::format("differs between {} and {}: in {}", seconds_of(last),
                                         seconds_of(mark.at), differ);
    return std::nullopt;
  }

  void compare_texts() {
    for (std::size_t n = 0; n < std::min(session_.uarts.size(), soc::Soc::uart_count); ++n) {
      const SessionFile::Text now = uart_text(board_, n), &then = session_.uarts[n];
      if (now.bytes == then.bytes && now.sha256 == then.sha256) continue;
      replayed_.difference = fmt::format(
          "differs at its end: uart{} sent {} bytes (SHA-256 {}), in "
          "the recorded session {} ({})",
          n, now.bytes, now.sha256, then.bytes, then.sha256);
      return;
    }
  }

  const SessionFile& session_;
  Board& board_;
  const std::function<void(const std::string& text)>& on_text_;
  Replayed replayed_;
};

}  // namespace

Result<SessionFile> record(Board& board, std::optional<double> last_s) {
  const History& history = board.history();
  if (!history.is_on()) return Error{"there is no history: " + board.no_history()};
  SessionFile session;
  session.written_by = fmt::format("{} ({})", version(), commit());
  if (auto error = record_settings(board, session)) return *error;
  const Position now = board.position();
  const History::Snapshot& begin = first_snapshot(history, now, last_s);
  session.state = state_to_record(begin.bytes);
  session.begin_ps = begin.at.time_ps;
  const auto& inputs = history.inputs();
  for (auto input = inputs.begin() + history.kept_before(begin); input != inputs.end(); ++input)
    if ((*input)->at <= now) session.inputs.push_back(**input);
  for (const History::Snapshot& snapshot : history.snapshots()) {
    if (snapshot.at <= begin.at || snapshot.bytes.empty() || now <= snapshot.at) continue;
    const Board::Snapshot state = Board::Snapshot::of(snapshot.bytes);
    // A snapshot may be from before the inputs of its instant; a replay stops after them.
    if (std::any_of(session.inputs.begin(), session.inputs.end(),
                    [&](const Input& input) { return input.at == snapshot.at; }))
      continue;
    auto parts = parts_of(state.frames.at(0));
    if (!parts) return Error{parts.error()};
    session.marks.push_back({snapshot.at, std::move(parts.value())});
  }
  // A run that is over has no state any more; its position and its texts are compared.
  SessionFile::Mark end{now, {}};
  if (!board.simulation().is_over()) {
    auto parts = parts_now(board);
    if (!parts) return Error{parts.error()};
    end.parts = std::move(parts.value());
  }
  session.marks.push_back(std::move(end));
  for (std::size_t n = 0; n < soc::Soc::uart_count; ++n)
    session.uarts.push_back(uart_text(board, n));
  return session;
}

Result<Repetition> lay_out(const SessionFile& session) {
  if (auto error = complain(session)) return *error;
  if (auto error = complain(session.inputs)) return *error;
  auto folder = host::TemporaryFolder::make("replay");
  if (!folder) return Error{folder.error()};
  Repetition laid{std::make_shared<host::TemporaryFolder>(std::move(folder.value()))};
  for (const auto& [name, value] : session.settings) laid.settings[name] = value;
  for (std::size_t n = 0; n < session.files.size(); ++n) {
    auto file = add(*laid.folder, n, session.files[n]);
    if (!file) return Error{file.error()};
    laid.settings[session.files[n].setting] = std::move(file.value());
  }
  laid.state = session.state;
  laid.inputs = session.inputs;
  if (!session.marks.empty()) laid.end = session.marks.back().at;
  return laid;
}

Result<SessionFile> read_session(const std::string& file) {
  const InputLimits limits{"name a file that simulation.record wrote", SessionFile::largest, false};
  const auto bytes = read_input(file, limits);
  if (!bytes) return Error{bytes.error()};
  return unpack_session(bytes.value(), file);
}

Result<std::unique_ptr<Board>> construct(const Repetition& laid, const std::string& writes_in) {
  const Error damaged{
      "the session begins in a state that is none; replay it with the program that recorded it"};
  const Board::Snapshot begin = Board::Snapshot::of(laid.state);
  if (!laid.state.empty() && begin.frames.empty()) return damaged;
  try {
    return Board::construct(laid.settings, begin, writes_in);
  } catch (const Json::exception&) {
    return damaged;
  } catch (const std::out_of_range&) {
    return damaged;
  }
}

Result<Replayed> replay(const SessionFile& session, std::optional<double> until_s,
                        const PartTraceSettings& wanted,
                        const std::function<void(const std::string& text)>& on_text) {
  // As long as the simulation: sensor.set reads the sensor's file again.
  const auto laid = lay_out(session);
  if (!laid) return Error{laid.error()};
  auto constructed = construct(laid.value());
  if (!constructed) return Error{constructed.error()};
  Board& board = *constructed.value();
  board.history().expect(session.inputs, laid.value().end);
  std::unique_ptr<PartTraces> traces;
  if (wanted.any()) {
    auto begun = PartTraces::begin(board, wanted);
    if (!begun) return Error{begun.error()};
    traces = std::move(begun.value());
  }
  Replay again(session, board, on_text);
  if (auto error = again.run(until_s)) return *error;
  Replayed replayed = again.take();
  if (traces != nullptr) replayed.lost = traces->end().lost;
  return replayed;
}

}  // namespace capsoc::service
