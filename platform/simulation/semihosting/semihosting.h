// Semihosting calls of the guest (BKPT 0xAB). Source: Arm, "Semihosting for AArch32 and AArch64"
// version 2.0: operation numbers, parameter blocks, results.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "semihosting/console.h"
#include "semihosting/guest_files.h"
#include "semihosting/guest_memory.h"

namespace capsoc::semihosting {

/// What SYS_HEAPINFO answers; 0: not known, the program uses its own.
struct HeapInfo {
  uint32_t heap_base = 0, heap_limit = 0, stack_base = 0, stack_limit = 0;
};

/// What the calls are answered with.
struct Environment {
  std::string command_line;  ///< SYS_GET_CMDLINE
  uint64_t epoch_s = 0;      ///< SYS_TIME at simulated time 0, seconds since 1970
  HeapInfo heap;
  std::function<uint64_t()> now_ns;  ///< simulated time
};

/// Answers every call. What the guest gets wrong (a pointer outside memory, a handle that is not
/// open, a length beyond reason) is -1 in r0 and a number for SYS_ERRNO, the host's errno values.
class Semihosting {
 public:
  Semihosting(GuestMemory& memory, GuestFiles files, Console& console, Environment environment);

  enum class Outcome {
    answered,
    ended,       ///< the guest ended the run
    asks_again,  ///< nothing has changed: the same call is made again when the console has input
  };
  /// `result`: what r0 becomes if the call is answered.
  Outcome call(uint32_t operation, uint32_t argument, uint32_t& result);

  /// The status that the guest ended with.
  int exit_status() const { return exit_status_; }

  /// Open files by name, size and position: their contents stay with the host.
  void visit(Archive& archive);
  /// What was written to open files since their state was saved is cut off.
  void restored();

 private:
  struct File {
    enum class Kind : uint8_t { console_in, console_out, features, host } kind = Kind::features;
    host::Descriptor descriptor;
    uint32_t position = 0;  ///< in features
    std::string name = {};  ///< of a host file, and how it was opened
    uint32_t mode = 0;
    uint64_t size = 0;  ///< of a host file when its state was loaded

    void visit(Archive& archive, const GuestFiles& files);
  };

  int64_t dispatch(uint32_t operation, uint32_t argument);
  int64_t open(uint32_t argument);
  int64_t close(uint32_t argument);
  int64_t write(uint32_t argument);
  int64_t read(uint32_t argument);
  int64_t seek(uint32_t argument);
  int64_t length(uint32_t argument);
  int64_t is_terminal(uint32_t argument);
  int64_t remove(uint32_t argument);
  int64_t rename(uint32_t argument);
  int64_t temporary_name(uint32_t argument);
  int64_t command_line(uint32_t argument);
  int64_t heap_info(uint32_t argument);
  int64_t elapsed(uint32_t argument);
  int64_t read_character();
  void write_text(uint32_t address);
  void end(uint32_t operation, uint32_t argument);

  template <std::size_t count>
  std::optional<std::array<uint32_t, count>> words(uint32_t address);
  std::optional<std::string> name_at(uint32_t address, uint32_t size);
  File* file(uint32_t handle);
  std::string take(File& file, std::size_t most, int& error);
  std::string read_console(std::size_t most);
  int64_t fail(int error);

  GuestMemory& memory_;
  GuestFiles files_;
  Console& console_;
  Environment environment_;
  std::map<uint32_t, File> open_;
  std::set<uint32_t> unknown_;  ///< operations that were warned of
  int errno_ = 0, exit_status_ = 0;
  bool asks_again_ = false;
};

}  // namespace capsoc::semihosting
