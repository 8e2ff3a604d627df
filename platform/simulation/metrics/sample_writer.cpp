#include "metrics/sample_writer.h"

#include <utility>

#include "metrics/csv_recording.h"

namespace capsoc::metrics {

Result<std::unique_ptr<SampleWriter>> begin_recording(Recording recording) {
  return CsvRecording::begin(std::move(recording));
}

}  // namespace capsoc::metrics
