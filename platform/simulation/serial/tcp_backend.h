// A UART on a TCP port of the loopback interface.
#pragma once

#include <memory>

#include "base/result.h"
#include "host/loopback.h"
#include "serial/stream_backend.h"

namespace capsoc::serial {

/// One client at a time; the next one is served when the present one has closed. One that closed
/// its sending direction only (`nc -N`) still gets everything, until another one asks.
class TcpBackend : public StreamBackend {
 public:
  /// Port 0 takes a free one. `option` begins the sentence of an error.
  static Result<std::unique_ptr<CharacterBackend>> open(uint16_t port, const std::string& option,
                                                        GiveUp give_up);

  void finish() override;
  std::string place() const override;

 private:
  TcpBackend(host::Listener listener, GiveUp give_up);
  int client() override;
  ssize_t put(int descriptor, std::string_view bytes) override;
  ssize_t get(int descriptor, std::string& bytes) override;
  void lost() override { client_.reset(); }
  void input_ended() override { half_closed_ = true; }

  host::Listener listener_;
  host::Descriptor client_;
  bool half_closed_ = false;
};

}  // namespace capsoc::serial
