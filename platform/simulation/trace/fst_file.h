// A wave file in GTKWave's FST format.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "trace/wave_file.h"

namespace capsoc::trace {

/// Signals in scopes and their changes. Changes may be announced ahead of time and in any order, as
/// long as none lies before what flush() has written. Named at the end: a whole file or none.
class FstFile {
 public:
  using Signal = unsigned;

  /// One time unit is a picosecond. An Error: nothing can be written there.
  static Result<std::unique_ptr<FstFile>> create(const std::string& path);
  ~FstFile();
  FstFile(const FstFile&) = delete;
  FstFile& operator=(const FstFile&) = delete;

  // Before the first change. Scopes nest; names have no spaces.
  void open_scope(const std::string& name);
  void close_scope();
  /// 1 to 64 bits.
  Signal add_bits(const std::string& name, unsigned width);
  Signal add_real(const std::string& name);
  Signal add_text(const std::string& name);

  void set(uint64_t picoseconds, Signal signal, uint64_t value);
  void set_real(uint64_t picoseconds, Signal signal, double value);
  void set_text(uint64_t picoseconds, Signal signal, const std::string& text);

  /// Writes the changes before a time; none may come later that lies there.
  void flush(uint64_t picoseconds);
  /// The last call; `picoseconds` is the end of the waves.
  std::optional<Error> finish(uint64_t picoseconds);

 private:
  enum class Kind : uint8_t { bits, real, text };
  struct Variable {
    uint32_t handle = 0;
    Kind kind = Kind::bits;
    unsigned width = 0;
    std::optional<std::string> last;
  };
  struct Change {
    Signal signal = 0;
    uint64_t bits = 0;  ///< a real number: its bit pattern
    std::string text;
  };

  FstFile(WaveFile file, void* writer);
  void announce(uint64_t picoseconds, Change change);
  void emit(const Change& change);
  Signal add(const std::string& name, Kind kind, unsigned width);

  WaveFile file_;
  void* writer_;
  std::vector<Variable> variables_;
  std::multimap<uint64_t, Change> waiting_;
};

}  // namespace capsoc::trace
