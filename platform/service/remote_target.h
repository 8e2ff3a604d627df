// A simulation of a session as the debugger's protocol sees it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "debug/target.h"
#include "service/session_client.h"

namespace capsoc::service {

class RemoteTarget final : public debug::Target {
 public:
  /// `say`: text for the debugger's console, which was not requested.
  RemoteTarget(SessionClient& session, uint64_t simulation,
               std::function<void(const std::string&)> say)
      : session_(session), simulation_(simulation), say_(std::move(say)) {}

  std::string processor() override;
  bool has_register(unsigned index) override;
  uint32_t read_register(unsigned index) override;
  void write_register(unsigned index, uint32_t value) override;
  std::string read_memory(uint32_t address, uint32_t size) override;
  bool write_memory(uint32_t address, const std::string& bytes) override;
  bool set(debug::StopPoint kind, uint32_t address, uint32_t size) override;
  void clear(debug::StopPoint kind, uint32_t address, uint32_t size) override;
  void reset() override;
  std::string save(const std::string& file) override;
  std::string state() override;
  std::vector<debug::MemoryRange> memory_ranges() override;
  std::string show_stimulus(uint32_t ports, bool on) override;
  bool has_history() const override { return true; }
  std::optional<std::string> command(const std::string& line) override;
  std::string command_help() const override;

  /// What is set, for debugger.resume and debugger.reverse.
  Json points() const;
  /// The simulation is about to be somewhere else.
  void forget() { registers_.reset(); }
  Answer ask(const std::string& method, Json parameters);

 private:
  using Words = std::vector<std::string>;
  Answer change(const std::string& method, Json parameters);
  void change_or_say(const std::string& method, Json parameters);
  std::string when();
  std::string go_to(const Words& words);
  std::string jump(const std::string& method, Json parameters);
  std::string histories(const Words& words);
  std::string last_write(const Words& words);
  std::string last_change(const Words& words);
  std::string timeline(const Words& words);
  std::string why(const Words& words);
  std::string differences(const Words& words);
  std::string record(const Words& words);

  SessionClient& session_;
  uint64_t simulation_;
  std::function<void(const std::string&)> say_;
  /// Nothing: the processor does not have it.
  using Registers = std::array<std::optional<uint32_t>, debug::registers.size()>;
  const Registers& read_registers();

  std::optional<Registers> registers_;
  std::string processor_;
  std::vector<debug::MemoryRange> ranges_;
  std::map<std::tuple<debug::StopPoint, uint32_t, uint32_t>, unsigned> points_;  ///< how often set
};

}  // namespace capsoc::service
