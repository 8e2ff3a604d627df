// One debugger's GDB remote protocol: packets in, packets out. Independent of sockets and threads.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "debug/packet.h"
#include "debug/target.h"

namespace capsoc::debug {

/// Request of a packet to the component that runs the processor.
struct Request {
  enum class Kind : uint8_t {
    none,
    resume,  ///< and send a stop reply when it halts again
    halt,
    detach,
    kill
  };
  Kind kind = Kind::none;
  Resume resume = {};
};

/// State of one debugger's connection. Invalid packets have no effect beyond what the protocol
/// says.
class Client {
 public:
  explicit Client(Target& target) : target_(target) {}
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Answers a packet. The bytes to send, acknowledgement included, are left in output().
  Request handle(const Arrival& arrival);
  /// Sends the stop reply to a resume, if one is outstanding.
  void stopped(const StopCause& cause);
  /// The program ended with this status.
  void exited(int status);
  /// Sends text to the debugger's console, while a stop reply is outstanding.
  void print(const std::string& text);

  /// True while a resume has not been answered.
  bool waiting() const { return waiting_; }
  void set_cause(const StopCause& cause) { cause_ = cause; }
  std::string take_output() { return std::exchange(output_, {}); }
  bool no_ack() const { return no_ack_; }

 private:
  Request packet(std::string_view text);
  Request resume(std::string_view text);
  Request resume_back(std::string_view text);
  Request v_packet(std::string_view text);
  Request monitor(std::string_view hex);
  void query(std::string_view text);
  void features(std::string_view theirs);
  void transfer(std::string_view text);
  void memory_crc(std::string_view text);
  void read_registers();
  void write_registers(std::string_view hex);
  void read_register(std::string_view text);
  void write_register(std::string_view text);
  void read_memory(std::string_view text);
  void write_memory(std::string_view text, bool binary);
  void stop_point(std::string_view text, bool insert);
  void reply(std::string_view payload);
  std::string stop_reply() const;
  Request wait_for(const Resume& how);
  void clear_stop_points();

  Target& target_;
  std::string output_, last_;
  StopCause cause_;
  bool no_ack_ = false, waiting_ = false, extended_ = false;
  bool knows_swbreak_ = false, knows_hwbreak_ = false;
  std::set<std::tuple<StopPoint, uint32_t, uint32_t>> stop_points_;
};

}  // namespace capsoc::debug
