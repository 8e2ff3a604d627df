// Standard output and input, files, and nothing.
#pragma once

#include <cstdint>
#include <memory>

#include "base/result.h"
#include "host/descriptor.h"
#include "serial/character_backend.h"

namespace capsoc::serial {

/// Writes to a file; reads another one.
class FileBackend : public CharacterBackend {
 public:
  /// Output to `path`, which is replaced by the first write() or finish(); no input.
  static Result<std::unique_ptr<CharacterBackend>> to_file(const std::string& path,
                                                           const GiveUp& give_up);
  /// Output to stdout; input from stdin if `reads`.
  static std::unique_ptr<CharacterBackend> standard(bool reads, const GiveUp& give_up);
  static std::unique_ptr<CharacterBackend> standard_error(const GiveUp& give_up);
  static std::unique_ptr<CharacterBackend> null();

  void write(std::string_view bytes) override;
  std::string read() override;
  void finish() override;
  bool live() const override { return input_ != Input::none && input_ != Input::file; }
  std::string failure() const override { return failure_; }

 private:
  enum class Input : uint8_t { none, file, pipe, terminal };
  FileBackend(int output, host::Descriptor owned, std::string name, Input input, GiveUp give_up);
  bool wait_writable();
  void begin();

  int output_;  ///< -1: nowhere
  host::Descriptor owned_;
  std::string name_;
  Input input_;
  GiveUp give_up_;
  std::string failure_;
  bool untouched_ = false;  ///< a file of which nothing has been changed yet
};

}  // namespace capsoc::serial
