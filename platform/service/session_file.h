// A recorded session as a file: settings, the files that they name by content, every input with its
// instant, and what the state was on the way and at the end.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/result.h"
#include "service/history.h"
#include "service/message.h"

namespace capsoc::service {

struct SessionFile {
  /// The format's version; another one is refused.
  static constexpr int version = 1;
  /// Of a file, and of what it is made of: more is refused before it is believed.
  static constexpr std::size_t largest = std::size_t{1} << 30,
                               largest_header = std::size_t{64} << 20;
  static constexpr std::size_t most_files = 64, most_marks = 4096, longest_name = 200;

  /// A file that a setting names.
  struct Content {
    std::string setting, name;  ///< the name without folders
    std::string bytes;
  };
  /// The parts of the state at a position, by name: the hash of each.
  struct Mark {
    Position at;
    std::map<std::string, std::string> parts;
  };
  struct Text {
    uint64_t bytes = 0;
    std::string sha256;
  };

  std::string written_by;                       ///< for people: version and commit of the program
  std::map<std::string, std::string> settings;  ///< those that are not files
  std::vector<Content> files;
  uint64_t begin_ps = 0;  ///< simulated time of its beginning; not in the file, whose state has it
  std::string state;      ///< where it begins, as Board::Snapshot::to_bytes(); "": out of reset
  std::vector<Input> inputs;  ///< in the order of their positions
  std::vector<Mark> marks;    ///< likewise; the last one is the end
  std::vector<Text> uarts;    ///< what each sent until the end
};

/// The bytes of a file and back. `file` begins the sentence of an error: no session, another
/// version, damaged, or cut off.
std::string pack(const SessionFile& session);
Result<SessionFile> unpack_session(const std::string& bytes, const std::string& file);

}  // namespace capsoc::service
