#include "sensor/wav_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "sensor/bytes.h"

namespace capsoc::sensor {
namespace {

constexpr uint16_t pcm = 1, floating = 3, extensible = 0xFFFE;
constexpr uint32_t unknown_size = 0xFFFFFFFF;
constexpr std::size_t most_channels = 64;

struct Format {
  uint16_t code = 0, channels = 0, block = 0, bits = 0;
  uint32_t rate = 0;
};

/// Of the chunk "fmt "; nothing if it is too short.
std::optional<Format> read_format(std::string_view chunk) {
  if (chunk.size() < 16) return std::nullopt;
  Format format;
  format.code = number_at<uint16_t>(chunk, 0);
  format.channels = number_at<uint16_t>(chunk, 2);
  format.rate = number_at<uint32_t>(chunk, 4);
  format.block = number_at<uint16_t>(chunk, 12);
  format.bits = number_at<uint16_t>(chunk, 14);
  // The first two bytes of the subformat's GUID are the code.
  if (format.code == extensible) {
    if (chunk.size() < 26) return std::nullopt;
    format.code = number_at<uint16_t>(chunk, 24);
  }
  return format;
}

double sample_at(std::string_view data, std::size_t place, const Format& format,
                 std::size_t bytes) {
  if (format.code == floating)
    return bytes == 4 ? number_at<float>(data, place) : number_at<double>(data, place);
  if (bytes == 1) return (static_cast<uint8_t>(data[place]) - 128) / 128.0;
  // Left-aligned in 32 bits, so that the sign is in its place.
  uint32_t word = 0;
  for (std::size_t i = 0; i < bytes; ++i)
    word |= static_cast<uint32_t>(static_cast<uint8_t>(data[place + i])) << (8 * (4 - bytes + i));
  return static_cast<int32_t>(word) / 0x1p31;
}

std::string objection(const Format& format) {
  if (format.code != pcm && format.code != floating)
    return fmt::format("its samples are coded (format {}); save it as PCM or floating point",
                       format.code);
  const std::size_t bytes = format.channels != 0 ? format.block / format.channels : 0;
  const bool whole = format.channels != 0 && format.block % format.channels == 0;
  const bool good = format.code == pcm ? bytes >= 1 && bytes <= 4 : bytes == 4 || bytes == 8;
  if (!whole || !good || format.channels > most_channels)
    return fmt::format(
        "{} channels in {} bytes are no samples; save it as PCM of 8, 16, 24 or 32 "
        "bits or as floating point",
        format.channels, format.block);
  return "";
}

}  // namespace

bool is_wav(std::string_view bytes) {
  const std::string_view kind = bytes.substr(0, 4);
  return (kind == "RIFF" || kind == "RF64" || kind == "RIFX") && bytes.size() >= 12 &&
         bytes.substr(8, 4) == "WAVE";
}

Result<ColumnTable> read_wav(std::string_view bytes, const std::string& file) {
  const auto refuse = [&file](const std::string& what) { return Error{file + ": " + what}; };
  if (!is_wav(bytes)) return refuse("is no WAV file; name recordings by their kind");
  if (bytes.substr(0, 4) == "RIFX") return refuse("is big-endian (RIFX); save it as RIFF");
  std::optional<Format> format;
  uint64_t long_size = 0;
  for (std::size_t place = 12; place + 8 <= bytes.size();) {
    const std::string_view kind = bytes.substr(place, 4);
    const auto size = number_at<uint32_t>(bytes, place + 4);
    place += 8;
    const std::size_t left = bytes.size() - place;
    const std::string_view chunk = bytes.substr(place, std::min<std::size_t>(size, left));
    if (kind == "ds64" && chunk.size() >= 16) long_size = number_at<uint64_t>(chunk, 8);
    if (kind == "fmt ") {
      format = read_format(chunk);
      if (!format) return refuse("its format chunk is cut off");
      if (const std::string what = objection(*format); !what.empty()) return refuse(what);
    }
    if (kind == "data") {
      if (!format) return refuse("its samples come before their format");
      const bool open_end = size == unknown_size || size == 0;
      const uint64_t stated = size == unknown_size ? long_size : size;
      const std::string_view data =
          open_end && stated == 0 ? bytes.substr(place) : bytes.substr(place, stated);
      const std::size_t width = format->block / format->channels;
      const std::size_t frames = data.size() / format->block;
      ColumnTable table;
      table.names = numbered_names(format->channels);
      table.named = false;
      table.channels = true;
      table.columns.resize(format->channels);
      for (std::size_t channel = 0; channel < format->channels; ++channel) {
        table.columns[channel].reserve(frames);
        for (std::size_t k = 0; k < frames; ++k)
          table.columns[channel].push_back(
              sample_at(data, k * format->block + channel * width, *format, width));
      }
      if (format->rate > 0) table.rate_hz = format->rate;
      if (stated > data.size() || data.size() % format->block != 0)
        table.remarks.push_back("the file ends within its samples; those before are taken");
      return table;
    }
    if (size > left) break;
    place += size + size % 2;
  }
  return refuse("there are no samples in it");
}

}  // namespace capsoc::sensor
