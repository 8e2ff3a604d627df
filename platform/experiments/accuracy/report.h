// Rows of `capsoc accuracy`: text and data are made of the same ones.
#pragma once

#include <fmt/format.h>

#include <iosfwd>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "accuracy/experiment.h"
#include "base/data_table.h"

namespace capsoc::accuracy {

/// A figure of one arithmetic as it is printed; no number for "not", no text for none.
struct Figure {
  std::string text;
  std::optional<double> value;
};

/// An angle error in degrees.
Figure degrees(double value);

/// One line of a table.
struct Row {
  std::string label, unit;
  Figure precise, paper;
  std::optional<double> bound;  ///< of precise
  enum class Verdict { none, holds, misses, clips } verdict = Verdict::none;
};

class Report {
 public:
  Report(std::ostream& out, std::vector<std::string> chosen)
      : out_(out), chosen_(std::move(chosen)) {}

  bool wants(const std::string& id) const;

  template <typename... Values>
  void line(fmt::format_string<Values...> format, Values&&... values) {
    print(fmt::format(format, std::forward<Values>(values)...));
  }

  void heading(const std::string& id, const std::string& title, const std::string& label,
               const std::string& unit = ", deg");
  /// The title alone.
  void heading(const std::string& id, const std::string& title);

  /// Text and data of a line. A row of `precise` that misses its bound or clips is counted.
  void add(const Row& row);

  /// The same without the text, for tables that print their own.
  void add_data(const Row& row);

  /// Both angle errors and, when there is a bound, whether `precise` holds it.
  void row(const std::string& label, const Comparison& c,
           std::optional<double> bound_deg = std::nullopt);

  static Row::Verdict verdict(bool holds) {
    return holds ? Row::Verdict::holds : Row::Verdict::misses;
  }

  int missed() const { return missed_; }
  const std::vector<DataTable>& tables() const { return tables_; }

 private:
  void print(const std::string& text);

  std::ostream& out_;
  std::vector<std::string> chosen_;
  std::vector<DataTable> tables_;
  int missed_ = 0;
};

}  // namespace capsoc::accuracy
