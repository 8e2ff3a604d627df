#include "metrics/wav_recording.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

namespace capsoc::metrics {
namespace {

constexpr uint32_t header_bytes = 80;
constexpr uint64_t bytes_of_sample = 8;
constexpr uint32_t ds64_bytes = 28;

template <typename Number>
void append(std::string& bytes, Number number) {
  char copy[sizeof number];
  std::memcpy(copy, &number, sizeof number);
  bytes.append(copy, sizeof number);
}

/// With a place that RF64 uses for its sizes.
std::string header(uint64_t samples, uint32_t rate) {
  const uint64_t data = samples * bytes_of_sample, all = data + header_bytes - 8;
  const bool large = all > UINT32_MAX;
  std::string bytes = large ? "RF64" : "RIFF";
  append(bytes, large ? UINT32_MAX : static_cast<uint32_t>(all));
  bytes += "WAVE";
  bytes += large ? "ds64" : "JUNK";
  append(bytes, ds64_bytes);
  append(bytes, large ? all : uint64_t{0});
  append(bytes, large ? data : uint64_t{0});
  append(bytes, large ? samples : uint64_t{0});
  append(bytes, uint32_t{0});
  bytes += "fmt ";
  append(bytes, uint32_t{16});
  append(bytes, uint16_t{1});  // PCM
  append(bytes, uint16_t{2});
  append(bytes, rate);
  append(bytes, static_cast<uint32_t>(rate * bytes_of_sample));
  append(bytes, static_cast<uint16_t>(bytes_of_sample));
  append(bytes, uint16_t{32});
  bytes += "data";
  append(bytes, large ? UINT32_MAX : static_cast<uint32_t>(data));
  return bytes;
}

bool holds(const RecordColumns& columns) {
  bool u = false, v = false;
  for (const std::size_t column : columns) {
    const std::string name = column_name(column);
    u = u || name == "u";
    v = v || name == "v";
    if (name != "t" && name != "u" && name != "v" && name != "angle_deg") return false;
  }
  return u && v;
}

}  // namespace

Result<std::unique_ptr<SampleWriter>> WavRecording::begin(const Recording& recording) {
  if (!holds(recording.columns))
    return Error{
        recording.path +
        ": a WAV file has the channels u and v; leave --record-columns out, or record CSV"};
  auto file = host::GrowingStream::open(recording.path);
  if (!file) return Error{file.error()};
  return std::unique_ptr<SampleWriter>(new WavRecording(std::move(file.value())));
}

WavRecording::WavRecording(host::GrowingStream file) : file_(std::move(file)) {
  file_.write(header(0, 1));
}

void WavRecording::add(const RecordedSample& sample) {
  char words[bytes_of_sample];
  std::memcpy(words, &sample.u, 4);
  std::memcpy(words + 4, &sample.v, 4);
  file_.write({words, sizeof words});
  ++samples_;
  last_s_ = sample.time_s;
}

std::optional<Error> WavRecording::finish() {
  const double rate = samples_ > 1 && last_s_ > 0 ? static_cast<double>(samples_ - 1) / last_s_ : 1;
  constexpr double most = 4e8;  // its bytes a second are 32 bits
  file_.replace(0,
                header(samples_, static_cast<uint32_t>(std::clamp(std::round(rate), 1.0, most))));
  return file_.finish();
}

}  // namespace capsoc::metrics
