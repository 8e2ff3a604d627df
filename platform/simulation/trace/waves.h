// Waves of the SoC: interrupts, bus transfers, exceptions and the coprocessor's nodes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "coprocessor/device.h"
#include "soc/soc.h"
#include "trace/bus_trace.h"
#include "trace/fst_file.h"

namespace capsoc::trace {

/// One FST file of whatever stands at the coprocessor's bus target, and a save file for GTKWave
/// next to it (FILE.gtkw). Every fixed-point node is there twice: its word, and its value as a real
/// number, since GTKWave's own fixed-point display ends at 30 fraction bits.
class Waves {
 public:
  /// `soc` must outlive it.
  Waves(std::unique_ptr<FstFile> file, std::string path, soc::Soc& soc);

  /// A line's level goes to the file while this is true; what changed meanwhile follows at once.
  void open(bool on, uint64_t picoseconds);

  /// The trace begins here, in the middle of a program that executes this exception's handler (0:
  /// none).
  void begin(uint64_t picoseconds, unsigned exception);

  void transfer(uint64_t begin_ps, uint64_t end_ps, const BusAccess& access);
  void exception(uint64_t picoseconds, unsigned number);
  void result(uint64_t picoseconds, const coprocessor::Nodes& nodes);
  std::optional<Error> finish(uint64_t picoseconds);

 private:
  struct Line {
    FstFile::Signal signal = 0;
    std::string name;
    const kit::InterruptLine* source = nullptr;
    bool level = false;
  };
  struct Node {
    const coprocessor::NamedNode* node = nullptr;
    FstFile::Signal word = 0, value = 0;
    std::string path;  ///< of the signal to show

    bool has_value() const { return node->format.meaning != coprocessor::Meaning::word; }
  };

  void add_interrupts();
  void add_bus();
  void add_nodes();
  void line(std::size_t index, bool level);
  std::string save_text() const;

  std::unique_ptr<FstFile> file_;
  std::string path_;
  soc::Soc& soc_;
  std::vector<Line> lines_;
  std::vector<Node> nodes_;
  FstFile::Signal exception_ = 0, exception_name_ = 0;
  FstFile::Signal active_ = 0, initiator_ = 0, address_ = 0, data_ = 0, size_ = 0, write_ = 0,
                  status_ = 0, commits_ = 0;
  unsigned exception_number_ = 0;
  bool open_ = true;
};

}  // namespace capsoc::trace
