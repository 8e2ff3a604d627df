#include "metrics/begin_recording.h"

#include <cctype>
#include <utility>

#include "metrics/csv_recording.h"
#include "metrics/spooled_recording.h"
#include "metrics/wav_recording.h"

namespace capsoc::metrics {
namespace {

/// The ending of a file's name in lower case, with its dot.
std::string ending_of(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  std::string ending = dot == std::string::npos ? "" : path.substr(dot);
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

}  // namespace

Result<std::unique_ptr<SampleWriter>> begin_recording(Recording recording) {
  const std::string ending = ending_of(recording.path);
  if (ending == ".wav") return WavRecording::begin(recording);
  if (ending == ".mat") return begin_mat_recording(std::move(recording));
  if (ending == ".sds") return begin_sds_recording(std::move(recording));
  return CsvRecording::begin(std::move(recording));
}

std::vector<std::string> files_of_recording(const std::string& path) {
  if (ending_of(path) == ".sds") return {path, sds_metadata_of(path)};
  return {path};
}

}  // namespace capsoc::metrics
