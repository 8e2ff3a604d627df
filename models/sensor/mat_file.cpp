#include "sensor/mat_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "base/printable.h"
#include "sensor/bytes.h"

namespace capsoc::sensor {
namespace {

constexpr std::size_t header_bytes = 128;
constexpr uint64_t largest_unpacked = 1U << 30U;
constexpr std::size_t most_columns = 64;

// Types of data elements, and classes of arrays.
enum ElementType : uint32_t {
  mi_int8 = 1,
  mi_uint8,
  mi_int16,
  mi_uint16,
  mi_int32,
  mi_uint32,
  mi_single,
  mi_double = 9,
  mi_int64 = 12,
  mi_uint64,
  mi_matrix,
  mi_compressed
};
constexpr uint32_t first_numeric_class = 6, last_numeric_class = 15;

struct Element {
  uint32_t type = 0;
  std::string_view data;
};

/// Takes data elements off the front of some bytes.
class Elements {
 public:
  Elements(std::string_view bytes, bool reversed) : rest_(bytes), reversed_(reversed) {}

  /// False at the end, and where an element is longer than what is there.
  bool next(Element& element) {
    if (rest_.size() < 8) return false;
    const auto word = number_at<uint32_t>(rest_, 0, reversed_);
    std::size_t head = 8;
    uint64_t size = number_at<uint32_t>(rest_, 4, reversed_);
    element.type = word;
    // Up to four bytes fit in the tag itself.
    if (word >> 16U != 0) {
      element.type = word & 0xFFFFU;
      size = word >> 16U;
      head = 4;
      if (size > 4) return false;
    }
    if (size > rest_.size() - head) return false;
    element.data = rest_.substr(head, size);
    uint64_t all = head + size;
    if (element.type != mi_compressed) all = (all + 7) / 8 * 8;
    rest_.remove_prefix(std::min<uint64_t>(all, rest_.size()));
    return true;
  }
  bool at_end() const { return rest_.empty(); }

 private:
  std::string_view rest_;
  bool reversed_;
};

std::size_t element_width(uint32_t type) {
  switch (type) {
    case mi_int8:
    case mi_uint8:
      return 1;
    case mi_int16:
    case mi_uint16:
      return 2;
    case mi_int32:
    case mi_uint32:
    case mi_single:
      return 4;
    case mi_double:
    case mi_int64:
    case mi_uint64:
      return 8;
    default:
      return 0;
  }
}

double element_value(const Element& element, std::size_t k, bool reversed) {
  const std::string_view data = element.data;
  switch (element.type) {
    case mi_int8:
      return number_at<int8_t>(data, k);
    case mi_uint8:
      return number_at<uint8_t>(data, k);
    case mi_int16:
      return number_at<int16_t>(data, 2 * k, reversed);
    case mi_uint16:
      return number_at<uint16_t>(data, 2 * k, reversed);
    case mi_int32:
      return number_at<int32_t>(data, 4 * k, reversed);
    case mi_uint32:
      return number_at<uint32_t>(data, 4 * k, reversed);
    case mi_single:
      return number_at<float>(data, 4 * k, reversed);
    case mi_int64:
      return static_cast<double>(number_at<int64_t>(data, 8 * k, reversed));
    case mi_uint64:
      return static_cast<double>(number_at<uint64_t>(data, 8 * k, reversed));
    default:
      return number_at<double>(data, 8 * k, reversed);
  }
}

struct Array {
  std::string name;
  bool numeric = false;
  std::size_t rows = 0, columns = 0;
  std::vector<double> values;  ///< column by column
};

/// An array of two dimensions; nothing for damage.
std::optional<Array> read_array(std::string_view bytes, bool reversed) {
  Elements parts(bytes, reversed);
  Element flags, dimensions, name, real;
  if (!parts.next(flags) || flags.data.size() < 8 || !parts.next(dimensions) || !parts.next(name))
    return std::nullopt;
  Array array;
  array.name = std::string(name.data);
  const uint32_t word = number_at<uint32_t>(flags.data, 0, reversed);
  const uint32_t array_class = word & 0xFFU;
  const bool complex = (word & 0x800U) != 0;
  array.numeric = array_class >= first_numeric_class && array_class <= last_numeric_class &&
                  !complex && dimensions.data.size() == 8;
  if (!array.numeric) return array;
  if (!parts.next(real)) return std::nullopt;
  array.rows = number_at<uint32_t>(dimensions.data, 0, reversed);
  array.columns = number_at<uint32_t>(dimensions.data, 4, reversed);
  const std::size_t width = element_width(real.type);
  if (width == 0 || uint64_t{array.rows} * array.columns != real.data.size() / width)
    return std::nullopt;
  const std::size_t count = array.rows * array.columns;
  array.values.reserve(count);
  for (std::size_t k = 0; k < count; ++k) array.values.push_back(element_value(real, k, reversed));
  return array;
}

/// Nothing if the bytes are damaged or become more than `most`.
std::optional<std::string> unpacked(std::string_view bytes, uint64_t most) {
  std::string out;
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return std::nullopt;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  int status = Z_OK;
  while (status == Z_OK && out.size() <= most) {
    constexpr std::size_t piece = 1U << 16U;
    const std::size_t before = out.size();
    out.resize(before + piece);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = piece;
    status = inflate(&stream, Z_NO_FLUSH);
    out.resize(before + piece - stream.avail_out);
    if (status == Z_OK && stream.avail_in == 0 && stream.avail_out != 0) status = Z_BUF_ERROR;
  }
  inflateEnd(&stream);
  return status == Z_STREAM_END && out.size() <= most ? std::make_optional(out) : std::nullopt;
}

std::optional<std::vector<Array>> read_arrays(std::string_view bytes, bool reversed) {
  std::vector<Array> arrays;
  uint64_t left = largest_unpacked;
  Elements elements(bytes.substr(header_bytes), reversed);
  Element element;
  while (elements.next(element)) {
    std::optional<std::string> packed;
    if (element.type == mi_compressed) {
      packed = unpacked(element.data, left);
      if (!packed) return std::nullopt;
      left -= packed->size();
      if (!Elements(*packed, reversed).next(element)) return std::nullopt;
    }
    if (element.type != mi_matrix) continue;
    auto array = read_array(element.data, reversed);
    if (!array) return std::nullopt;
    arrays.push_back(std::move(*array));
  }
  if (!elements.at_end()) return std::nullopt;
  return arrays;
}

bool is_rate(const std::string& name) {
  for (const char* known : {"fs", "Fs", "FS", "rate_hz", "sample_rate_hz", "sample_rate"})
    if (name == known) return true;
  return false;
}

/// The columns of the only matrix there is; a short and wide one lies on its side.
ColumnTable table_of(const Array& matrix) {
  ColumnTable table;
  const bool on_its_side = matrix.rows < matrix.columns;
  const std::size_t columns = on_its_side ? matrix.rows : matrix.columns;
  const std::size_t rows = on_its_side ? matrix.columns : matrix.rows;
  table.named = false;
  table.names = numbered_names(columns);
  table.columns.resize(columns);
  for (std::size_t c = 0; c < columns; ++c)
    for (std::size_t k = 0; k < rows; ++k)
      table.columns[c].push_back(matrix.values[on_its_side ? k * columns + c : c * rows + k]);
  return table;
}

}  // namespace

bool is_mat(std::string_view bytes) {
  return bytes.size() > header_bytes && bytes.substr(0, 7) == "MATLAB " &&
         (bytes.substr(126, 2) == "IM" || bytes.substr(126, 2) == "MI");
}

Result<ColumnTable> read_mat(std::string_view bytes, const std::string& file) {
  const auto refuse = [&file](const std::string& what) { return Error{file + ": " + what}; };
  if (bytes.size() <= header_bytes) return refuse("is too short for a MAT file");
  if (bytes.substr(0, 10) == "MATLAB 7.3" || bytes.substr(1, 3) == "HDF")
    return refuse("is a MAT file of version 7.3 (HDF5); save it with -v7");
  if (!is_mat(bytes))
    return refuse(
        "is no MAT file of level 5; save it with -v7 (MATLAB, Octave) or "
        "scipy.io.savemat");
  const bool reversed = bytes.substr(126, 2) == "MI";
  const auto arrays = read_arrays(bytes, reversed);
  if (!arrays) return refuse("is damaged: a variable ends too early or cannot be unpacked");

  ColumnTable table;
  std::vector<const Array*> matrices;
  std::optional<double> rate;
  std::string seen;
  for (const Array& array : *arrays) {
    seen += fmt::format(
        "{}'{}'{}", seen.empty() ? "" : ", ", printable(array.name),
        array.numeric ? fmt::format(" ({}x{})", array.rows, array.columns) : " (no real numbers)");
    if (!array.numeric) continue;
    if (array.values.size() == 1 && is_rate(array.name) && array.values.front() > 0)
      rate = array.values.front();
    if (array.values.size() < 2) continue;
    if (array.rows == 1 || array.columns == 1) {
      table.names.push_back(column_name(array.name));
      table.columns.push_back(array.values);
    } else {
      matrices.push_back(&array);
    }
  }
  if (table.columns.empty() && matrices.size() == 1 &&
      std::min(matrices[0]->rows, matrices[0]->columns) <= most_columns)
    table = table_of(*matrices[0]);
  else if (table.columns.size() < 2)
    return refuse(
        fmt::format("the variables are {}; save the signals as vectors u and v, or as one "
                    "matrix with a column each",
                    seen.empty() ? "none" : printable(seen, 300)));
  table.rate_hz = rate;
  return table;
}

}  // namespace capsoc::sensor
