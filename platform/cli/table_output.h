// --table, --list-tables, --json, --csv and --html of the commands that print tables.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "base/curve.h"
#include "base/data_table.h"
#include "base/result.h"
#include "host/file_uses.h"

namespace capsoc::cli {

/// Id and title of each table that a command has.
using TableNames = std::vector<std::pair<std::string, std::string>>;

class TableOutput {
 public:
  /// Declares the options; `with_curves`: there are some to be had.
  void add_to(CLI::App& command, TableNames known, bool with_curves = false);

  /// The ids to print, empty: all.
  const std::vector<std::string>& chosen() const { return chosen_; }

  /// The list was asked for and is printed: nothing else is to be done.
  bool listed() const;

  /// Before a long computation: unknown tables, places that cannot be written.
  /// Nothing is written over one of `inputs`.
  std::optional<Error> check(const std::vector<host::FileUse>& inputs = {}) const;

  /// Where the text goes: standard output, or nowhere when that carries the data.
  std::ostream& text();

  /// A report was asked for, or curves in the JSON file.
  bool wants_curves() const { return curves_ || !html_.empty(); }

  /// Writes the files that were asked for, all or none, and says what is lost; `command` is what
  /// the user called. `curves` go into the JSON file and the report. The exit code: `code`, or that
  /// for lost results where it was a pass.
  int finish(const std::vector<DataTable>& tables, const std::string& command, int code,
             const Curves& curves = {}) const;

 private:
  std::optional<Error> write(const std::vector<DataTable>& tables, const std::string& command,
                             const Curves& curves) const;

  TableNames known_;
  std::vector<std::string> chosen_;
  bool list_ = false, curves_ = false;
  std::string json_, csv_, html_;
  std::ostream none_{nullptr};
};

}  // namespace capsoc::cli
