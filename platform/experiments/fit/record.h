// A trace as the coprocessor would see it, for the identifiers.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "identification/samples.h"
#include "sensor/description_keys.h"
#include "sensor/recording_options.h"
#include "sensor/source.h"

namespace capsoc::fit {

struct RecordOptions {
  unsigned adc_bits = 0;  ///< width of the converter, 12 to 32; 0: as the trace says, else 32
  uint64_t samples = 0;   ///< at most; 0: all, or 100,000 of a trace without an end
  std::vector<sensor::KeyValue> keys = {};  ///< laid over a description
  sensor::RecordingOptions recording = {};  ///< what a recording's columns and numbers mean
};

/// The samples of a trace in order, converted as the ADC front-end converts them (32 bits: clipped,
/// but not rounded).
struct Record {
  std::string path;
  std::string sha256;  ///< of the file, or of what is built in
  identification::Samples samples;
  Eigen::ArrayXd angle;  ///< true angle, radians; empty when it is not known
  sensor::Description description;
  unsigned adc_bits = 32;
  double full_scale = 1;  ///< the converter's largest value: what reaches it may be clipped
  double step = 0;        ///< of the converter, full scale; 0: not known, or none
  std::vector<std::string> warnings;  ///< sentences on the recording, with its file
};

/// Reads what `capsoc run --sensor` takes. Error: one sentence with file and line for what cannot
/// be read. Whether the samples tell a sensor is not looked at.
Result<Record> read_record(const std::string& path, const RecordOptions& options = {});

}  // namespace capsoc::fit
