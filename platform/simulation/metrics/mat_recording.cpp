// MAT files of level 5. Source of the format: MathWorks, MAT-File Format.
#include <cstring>
#include <string_view>
#include <utility>

#include "host/growing_stream.h"
#include "metrics/spooled_recording.h"

namespace capsoc::metrics {
namespace {

// Types of data elements, and the class of an array of doubles.
constexpr uint32_t of_int8 = 1, of_int32 = 5, of_uint32 = 6, of_double = 9, of_matrix = 14;
constexpr uint32_t double_class = 6;
constexpr std::size_t text_bytes = 116;

template <typename Number>
void put(std::string& bytes, Number number) {
  char copy[sizeof number];
  std::memcpy(copy, &number, sizeof number);
  bytes.append(copy, sizeof number);
}

void pad(std::string& bytes) {
  bytes.resize((bytes.size() + 7) / 8 * 8);
}

/// Everything of a column vector before its values.
std::string vector_head(const std::string& name, uint32_t rows) {
  std::string bytes;
  put(bytes, of_uint32);
  put(bytes, uint32_t{8});
  put(bytes, double_class);
  put(bytes, uint32_t{0});
  put(bytes, of_int32);
  put(bytes, uint32_t{8});
  put(bytes, rows);
  put(bytes, uint32_t{1});
  put(bytes, of_int8);
  put(bytes, static_cast<uint32_t>(name.size()));
  bytes += name;
  pad(bytes);
  put(bytes, of_double);
  put(bytes, rows * 8);
  std::string tag;
  put(tag, of_matrix);
  put(tag, static_cast<uint32_t>(bytes.size()) + rows * 8);
  return tag + bytes;
}

class MatRecording final : public SpooledRecording {
 public:
  MatRecording(Recording recording, host::GrowingStream file)
      : SpooledRecording(std::move(recording)), file_(std::move(file)) {}

 private:
  std::optional<Error> write() override {
    constexpr uint64_t most = UINT32_MAX / 8 - 32;  // the sizes are of 32 bits
    if (samples() > most)
      return Error{recording().path +
                   ": a MAT file of level 5 holds no more than 4 GB a variable; "
                   "record CSV"};
    std::string head = "MATLAB 5.0 MAT-file, by capsoc";
    head.resize(text_bytes, ' ');
    head.resize(text_bytes + 8, '\0');
    put(head, uint16_t{0x0100});
    file_.write(head += "IM");
    for (std::size_t i = 0; i < recording().columns.size(); ++i) {
      file_.write(
          vector_head(column_name(recording().columns[i]), static_cast<uint32_t>(samples())));
      each([this, i](double, const double* values) {
        char copy[sizeof(double)];
        std::memcpy(copy, &values[i], sizeof copy);
        file_.write({copy, sizeof copy});
      });
    }
    return file_.finish();
  }

  host::GrowingStream file_;
};

}  // namespace

Result<std::unique_ptr<SampleWriter>> begin_mat_recording(Recording recording) {
  auto file = host::GrowingStream::open(recording.path);
  if (!file) return Error{file.error()};
  return std::unique_ptr<SampleWriter>(
      new MatRecording(std::move(recording), std::move(file.value())));
}

}  // namespace capsoc::metrics
