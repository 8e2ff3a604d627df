#include "debug/client.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "debug/description.h"
#include "debug/monitor.h"

namespace capsoc::debug {
namespace {

constexpr const char *ok = "OK", *malformed = "E01", *no_memory = "E0e", *refused = "E16";
constexpr int sigint = 2, sigtrap = 5, sigabrt = 6, sigsegv = 11;

/// What GDB's number means: one of `registers`, or two that are a double-precision one.
struct Numbered {
  unsigned first, count = 1;
};
std::optional<Numbered> numbered(uint32_t number) {
  if (number < 16) return Numbered{number};
  if (number < xpsr_number || number > fpscr_number) return std::nullopt;
  if (number == fpscr_number) return Numbered{first_fpu_register + fpu_singles};
  if (number >= first_double_number)
    return Numbered{first_fpu_register + 2 * (number - first_double_number), 2};
  return Numbered{number - xpsr_number + 16};
}

std::string little_endian(uint32_t value, unsigned bits) {
  std::string bytes;
  for (unsigned shift = 0; shift < bits; shift += 8) bytes += static_cast<char>(value >> shift);
  return to_hex(bytes);
}

/// Takes a register's bytes off the front of the digits.
std::optional<uint32_t> take_register(std::string_view& digits, unsigned bits) {
  const auto bytes = from_hex(digits.substr(0, bits / 4));
  if (!bytes || bytes->size() != bits / 8) return std::nullopt;
  digits.remove_prefix(bits / 4);
  uint32_t value = 0;
  for (unsigned i = 0; i < bytes->size(); ++i)
    value |= uint32_t{static_cast<uint8_t>((*bytes)[i])} << (8 * i);
  return value;
}

/// `address,length`.
std::optional<std::pair<uint32_t, uint32_t>> take_range(std::string_view& text) {
  const auto address = take_number(text);
  if (!address || !take(text, ",")) return std::nullopt;
  const auto length = take_number(text);
  if (!length) return std::nullopt;
  return std::pair{*address, *length};
}

}  // namespace

Client::~Client() {
  clear_stop_points();
}

void Client::clear_stop_points() {
  for (const auto& [kind, address, size] : stop_points_) target_.clear(kind, address, size);
  stop_points_.clear();
}

void Client::reply(std::string_view payload) {
  last_ = frame(payload);
  output_ += last_;
}

void Client::print(const std::string& text) {
  output_ += frame("O" + to_hex(text));
}

Request Client::handle(const Arrival& arrival) {
  switch (arrival.kind) {
    case Arrival::Kind::packet:
      if (!no_ack_) output_ += '+';
      return packet(arrival.payload);
    case Arrival::Kind::damaged:
      if (!no_ack_) output_ += '-';
      return {};
    case Arrival::Kind::interrupt:
      return {Request::Kind::halt};
    case Arrival::Kind::nak:
      if (!no_ack_) output_ += last_;
      return {};
    case Arrival::Kind::ack:
      return {};
  }
  return {};
}

std::string Client::stop_reply() const {
  int signal = sigtrap;
  std::string why;
  switch (cause_.kind) {
    case StopCause::Kind::interrupted:
      signal = sigint;
      break;
    case StopCause::Kind::lockup:
      signal = sigsegv;
      break;
    case StopCause::Kind::failure:
      signal = sigabrt;
      break;
    case StopCause::Kind::breakpoint:
      if (cause_.point == StopPoint::hardware_breakpoint) {
        if (knows_hwbreak_) why = "hwbreak:;";
      } else if (knows_swbreak_) {
        why = "swbreak:;";
      }
      break;
    case StopCause::Kind::watchpoint:
      why = fmt::format("{}:{:x};",
                        cause_.point == StopPoint::read_watchpoint     ? "rwatch"
                        : cause_.point == StopPoint::access_watchpoint ? "awatch"
                                                                       : "watch",
                        cause_.address);
      break;
    case StopCause::Kind::history_begin:
      why = "replaylog:begin;";
      break;
    case StopCause::Kind::history_end:
      why = "replaylog:end;";
      break;
    case StopCause::Kind::attached:
    case StopCause::Kind::step:
    case StopCause::Kind::bkpt_instruction:
      break;
  }
  std::string text = fmt::format("T{:02x}{}thread:1;", signal, why);
  for (const unsigned index : {13U, 14U, 15U})
    text += fmt::format("{:02x}:{};", index, little_endian(target_.read_register(index), 32));
  return text;
}

void Client::stopped(const StopCause& cause) {
  cause_ = cause;
  if (!waiting_) return;
  waiting_ = false;
  reply(stop_reply());
}

void Client::exited(int status) {
  if (!waiting_) return;
  waiting_ = false;
  reply(fmt::format("W{:02x}", status & 0xFF));
}

Request Client::wait_for(const Resume& how) {
  waiting_ = true;
  return {Request::Kind::resume, how};
}

Request Client::packet(std::string_view text) {
  if (text.empty()) {
    reply("");
    return {};
  }
  const char command = text.front();
  text.remove_prefix(1);
  switch (command) {
    case '?':
      reply(stop_reply());
      break;
    case 'g':
      read_registers();
      break;
    case 'G':
      write_registers(text);
      break;
    case 'p':
      read_register(text);
      break;
    case 'P':
      write_register(text);
      break;
    case 'm':
      read_memory(text);
      break;
    case 'M':
      write_memory(text, false);
      break;
    case 'X':
      write_memory(text, true);
      break;
    case 'Z':
      stop_point(text, true);
      break;
    case 'z':
      stop_point(text, false);
      break;
    case 'c':
    case 'C':
    case 's':
    case 'S':
      return resume({&command, 1});
    case 'b':
      return resume_back(text);
    case 'v':
      return v_packet(text);
    case 'D':
      reply(ok);
      return {Request::Kind::detach};
    case 'k':
      return {Request::Kind::kill};
    case '!':
      extended_ = true;
      reply(ok);
      break;
    case 'R':
      target_.reset();
      return {Request::Kind::halt};
    case 'H':
    case 'T':
      reply(ok);
      break;
    case 'Q':
      if (text == "StartNoAckMode") {
        reply(ok);
        no_ack_ = true;
      } else {
        reply("");
      }
      break;
    case 'q':
      if (take(text, "Rcmd,")) return monitor(text);
      query(text);
      break;
    default:
      reply("");
  }
  return {};
}

/// The first action is ours, since there is one thread. C and S carry a signal, which no bare
/// machine takes.
Request Client::resume(std::string_view text) {
  Resume how;
  const char action = text.empty() ? '\0' : text.front();
  text.remove_prefix(text.empty() ? 0 : 1);
  if (action == 's' || action == 'S') {
    how.kind = Resume::Kind::step;
  } else if (action == 'r') {
    const auto range = take_range(text);
    if (!range) {
      reply(malformed);
      return {};
    }
    how = {Resume::Kind::range, range->first, range->second};
  } else if (action == 't') {
    reply(ok);
    return {Request::Kind::halt};
  } else if (action != 'c' && action != 'C') {
    reply(malformed);
    return {};
  }
  return wait_for(how);
}

/// `bs` and `bc`.
Request Client::resume_back(std::string_view text) {
  if (!target_.has_history() || (text != "s" && text != "c")) {
    reply("");
    return {};
  }
  return wait_for({text == "s" ? Resume::Kind::step_back : Resume::Kind::run_back});
}

Request Client::v_packet(std::string_view text) {
  if (text == "Cont?") {
    reply("vCont;c;C;s;S;r;t");
  } else if (take(text, "Cont;")) {
    return resume(text);
  } else if (take(text, "Run")) {
    target_.reset();
    cause_ = {};
    reply(stop_reply());
    return {Request::Kind::halt};
  } else if (take(text, "Attach")) {
    reply(stop_reply());
    return {Request::Kind::halt};
  } else if (take(text, "Kill")) {
    reply(ok);
    return {extended_ ? Request::Kind::halt : Request::Kind::kill};
  } else {
    reply("");  // vMustReplyEmpty, and what a server need not know
  }
  return {};
}

Request Client::monitor(std::string_view hex) {
  const auto line = from_hex(hex);
  if (!line) {
    reply(malformed);
    return {};
  }
  if (const auto said = target_.command(*line)) {
    if (!said->empty()) print(*said);
    reply(ok);
    return {};
  }
  MonitorAnswer answer = answer_monitor(*line);
  if (answer.help) answer.text += target_.command_help();
  if (answer.reset) target_.reset();
  if (!answer.save.empty()) print(target_.save(answer.save));
  if (answer.stimulus_ports != 0)
    if (const std::string said = target_.show_stimulus(answer.stimulus_ports, answer.stimulus_on);
        !said.empty())
      print(said);
  if (!answer.text.empty()) print(answer.text);
  reply(ok);
  if (answer.halt) return {Request::Kind::halt};
  // The console does not wait for a stop: GDB stays where it is.
  if (answer.resume) return {Request::Kind::resume};
  return {};
}

void Client::query(std::string_view text) {
  if (take(text, "Supported")) return features(text);
  if (take(text, "Xfer:")) return transfer(text);
  if (take(text, "CRC:")) return memory_crc(text);
  if (text == "fThreadInfo") return reply("m1");
  if (text == "sThreadInfo") return reply("l");
  if (take(text, "ThreadExtraInfo,")) return reply(to_hex(target_.state()));
  if (text == "C") return reply("QC1");
  if (take(text, "Attached")) return reply("1");  // quitting detaches, and the run continues
  if (take(text, "Symbol:")) return reply(ok);
  if (take(text, "MemoryRegionInfo:")) {
    const auto address = take_number(text);
    return reply(address ? region_info(target_.memory_ranges(), *address) : malformed);
  }
  reply("");
}

void Client::features(std::string_view theirs) {
  knows_swbreak_ = theirs.find("swbreak+") != std::string_view::npos;
  knows_hwbreak_ = theirs.find("hwbreak+") != std::string_view::npos;
  reply(
      fmt::format("PacketSize={:x};QStartNoAckMode+;qXfer:features:read+;qXfer:memory-map:read+;"
                  "qXfer:threads:read+;vContSupported+;swbreak+;hwbreak+{}",
                  largest_packet, target_.has_history() ? ";ReverseStep+;ReverseContinue+" : ""));
}

/// object:read:annex:offset,length
void Client::transfer(std::string_view text) {
  std::string document;
  if (take(text, "features:read:target.xml:")) {
    document = target_description(target_);
  } else if (take(text, "memory-map:read::")) {
    document = memory_map(target_.memory_ranges());
  } else if (take(text, "threads:read::")) {
    document = thread_list(target_);
  } else if (take(text, "features:read:")) {
    return reply("E00");  // no such annex
  } else {
    return reply("");
  }
  const auto range = take_range(text);
  if (!range) return reply("E00");
  const std::size_t offset = std::min<std::size_t>(range->first, document.size());
  const std::size_t length = std::min<std::size_t>(range->second, largest_packet / 2);
  const std::string part = document.substr(offset, length);
  reply((offset + part.size() < document.size() ? "m" : "l") + part);
}

/// CRC-32 of GDB's compare-sections: polynomial 0x04C11DB7, most significant bit first, start -1.
void Client::memory_crc(std::string_view text) {
  constexpr uint32_t most = 16U << 20U;
  const auto range = take_range(text);
  if (!range || range->second > most) return reply(malformed);
  const std::string bytes = target_.read_memory(range->first, range->second);
  if (bytes.size() != range->second) return reply(no_memory);
  uint32_t crc = 0xFFFFFFFF;
  for (const char c : bytes) {
    crc ^= uint32_t{static_cast<uint8_t>(c)} << 24U;
    for (int bit = 0; bit < 8; ++bit) crc = crc << 1U ^ ((crc >> 31U) != 0 ? 0x04C11DB7U : 0U);
  }
  reply(fmt::format("C{:x}", crc));
}

void Client::read_registers() {
  std::string text;
  for (unsigned i = 0; i < registers.size(); ++i)
    if (target_.has_register(i)) text += little_endian(target_.read_register(i), registers[i].bits);
  reply(text);
}

void Client::write_registers(std::string_view hex) {
  std::array<uint32_t, registers.size()> values{};
  for (unsigned i = 0; i < registers.size(); ++i) {
    if (!target_.has_register(i)) continue;
    const auto value = take_register(hex, registers[i].bits);
    if (!value) return reply(malformed);
    values[i] = *value;
  }
  // Only what is new: sp shows one of msp and psp, which come later.
  for (unsigned i = 0; i < registers.size(); ++i)
    if (target_.has_register(i) && values[i] != target_.read_register(i))
      target_.write_register(i, values[i]);
  reply(ok);
}

void Client::read_register(std::string_view text) {
  const auto number = take_number(text);
  const auto found = number ? numbered(*number) : std::nullopt;
  if (!found || !target_.has_register(found->first)) return reply(malformed);
  std::string value;
  for (unsigned i = found->first; i < found->first + found->count; ++i)
    value += little_endian(target_.read_register(i), registers[i].bits);
  reply(value);
}

void Client::write_register(std::string_view text) {
  const auto number = take_number(text);
  const auto found = number ? numbered(*number) : std::nullopt;
  if (!found || !target_.has_register(found->first) || !take(text, "=")) return reply(malformed);
  std::array<uint32_t, 2> values{};
  for (unsigned i = 0; i < found->count; ++i) {
    const auto value = take_register(text, registers[found->first + i].bits);
    if (!value) return reply(malformed);
    values.at(i) = *value;
  }
  for (unsigned i = 0; i < found->count; ++i)
    target_.write_register(found->first + i, values.at(i));
  reply(ok);
}

void Client::read_memory(std::string_view text) {
  const auto range = take_range(text);
  if (!range) return reply(malformed);
  const uint32_t size = std::min<uint32_t>(range->second, largest_packet / 2 - 1);
  const std::string bytes = target_.read_memory(range->first, size);
  if (bytes.empty() && size != 0) return reply(no_memory);
  reply(to_hex(bytes));
}

void Client::write_memory(std::string_view text, bool binary) {
  const auto range = take_range(text);
  if (!range || !take(text, ":")) return reply(malformed);
  const auto bytes = binary ? std::optional<std::string>(text) : from_hex(text);
  if (!bytes || bytes->size() != range->second) return reply(malformed);
  if (bytes->empty()) return reply(ok);  // GDB asks whether X is known
  reply(target_.write_memory(range->first, *bytes) ? ok : no_memory);
}

/// kind,address,size; of a breakpoint the size is the length of the instruction, of which LLDB says
/// another one when it removes it.
void Client::stop_point(std::string_view text, bool insert) {
  const auto number = take_number(text);
  if (number && *number > 4) return reply("");
  if (!number || !take(text, ",")) return reply(malformed);
  const auto range = take_range(text);
  if (!range) return reply(malformed);
  const auto kind = static_cast<StopPoint>(*number);
  const uint32_t size = *number < 2 ? 0 : range->second;
  const std::tuple key{kind, range->first, size};
  const bool known = stop_points_.count(key) != 0;
  if (insert && !known) {  // a repeated packet changes nothing
    constexpr std::size_t most = 1024;
    if (stop_points_.size() >= most || !target_.set(kind, range->first, size))
      return reply(refused);
    stop_points_.insert(key);
  } else if (!insert && known) {
    target_.clear(kind, range->first, size);
    stop_points_.erase(key);
  }
  reply(ok);
}

}  // namespace capsoc::debug
