#include "campaign/store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

namespace capsoc::campaign {
namespace {

constexpr int64_t application = 0x63617073;  // "caps", in the file's head
constexpr int64_t store_version = 1;

/// Written before the first row and read by all processes; has the name of each column.
constexpr const char* schema = R"(
  CREATE TABLE about(name TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
  CREATE TABLE plan(number INTEGER PRIMARY KEY, key TEXT NOT NULL, axes TEXT NOT NULL);
  CREATE TABLE runs(key TEXT PRIMARY KEY, ending TEXT NOT NULL, command TEXT NOT NULL,
                    result TEXT, log TEXT NOT NULL, wall_s REAL NOT NULL);
)";

/// A list of texts as JSON; nothing for what is none.
std::optional<std::vector<std::string>> texts_of(const std::string& text) {
  const nlohmann::json list = nlohmann::json::parse(text, nullptr, false);
  if (!list.is_array()) return std::nullopt;
  std::vector<std::string> texts;
  for (const nlohmann::json& each : list) {
    if (!each.is_string()) return std::nullopt;
    texts.push_back(each.get<std::string>());
  }
  return texts;
}

std::string text_of(const std::vector<std::string>& texts) {
  return nlohmann::json(texts).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Error damaged(const std::string& path) {
  return Error{fmt::format(
      "{}: the store is damaged: put a copy in its place, or move it away and run again", path)};
}

}  // namespace

Result<std::unique_ptr<Store>> Store::open(const std::string& path) {
  return open(path, Database::Mode::create);
}

Result<std::unique_ptr<Store>> Store::open_existing(const std::string& path) {
  return open(path, Database::Mode::write);
}

Result<std::unique_ptr<Store>> Store::read(const std::string& path) {
  return open(path, Database::Mode::read);
}

Result<std::unique_ptr<Store>> Store::open(const std::string& path, Database::Mode mode) {
  struct stat status {};
  const bool there = stat(path.c_str(), &status) == 0;
  if (there && !S_ISREG(status.st_mode))
    return Error{path + ": is no regular file; name another one for the store"};
  if (!there && mode != Database::Mode::create)
    return Error{path + ": there is no such store; capsoc campaign run makes one"};
  std::unique_ptr<Store> store(new Store);
  store->path_ = path;
  const bool reads = mode == Database::Mode::read;
  if (auto error = reads ? store->open_to_read() : store->open_to_write(mode)) return *error;
  if (auto error = store->prepare(mode)) return *error;
  return store;
}

std::optional<Error> Store::open_database(const std::string& file, Database::Mode mode) {
  auto database = Database::open(file, mode);
  if (!database) return Error{database.error()};
  database_ = std::move(database.value());
  return std::nullopt;
}

std::optional<Error> Store::open_to_write(Database::Mode mode) {
  lock_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0)
    return Error{
        fmt::format("{}: cannot be written ({}); name another store", path_, std::strerror(errno))};
  // SQLite would take it for another program's lock, and wait.
  if (const std::string reason = why_no_locks(lock_); !reason.empty())
    return Error{fmt::format("{}: its file system has no locks ({}); name a store on another disk",
                             path_, reason)};
  shares_memory_ = shares_memory(lock_);
  if (auto error = open_database(path_, mode)) return error;
  if (auto error = lock()) return Error{path_ + error->text};
  return shares_memory_ ? std::nullopt : leave_wal();
}

/// A store from another disk may be in WAL mode, in which this disk cannot even read it.
std::optional<Error> Store::leave_wal() {
  if (auto error = open_database(path_, Database::Mode::alone)) return error;
  if (auto error = database_->execute("PRAGMA journal_mode = DELETE")) return error;
  return open_database(path_, Database::Mode::write);
}

/// SQLite reads a store in WAL mode only if it can lock it, share memory and make files next to it.
std::optional<Error> Store::open_to_read() {
  std::string no_locks;
  if (const int file = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC); file >= 0) {
    no_locks = why_no_locks(file);
    ::close(file);
  }
  if (no_locks.empty()) {
    if (auto error = open_database(path_, Database::Mode::read)) return error;
    if (database_->number("SELECT count(*) FROM sqlite_master")) return std::nullopt;
    if (!database_->lacks_writing()) return database_->error();
  }
  if (!has_unfinished(path_)) return open_database(path_, Database::Mode::as_is);
  auto copy = StoreCopy::of(path_);
  if (!copy) return Error{copy.error()};
  copy_ = std::move(copy.value());
  return open_database(copy_->path(), Database::Mode::read);
}

Store::~Store() {
  database_.reset();
  if (lock_ >= 0) close(lock_);
}

/// Two campaigns with one store would do every run twice. The range is beyond SQLite's own locks
/// and belongs to the open file, so that it is free when the program ends, however it does.
std::optional<Error> Store::lock() {
  struct flock range {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  range.l_start = off_t{1} << 60;
  range.l_len = 1;
  if (fcntl(lock_, F_OFD_SETLK, &range) == 0) return std::nullopt;
  if (errno == EAGAIN || errno == EACCES)
    return Error{": another campaign writes to this store; wait for it, or name another one"};
  return Error{
      fmt::format(": cannot be locked ({}); name a store on another disk", std::strerror(errno))};
}

std::optional<Error> Store::prepare(Database::Mode mode) {
  const Database& d = *database_;
  const auto tables = d.number("SELECT count(*) FROM sqlite_master");
  if (!tables) return Error{tables.error()};
  const auto id = d.number("PRAGMA application_id");
  const auto version = d.number("PRAGMA user_version");
  if (!id) return Error{id.error()};
  if (!version) return Error{version.error()};
  // A campaign that was killed as it began leaves a file without tables.
  begun_ = tables.value() > 0;
  if (id.value() != application && (begun_ || id.value() != 0))
    return Error{path() + ": is a database of another program; name another file"};
  if (begun_) {
    if (version.value() > store_version)
      return Error{
          fmt::format("{}: is a store of a newer capsoc (version {}, this one knows {}); "
                      "use that one",
                      path(), version.value(), store_version)};
    auto check = d.prepare("PRAGMA quick_check(1)");
    if (!check) return Error{check.error()};
    const auto row = check.value().step();
    if (!row) return Error{row.error()};
    if (!row.value() || check.value().text(0) != "ok") return damaged(path());
  }
  if (mode == Database::Mode::read) return std::nullopt;
  // FULL: a row that was reported is on the disk when the power goes.
  const char* const journal = shares_memory_ ? "WAL" : "DELETE";
  if (auto error =
          d.execute(fmt::format("PRAGMA journal_mode = {}; PRAGMA synchronous = FULL", journal)))
    return error;
  if (begun_) return std::nullopt;
  auto transaction = Transaction::begin(d);
  if (!transaction) return Error{transaction.error()};
  if (auto error = d.execute(fmt::format("{}; PRAGMA application_id = {}; PRAGMA user_version = {}",
                                         schema, application, store_version)))
    return error;
  if (auto error = transaction.value().commit()) return error;
  begun_ = true;
  return std::nullopt;
}

Result<std::optional<StoredPlan>> Store::plan() const {
  if (!begun_) return std::optional<StoredPlan>();
  auto about = database_->prepare("SELECT name, value FROM about");
  if (!about) return Error{about.error()};
  StoredPlan plan;
  bool any = false;
  for (;;) {
    const auto row = about.value().step();
    if (!row) return Error{row.error()};
    if (!row.value()) break;
    any = true;
    const std::string name = about.value().text(0), value = about.value().text(1);
    if (name == "description") plan.description = value;
    if (name == "file") plan.file = value;
    if (name == "version") plan.program.version = value;
    if (name == "program") plan.program.hash = value;
    if (name != "axes") continue;
    const auto axes = texts_of(value);
    if (!axes) return damaged(path());
    plan.axes = *axes;
  }
  if (!any) return std::optional<StoredPlan>();
  const auto runs = database_->number("SELECT count(*) FROM plan");
  if (!runs) return Error{runs.error()};
  plan.runs = static_cast<uint64_t>(runs.value());
  return std::optional(plan);
}

std::optional<Error> Store::set_plan(const Plan& plan) {
  auto transaction = Transaction::begin(*database_);
  if (!transaction) return Error{transaction.error()};
  if (auto error = database_->execute("DELETE FROM about; DELETE FROM plan")) return error;
  auto about = database_->prepare("INSERT INTO about VALUES(?, ?)");
  if (!about) return Error{about.error()};
  const Description& d = plan.description();
  const std::pair<const char*, std::string> values[] = {{"description", d.text},
                                                        {"file", d.file},
                                                        {"version", plan.program().version},
                                                        {"program", plan.program().hash},
                                                        {"axes", text_of(d.axis_paths())}};
  for (const auto& [name, value] : values)
    if (auto error = about.value().bind(1, std::string(name)).bind(2, value).run()) return error;
  auto insert = database_->prepare("INSERT INTO plan VALUES(?, ?, ?)");
  if (!insert) return Error{insert.error()};
  int64_t number = 0;
  for (const PlannedRun& run : plan.runs())
    if (auto error = insert.value()
                         .bind(1, number++)
                         .bind(2, std::string(run.key()))
                         .bind(3, text_of(plan.values(run)))
                         .run())
      return error;
  return transaction.value().commit();
}

Result<std::unordered_set<std::string>> Store::keys() const {
  auto select = database_->prepare("SELECT key FROM runs");
  if (!select) return Error{select.error()};
  std::unordered_set<std::string> keys;
  for (;;) {
    const auto row = select.value().step();
    if (!row) return Error{row.error()};
    if (!row.value()) return keys;
    keys.insert(select.value().text(0));
  }
}

std::optional<Error> Store::add(const std::vector<Row>& rows) {
  if (rows.empty()) return std::nullopt;
  auto transaction = Transaction::begin(*database_);
  if (!transaction) return Error{transaction.error()};
  auto insert = database_->prepare("INSERT INTO runs VALUES(?, ?, ?, ?, ?, ?)");
  if (!insert) return Error{insert.error()};
  for (const Row& row : rows) {
    Statement& s = insert.value();
    s.bind(1, row.key).bind(2, row.ending).bind(3, row.command);
    if (row.result.empty())
      s.bind_null(4);
    else
      s.bind(4, row.result);
    if (auto error = s.bind(5, row.log).bind(6, row.wall_s).run()) return error;
  }
  return transaction.value().commit();
}

std::optional<Error> Store::each_run(
    const std::function<std::optional<Error>(const StoredRun&)>& take) const {
  auto select = database_->prepare(
      "SELECT plan.number, plan.axes, plan.key, ending, command, result, log, wall_s FROM plan "
      "LEFT JOIN runs ON runs.key = plan.key ORDER BY plan.number");
  if (!select) return Error{select.error()};
  const Statement& s = select.value();
  for (;;) {
    const auto row = select.value().step();
    if (!row) return Error{row.error()};
    if (!row.value()) return std::nullopt;
    StoredRun run;
    run.number = static_cast<uint64_t>(s.integer(0));
    const auto values = texts_of(s.text(1));
    if (!values) return damaged(path());
    run.values = *values;
    if (!s.is_null(3))
      run.row = Row{s.text(2), s.text(3), s.text(4), s.text(5), s.text(6), s.number(7)};
    if (auto error = take(run)) return error;
  }
}

std::optional<Error> Store::forget_unfinished() {
  return database_->execute("DELETE FROM runs WHERE result IS NULL");
}

std::optional<Error> Store::take_plan(const Store& other) {
  auto transaction = Transaction::begin(*database_);
  if (!transaction) return Error{transaction.error()};
  const std::pair<const char*, const char*> tables[] = {
      {"SELECT name, value, 0 FROM about", "INSERT INTO about VALUES(?, ?)"},
      {"SELECT key, axes, number FROM plan",
       "INSERT INTO plan(key, axes, number) VALUES(?, ?, ?)"}};
  for (const auto& [from, to] : tables) {
    auto select = other.database_->prepare(from);
    if (!select) return Error{select.error()};
    auto insert = database_->prepare(to);
    if (!insert) return Error{insert.error()};
    for (;;) {
      const auto row = select.value().step();
      if (!row) return Error{row.error()};
      if (!row.value()) break;
      insert.value().bind(1, select.value().text(0)).bind(2, select.value().text(1));
      insert.value().bind(3, select.value().integer(2));
      if (auto error = insert.value().run()) return error;
    }
  }
  return transaction.value().commit();
}

Result<uint64_t> Store::merge(const Store& other) {
  auto known = keys();
  if (!known) return Error{known.error()};
  std::vector<Row> rows;
  const auto take = [&](const StoredRun& run) -> std::optional<Error> {
    if (run.row && known.value().insert(run.row->key).second) rows.push_back(*run.row);
    return std::nullopt;
  };
  if (auto error = other.each_run(take)) return *error;
  if (auto error = add(rows)) return *error;
  return rows.size();
}

}  // namespace capsoc::campaign
