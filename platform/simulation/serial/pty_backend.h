// A UART on a pseudo-terminal.
#pragma once

#include <memory>
#include <string>

#include "base/result.h"
#include "host/descriptor.h"
#include "serial/stream_backend.h"

namespace capsoc::serial {

/// A pseudo-terminal in raw mode: every byte passes unchanged. The process that opens the terminal
/// is the client, until it closes it.
class PtyBackend : public StreamBackend {
 public:
  /// `link`: a symbolic link to the terminal, there as long as the backend; empty: none. A stale
  /// one is replaced; anything else of that name is an Error.
  static Result<std::unique_ptr<CharacterBackend>> open(const std::string& link, GiveUp give_up);
  ~PtyBackend() override;

  void finish() override;
  std::string place() const override { return link_.empty() ? terminal_ : link_; }

 private:
  PtyBackend(host::Descriptor master, std::string terminal, GiveUp give_up);
  int client() override;
  int source() override { return master_.get(); }
  ssize_t put(int descriptor, std::string_view bytes) override;
  ssize_t get(int descriptor, std::string& bytes) override;
  int unread() const;

  host::Descriptor master_;
  std::string terminal_, link_;
};

}  // namespace capsoc::serial
