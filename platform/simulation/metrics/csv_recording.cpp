#include "metrics/csv_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <string_view>
#include <utility>

namespace capsoc::metrics {
namespace {

bool is_truth(std::size_t column) {
  return std::strcmp(column_name(column), "angle_deg") == 0;
}

/// Cuts a cell out of the lines of a text that comes in pieces; lines that begin with # stay.
class CellCutter {
 public:
  explicit CellCutter(std::size_t cell) : cell_(cell) {}

  /// Appends what stays of `piece` to `out`.
  void cut(std::string_view piece, std::string& out) {
    for (const char c : piece) {
      if (at_line_start_) comment_ = c == '#';
      at_line_start_ = c == '\n';
      if (at_line_start_) {
        now_ = 0;
        out += c;
      } else if (comment_) {
        out += c;
      } else if (c == ',') {
        ++now_;
        // The comma in front of the cell goes, or the one after it where it is the first.
        if (now_ != std::max<std::size_t>(cell_, 1)) out += c;
      } else if (now_ != cell_) {
        out += c;
      }
    }
  }

 private:
  std::size_t cell_, now_ = 0;
  bool at_line_start_ = true, comment_ = false;
};

}  // namespace

Result<std::unique_ptr<SampleWriter>> CsvRecording::begin(Recording recording) {
  auto file = host::GrowingStream::open(recording.path);
  if (!file) return Error{file.error()};
  return std::unique_ptr<SampleWriter>(
      new CsvRecording(std::move(recording), std::move(file.value())));
}

void CsvRecording::begin_text(bool truth) {
  begun_ = true;
  RecordColumns& columns = recording_.columns;
  if (!truth)
    columns.erase(std::remove_if(columns.begin(), columns.end(), is_truth), columns.end());
  std::string text = fmt::format("# {}\n", recording_.origin);
  for (std::size_t i = 0; i < columns.size(); ++i)
    text += std::string(i == 0 ? "" : ",") + column_name(columns[i]);
  file_.write(text += '\n');
}

void CsvRecording::add(const RecordedSample& sample) {
  if (!begun_) begin_text(sample.has_truth);
  truth_lost_ = truth_lost_ || !sample.has_truth;
  line_.clear();
  for (const std::size_t column : recording_.columns) {
    if (column != recording_.columns.front()) line_ += ',';
    if (const auto value = column_value(column, sample, samples_))
      fmt::format_to(std::back_inserter(line_), "{}", *value);
  }
  file_.write(line_ += '\n');
  ++samples_;
}

/// Where the true angle stands although not all samples have one.
std::optional<std::size_t> CsvRecording::cell_of_truth() const {
  const RecordColumns& columns = recording_.columns;
  const auto truth = std::find_if(columns.begin(), columns.end(), is_truth);
  if (!truth_lost_ || truth == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(truth - columns.begin());
}

std::optional<Error> CsvRecording::finish() {
  if (!begun_) begin_text(true);
  if (const auto cell = cell_of_truth())
    file_.shrink([cutter = CellCutter(*cell)](std::string_view piece, std::string& out) mutable {
      cutter.cut(piece, out);
    });
  return file_.finish();
}

}  // namespace capsoc::metrics
