// Where the samples of a run or a fit come from.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "sensor/load.h"

namespace capsoc::golden {

/// The name for what comes on standard input.
constexpr const char* standard_input = "-";

/// A sensor with the hash of what describes it.
struct Trace {
  std::unique_ptr<sensor::Source> source;
  std::string sha256;  ///< of the bytes of its files, of standard input or of what is built in
  std::string name;    ///< for sentences: the path, or "standard input"
};

/// Opens a description or a recording; "-" reads it from standard input. `keys` are laid over a
/// description, `options` say what a recording's columns and numbers mean. What its user should
/// know is in description().remarks. Error: one sentence with file and line.
Result<Trace> open_trace(const std::string& path, const std::vector<sensor::KeyValue>& keys = {},
                         const sensor::RecordingOptions& options = {});

/// The remarks on a recording as warnings: each begins with its file.
std::vector<std::string> warnings_of(const Trace& trace);

}  // namespace capsoc::golden
