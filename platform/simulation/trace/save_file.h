// What GTKWave shows of a wave file: a save file (.gtkw) next to it.
#pragma once

#include <cstdint>
#include <string>

namespace capsoc::trace {

/// Next to a wave file: its name with .gtkw.
std::string save_file(const std::string& waves);

/// The text of one, from the top of the window to its bottom.
class SaveText {
 public:
  enum class Radix { binary, hexadecimal, ascii, real };

  explicit SaveText(const std::string& waves);

  /// Groups may be folded by a click.
  void begin_group(const std::string& name);
  void end_group(const std::string& name);
  /// `path`: below all scopes, with the range of bits if there are several.
  void add(Radix radix, const std::string& path);
  /// The same as a curve, three lines high.
  void add_curve(Radix radix, const std::string& path);
  /// A marker at `time`, in units of the file; `units` of these around it are visible.
  void show_around(uint64_t time, uint64_t units);

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace capsoc::trace
