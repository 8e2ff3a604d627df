// The guest's console, `:tt`.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/archive.h"
#include "serial/character_backend.h"

namespace capsoc::semihosting {

/// Text in lines to the host; text from the host, for which the simulation waits.
class Console {
 public:
  Console(std::unique_ptr<serial::CharacterBackend> backend, serial::GiveUp give_up)
      : backend_(std::move(backend)), give_up_(std::move(give_up)) {}

  void write(std::string_view text);
  void flush();
  /// At the end of the run: everything is delivered.
  void finish();
  /// Why text was lost, a sentence; empty if none was.
  std::string failure() const { return backend_->failure(); }
  /// 1 to `most` bytes of a line; empty at the end of the input. Nothing: a client was asked for
  /// input, the guest's read has to be repeated.
  std::optional<std::string> read(std::size_t most);
  /// The rest of a line of which the guest has read a part.
  void visit(Archive& archive) { archive("incoming", incoming_); }

 private:
  bool refill();

  std::unique_ptr<serial::CharacterBackend> backend_;
  serial::GiveUp give_up_;
  std::string pending_, incoming_;
};

}  // namespace capsoc::semihosting
