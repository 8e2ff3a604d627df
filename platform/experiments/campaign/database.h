// SQLite with errors as values.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/result.h"

namespace capsoc::campaign {

class Database;

/// A prepared statement; its parameters are numbered from 1, its columns from 0.
class Statement {
 public:
  Statement& bind(int parameter, const std::string& text);
  Statement& bind(int parameter, int64_t number);
  Statement& bind(int parameter, double number);
  Statement& bind_null(int parameter);

  /// To the next row; false: there is none. Then, and after an Error, it can be bound again.
  Result<bool> step();
  /// A statement that gives no rows.
  std::optional<Error> run();

  std::string text(int column) const;
  int64_t integer(int column) const { return sqlite3_column_int64(handle_.get(), column); }
  double number(int column) const { return sqlite3_column_double(handle_.get(), column); }
  bool is_null(int column) const {
    return sqlite3_column_type(handle_.get(), column) == SQLITE_NULL;
  }

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  Statement(const Database& database, sqlite3_stmt* handle)
      : database_(&database), handle_(handle) {}

  const Database* database_;
  std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

class Database {
 public:
  enum class Mode {
    read,   ///< changes nothing, except that SQLite cleans up after a writer that was killed
    as_is,  ///< reads the file alone, without locks; no process may write to it meanwhile
    write,
    alone,  ///< as write, without shared memory: no other process may use the file meanwhile
    create
  };
  /// Error: "path: what is wrong; what to do".
  static Result<std::unique_ptr<Database>> open(const std::string& path, Mode mode);
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  const std::string& path() const { return path_; }
  std::optional<Error> execute(const std::string& sql) const;
  Result<Statement> prepare(const std::string& sql) const;
  /// The one number that a query gives; 0 without a row.
  Result<int64_t> number(const std::string& sql) const;
  /// What SQLite says of its last call, as a sentence.
  Error error() const;
  /// Of its last call: it would have had to write, to lock or to share memory, and cannot.
  bool lacks_writing() const;

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }
  };
  explicit Database(std::string path) : path_(std::move(path)) {}

  std::string path_;
  std::unique_ptr<sqlite3, Close> handle_;
};

/// All or nothing: what was not committed is undone in the end.
class Transaction {
 public:
  static Result<Transaction> begin(const Database& database);
  Transaction(Transaction&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();
  std::optional<Error> commit();

 private:
  explicit Transaction(const Database& database) : database_(&database) {}
  const Database* database_;
};

}  // namespace capsoc::campaign
