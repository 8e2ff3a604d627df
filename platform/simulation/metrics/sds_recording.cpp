// Recordings of Arm's SDS-Framework: NAME.LABEL.sds, and NAME.sds.yml that describes it. Source:
// schema/README.md and schema/sds.schema.json of ARM-software/SDS-Framework.
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/constants.h"
#include "host/growing_stream.h"
#include "metrics/spooled_recording.h"

namespace capsoc::metrics {
namespace {

bool is_word(std::size_t column) {
  const std::string name = column_name(column);
  return name == "u" || name == "v";
}

template <typename Number>
void put_number(std::string& bytes, Number number) {
  char copy[sizeof number];
  std::memcpy(copy, &number, sizeof number);
  bytes.append(copy, sizeof number);
}

class SdsRecording final : public SpooledRecording {
 public:
  SdsRecording(Recording recording, host::GrowingStream data, host::GrowingStream metadata)
      : SpooledRecording(std::move(recording)),
        data_(std::move(data)),
        metadata_(std::move(metadata)) {}

 private:
  std::optional<Error> write() override {
    constexpr double ms = 1e3, us = 1e6;
    bool whole_ms = true;
    each([&](double time_s, const double*) {
      whole_ms = whole_ms && std::fabs(time_s * ms - std::round(time_s * ms)) < 1e-6;
    });
    const double ticks = whole_ms ? ms : us;
    std::string block;
    each([&](double time_s, const double* values) {
      block.clear();
      const RecordColumns& columns = recording().columns;
      for (std::size_t i = 0; i < columns.size(); ++i) {
        if (is_time(columns[i])) continue;
        if (is_word(columns[i]))
          put_number(block, static_cast<int32_t>(std::lround(values[i] * q31)));
        else
          put_number(block, values[i]);
      }
      std::string head;
      // Time slots are 32 bits and go round.
      put_number(head, static_cast<uint32_t>(std::llround(time_s * ticks)));
      put_number(head, static_cast<uint32_t>(block.size()));
      data_.write(head + block);
    });
    metadata_.write(description(ticks));
    if (auto error = data_.finish()) return error;
    return metadata_.finish();
  }

  static bool is_time(std::size_t column) { return std::string(column_name(column)) == "t"; }

  std::string description(double ticks) const {
    std::string name = recording().path.substr(recording().path.find_last_of('/') + 1);
    name = name.substr(0, name.find('.'));
    // A JSON string is one of YAML, too.
    const auto quoted = [](const std::string& text) {
      return nlohmann::json(text).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    };
    std::string text = fmt::format("sds:\n  name: {}\n  description: {}\n", quoted(name),
                                   quoted(recording().origin));
    if (samples() > 1 && last_s() > 0)
      text += fmt::format("  sample-frequency: {:.12g}\n",
                          static_cast<double>(samples() - 1) / last_s());
    text += fmt::format("  tick-frequency: {:.0f}\n  content:\n", ticks);
    for (const std::size_t column : recording().columns) {
      if (is_time(column)) continue;
      text += fmt::format("  - value: {}\n    type: {}\n", column_name(column),
                          is_word(column) ? "int32_t" : "double");
      if (is_word(column)) text += fmt::format("    scale: {}\n", 1 / q31);
    }
    return text;
  }

  host::GrowingStream data_, metadata_;
};

}  // namespace

std::string sds_metadata_of(const std::string& path) {
  std::string name = path.substr(0, path.rfind('.'));
  const std::size_t dot = name.rfind('.'), folder = name.find_last_of('/');
  const bool in_name =
      dot != std::string::npos && (folder == std::string::npos || dot > folder + 1);
  if (in_name && dot != 0 && dot + 1 < name.size() &&
      name.find_first_not_of("0123456789", dot + 1) == std::string::npos)
    name.resize(dot);
  return name + ".sds.yml";
}

Result<std::unique_ptr<SampleWriter>> begin_sds_recording(Recording recording) {
  bool any = false;
  for (const std::size_t column : recording.columns)
    any = any || std::string(column_name(column)) != "t";
  if (!any) return Error{recording.path + ": a stream needs a column other than t"};
  auto data = host::GrowingStream::open(recording.path);
  if (!data) return Error{data.error()};
  auto metadata = host::GrowingStream::open(sds_metadata_of(recording.path));
  if (!metadata) return Error{metadata.error()};
  return std::unique_ptr<SampleWriter>(
      new SdsRecording(std::move(recording), std::move(data.value()), std::move(metadata.value())));
}

}  // namespace capsoc::metrics
