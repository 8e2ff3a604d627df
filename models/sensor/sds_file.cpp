#include "sensor/sds_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sensor/bytes.h"
#include "sensor/time_stamps.h"

namespace capsoc::sensor {
namespace {

using SdsType = SdsValue::Type;

std::size_t type_width(SdsType type) {
  switch (type) {
    case SdsType::i8:
    case SdsType::u8:
      return 1;
    case SdsType::i16:
    case SdsType::u16:
      return 2;
    case SdsType::i32:
    case SdsType::u32:
    case SdsType::f32:
      return 4;
    default:
      return 8;
  }
}

double type_value(std::string_view bytes, std::size_t place, SdsType type) {
  switch (type) {
    case SdsType::i8:
      return number_at<int8_t>(bytes, place);
    case SdsType::u8:
      return number_at<uint8_t>(bytes, place);
    case SdsType::i16:
      return number_at<int16_t>(bytes, place);
    case SdsType::u16:
      return number_at<uint16_t>(bytes, place);
    case SdsType::i32:
      return number_at<int32_t>(bytes, place);
    case SdsType::u32:
      return number_at<uint32_t>(bytes, place);
    case SdsType::i64:
      return static_cast<double>(number_at<int64_t>(bytes, place));
    case SdsType::u64:
      return static_cast<double>(number_at<uint64_t>(bytes, place));
    case SdsType::f32:
      return number_at<float>(bytes, place);
    default:
      return number_at<double>(bytes, place);
  }
}

struct Block {
  double time_s;
  std::string_view data;
};

/// Adds the samples of a block to the columns of single values.
void take_block(const Block& block, const SdsMetadata& metadata, std::size_t row,
                ColumnTable& table) {
  for (std::size_t start = 0; start + row <= block.data.size(); start += row) {
    std::size_t place = start, column = 0;
    for (const SdsValue& value : metadata.values) {
      if (value.count == 1)
        table.columns[column++].push_back(type_value(block.data, place, value.type) * value.scale +
                                          value.offset);
      place += type_width(value.type) * value.count;
    }
  }
}

}  // namespace

Result<ColumnTable> read_sds(std::string_view bytes, const SdsMetadata& metadata,
                             const std::string& file) {
  std::size_t row = 0;
  ColumnTable table;
  for (const SdsValue& value : metadata.values) {
    row += type_width(value.type) * value.count;
    if (value.count != 1) continue;
    table.names.push_back(column_name(value.name));
    if (!value.unit.empty()) table.names.back().unit = column_name("x(" + value.unit + ")").unit;
  }
  if (row == 0)
    return Error{
        fmt::format("{}: its metadata name no values; give the .yml that belongs to it", file)};
  table.columns.resize(table.names.size());
  TimeStamps stamps("block", "blocks");
  uint64_t ticks = 0;
  uint32_t last_slot = 0;
  unsigned long blocks = 0;
  std::size_t rows = 0;
  for (std::size_t place = 0; place < bytes.size(); ++blocks) {
    const auto refuse = [&](const std::string& what) {
      return Error{fmt::format("{}: block {} (byte {}) {}", file, blocks + 1, place, what)};
    };
    if (bytes.size() - place < 8) return refuse("ends within its header; remove it");
    const auto slot = number_at<uint32_t>(bytes, place),
               size = number_at<uint32_t>(bytes, place + 4);
    if (size > bytes.size() - place - 8)
      return refuse(
          fmt::format("has {} bytes, and the file ends before; is it a .sds file?", size));
    if (size % row != 0)
      return refuse(
          fmt::format("has {} bytes, and a sample has {} by the metadata; correct the "
                      "metadata's types",
                      size, row));
    // Time slots are 32 bits and go round.
    if (blocks > 0) ticks += static_cast<uint32_t>(slot - last_slot);
    last_slot = slot;
    const double time = static_cast<double>(ticks) / metadata.tick_hz;
    stamps.add(time, blocks + 1);
    take_block({time, bytes.substr(place + 8, size)}, metadata, row, table);
    rows += size / row;
    place += 8 + size;
  }
  const TimeStamps::Verdict times = stamps.verdict();
  table.remarks = times.remarks;
  table.rate_hz = metadata.rate_hz;
  const double samples = blocks != 0 ? static_cast<double>(rows) / static_cast<double>(blocks) : 0;
  if (!table.rate_hz && metadata.block_hz) table.rate_hz = *metadata.block_hz * samples;
  if (!table.rate_hz && times.rate_hz) table.rate_hz = *times.rate_hz * samples;
  return table;
}

std::vector<std::string> sds_metadata_files(const std::string& path) {
  std::vector<std::string> files;
  const std::size_t folder = path.find_last_of('/');
  const std::size_t name = folder == std::string::npos ? 0 : folder + 1;
  std::size_t end = path.rfind('.');  // before "sds"
  while (end != std::string::npos && end > name) {
    files.push_back(path.substr(0, end) + ".sds.yml");
    end = path.rfind('.', end - 1);
  }
  return files;
}

}  // namespace capsoc::sensor
