// Recordings of Arm's SDS-Framework (Synchronous Data Streams).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "sensor/column_table.h"

namespace capsoc::sensor {

/// A value of a stream, as its metadata says.
struct SdsValue {
  std::string name, unit;
  enum class Type { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 } type = Type::i16;
  std::size_t count = 1;  ///< dim-x times dim-y; only single values can be signals
  double scale = 1, offset = 0;
};

/// What a stream's metadata say.
struct SdsMetadata {
  std::vector<SdsValue> values;
  std::optional<double> rate_hz;   ///< of samples
  std::optional<double> block_hz;  ///< of blocks
  double tick_hz = 1000;           ///< of the time slots
};

/// `text` is YAML as schema/sds.schema.json has it: values or PCM audio; also the older key
/// `frequency`. Error: one sentence with the file, and the line where there is one.
Result<SdsMetadata> read_sds_metadata(const std::string& text, const std::string& file);

/// The blocks of a .sds file: time slot and size, 32 bits each, and packed values, little-endian.
/// Gaps in the time slots become remarks; without a rate in the metadata they give it. Error: one
/// sentence with the file.
Result<ColumnTable> read_sds(std::string_view bytes, const SdsMetadata& metadata,
                             const std::string& file);

/// Where the metadata of NAME.LABEL.sds can be: NAME.LABEL.sds.yml and, part by part shorter,
/// NAME.sds.yml.
std::vector<std::string> sds_metadata_files(const std::string& path);

}  // namespace capsoc::sensor
