#include "observers/sample_recording.h"

#include <utility>

#include "metrics/begin_recording.h"

namespace capsoc::run {
namespace {

Result<metrics::RecordColumns> columns_of(const ResultSettings& settings) {
  return metrics::record_columns(settings.record_columns(), "--record-columns");
}

}  // namespace

std::optional<Error> check_recording(const ResultSettings& settings) {
  if (const auto columns = columns_of(settings); !columns) return Error{columns.error()};
  if (settings.record.empty() && !settings.record_columns.empty())
    return Error{"--record-columns: there is no recording; give --record FILE.csv, too"};
  return std::nullopt;
}

SampleRecording::SampleRecording(const ResultSettings& settings, std::string origin,
                                 metrics::SampleProbe& samples)
    : settings_(settings), origin_(std::move(origin)), samples_(samples) {}

std::optional<Error> SampleRecording::open() {
  auto columns = columns_of(settings_);
  if (!columns) return Error{columns.error()};
  auto writer = metrics::begin_recording({settings_.record(), origin_, std::move(columns.value())});
  if (!writer) return Error{writer.error()};
  writer_ = std::move(writer.value());
  // From a checkpoint, a recording begins at 0 as well.
  listening_ = samples_.listen([this](metrics::RecordedSample sample) {
    if (!since_s_) since_s_ = sample.time_s;
    sample.time_s -= *since_s_;
    writer_->add(sample);
  });
  return std::nullopt;
}

void SampleRecording::close(RunResult& result) {
  if (const auto error = writer_->finish()) result.lost.push_back(error->text);
}

}  // namespace capsoc::run
