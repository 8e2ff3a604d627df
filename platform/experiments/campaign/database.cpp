#include "campaign/database.h"

#include <fmt/format.h>

#include <utility>

namespace capsoc::campaign {
namespace {

constexpr int patience_ms = 20'000;  // for another process that writes

/// What the user can do about it.
const char* advice(int code) {
  switch (code) {
    case SQLITE_IOERR_SHMOPEN:
    case SQLITE_IOERR_SHMSIZE:
    case SQLITE_IOERR_SHMLOCK:
    case SQLITE_IOERR_SHMMAP:
      return "programs share no memory on its disk: copy the store to another disk";
    case SQLITE_IOERR_LOCK:
    case SQLITE_IOERR_RDLOCK:
    case SQLITE_IOERR_UNLOCK:
    case SQLITE_IOERR_CHECKRESERVEDLOCK:
      return "its disk has no locks: copy the store to another disk";
    default:
      break;
  }
  switch (code & 0xFF) {
    case SQLITE_FULL:
      return "make room on the disk and resume: what was there is still there";
    case SQLITE_IOERR:
      return "look after the disk (is it full?) and resume: what was there is still there";
    case SQLITE_CORRUPT:
      return "the store is damaged: put a copy in its place, or move it away and run again";
    case SQLITE_NOTADB:
      return "this is no store of a campaign; name another file";
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "another process uses the store; wait for it, or name another file";
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_CANTOPEN:
      return "name a file that can be read and written";
    default:
      return "name another file";
  }
}

/// As a URI has it: what is neither a letter, a digit nor / . - _ becomes %xx.
std::string uri_path(const std::string& path) {
  std::string uri;
  for (const char c : path) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                       c == '/' || c == '.' || c == '-' || c == '_';
    uri += plain ? std::string(1, c) : fmt::format("%{:02x}", static_cast<unsigned char>(c));
  }
  return uri;
}

}  // namespace

Result<std::unique_ptr<Database>> Database::open(const std::string& path, Mode mode) {
  std::unique_ptr<Database> database(new Database(path));
  const bool as_is = mode == Mode::as_is;
  const int flags = as_is ? SQLITE_OPEN_READONLY | SQLITE_OPEN_URI
                          : SQLITE_OPEN_READWRITE | (mode == Mode::create ? SQLITE_OPEN_CREATE : 0);
  sqlite3* handle = nullptr;
  // A name that begins with "file:" would be taken for a URI otherwise; "./" prevents that.
  const std::string plain = path.rfind('/', 0) == 0 ? path : "./" + path;
  const std::string name = as_is ? "file:" + uri_path(plain) + "?immutable=1" : plain;
  const int code = sqlite3_open_v2(name.c_str(), &handle, flags, nullptr);
  database->handle_.reset(handle);
  if (code != SQLITE_OK) return database->error();
  sqlite3_extended_result_codes(handle, 1);
  sqlite3_busy_timeout(handle, patience_ms);
  // A damaged file shall be an error and nothing else; its SQL gets no functions of ours.
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  if (auto error = database->execute("PRAGMA cell_size_check = ON")) return *error;
  // Before the first access; then SQLite keeps in its own memory what it would share.
  if (mode == Mode::alone)
    if (auto error = database->execute("PRAGMA locking_mode = EXCLUSIVE")) return *error;
  if (mode != Mode::read && !as_is) return database;
  if (auto error = database->execute("PRAGMA query_only = ON")) return *error;
  return database;
}

Error Database::error() const {
  sqlite3* handle = handle_.get();
  const int code = handle != nullptr ? sqlite3_extended_errcode(handle) : SQLITE_NOMEM;
  const char* words = handle != nullptr ? sqlite3_errmsg(handle) : "out of memory";
  return Error{fmt::format("{}: {}; {}", path_, words, advice(code))};
}

bool Database::lacks_writing() const {
  const int code = sqlite3_extended_errcode(handle_.get());
  switch (code & 0xFF) {
    case SQLITE_CANTOPEN:
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return true;
    case SQLITE_IOERR:
      return code == SQLITE_IOERR_SHMOPEN || code == SQLITE_IOERR_SHMSIZE ||
             code == SQLITE_IOERR_SHMLOCK || code == SQLITE_IOERR_SHMMAP ||
             code == SQLITE_IOERR_LOCK || code == SQLITE_IOERR_RDLOCK;
    default:
      return false;
  }
}

std::optional<Error> Database::execute(const std::string& sql) const {
  if (sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK)
    return std::nullopt;
  return error();
}

Result<Statement> Database::prepare(const std::string& sql) const {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(handle_.get(), sql.c_str(), -1, &statement, nullptr) != SQLITE_OK)
    return error();
  return Statement(*this, statement);
}

Result<int64_t> Database::number(const std::string& sql) const {
  auto statement = prepare(sql);
  if (!statement) return Error{statement.error()};
  const auto row = statement.value().step();
  if (!row) return Error{row.error()};
  return row.value() ? statement.value().integer(0) : 0;
}

Statement& Statement::bind(int parameter, const std::string& text) {
  sqlite3_bind_text64(handle_.get(), parameter, text.data(), text.size(), SQLITE_TRANSIENT,
                      SQLITE_UTF8);
  return *this;
}

Statement& Statement::bind(int parameter, int64_t number) {
  sqlite3_bind_int64(handle_.get(), parameter, number);
  return *this;
}

Statement& Statement::bind(int parameter, double number) {
  sqlite3_bind_double(handle_.get(), parameter, number);
  return *this;
}

Statement& Statement::bind_null(int parameter) {
  sqlite3_bind_null(handle_.get(), parameter);
  return *this;
}

Result<bool> Statement::step() {
  const int code = sqlite3_step(handle_.get());
  if (code == SQLITE_ROW) return true;
  // The words of an error are gone with a reset.
  const Error error = code == SQLITE_DONE ? Error{} : database_->error();
  sqlite3_reset(handle_.get());
  if (code != SQLITE_DONE) return error;
  return false;
}

std::optional<Error> Statement::run() {
  const auto row = step();
  if (!row) return Error{row.error()};
  if (row.value()) sqlite3_reset(handle_.get());
  return std::nullopt;
}

std::string Statement::text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(handle_.get(), column));
  const int size = sqlite3_column_bytes(handle_.get(), column);
  return text != nullptr ? std::string(text, static_cast<std::size_t>(size)) : "";
}

Result<Transaction> Transaction::begin(const Database& database) {
  if (auto error = database.execute("BEGIN IMMEDIATE")) return *error;
  return Transaction(database);
}

Transaction::~Transaction() {
  // SQLite may have rolled back after an error; the second rollback's own error is ignored.
  if (database_ != nullptr) database_->execute("ROLLBACK");
}

std::optional<Error> Transaction::commit() {
  if (auto error = database_->execute("COMMIT")) return error;
  database_ = nullptr;
  return std::nullopt;
}

}  // namespace capsoc::campaign
