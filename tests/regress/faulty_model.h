// The coprocessor's model with one thing wrong, as an RTL might have it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coprocessor/coprocessor.h"
#include "coprocessor/register_map.h"

namespace capsoc::regress::test {

struct Write {
  uint32_t offset, value;
};

struct Fault {
  std::string name;
  /// What a report must say: the node that went wrong first, or, if no node did, what differed.
  std::string node, what;
  coprocessor::Arithmetic arithmetic = coprocessor::Arithmetic::precise;
  /// Each changes what goes in or comes out; empty: as it should be.
  std::function<std::optional<Write>(Write)> write = {};  // no value: the write is lost
  std::function<uint32_t(uint32_t offset, uint32_t value)> read = {};
  std::function<void(int32_t& u, int32_t& v, bool& clip)> sample = {};
  std::function<bool(bool)> interrupt = {};
  /// One flag, whose interrupt is lost if it is enabled only after the flag was raised.
  uint32_t lost_flag = 0, lost_enable = 0;
  /// Strobes with which a write is taken, whole; a bit for each of the 16 words of strobes.
  uint32_t taken_strobes = 1u << coprocessor::all_strobes;
  uint64_t delay = 0;  // edges by which samples come late
  coprocessor::Options options = {};
};

const std::vector<Fault>& faults();

class FaultyModel final : public coprocessor::Device {
 public:
  explicit FaultyModel(const Fault& fault) : fault_(fault), model_(options(fault)) {}

  void reset() override { model_.reset(); }
  void advance(uint64_t cycle) override { model_.advance(cycle); }
  std::optional<uint64_t> next_event() const override { return model_.next_event(); }
  bool submit(uint64_t cycle, int32_t u, int32_t v, bool clip) override {
    if (fault_.sample) fault_.sample(u, v, clip);
    return model_.submit(cycle + fault_.delay, u, v, clip);
  }
  coprocessor::RegisterAccess read(uint64_t cycle, uint32_t offset, bool debug) override {
    coprocessor::RegisterAccess access = model_.read(cycle, offset, debug);
    if (fault_.read && access.ok) access.value = fault_.read(offset, access.value);
    return access;
  }
  bool write(uint64_t cycle, uint32_t offset, uint32_t value) override {
    std::optional<Write> changed = Write{offset, value};
    if (fault_.write) changed = fault_.write(*changed);
    if (!changed) return true;
    const bool enabled = (peek(coprocessor::reg_ctrl) & fault_.lost_enable) != 0;
    const bool ok = model_.write(cycle, changed->offset, changed->value);
    if ((peek(coprocessor::reg_flags) & fault_.lost_flag) == 0) lost_ = false;
    const bool enables = (peek(coprocessor::reg_ctrl) & fault_.lost_enable) != 0;
    if (!enabled && enables && (peek(coprocessor::reg_flags) & fault_.lost_flag) != 0) lost_ = true;
    return ok;
  }
  bool write_bytes(uint64_t cycle, uint32_t offset, uint32_t value, uint8_t strobes) override {
    if ((fault_.taken_strobes >> strobes & 1) != 0) return write(cycle, offset, value);
    return model_.write_bytes(cycle, offset, value, strobes);
  }
  bool interrupt() const override {
    const bool level = model_.interrupt() && !(lost_ && alone());
    return fault_.interrupt ? fault_.interrupt(level) : level;
  }
  bool idle() const override { return model_.idle(); }
  const coprocessor::Nodes& nodes() const override { return model_.nodes(); }
  unsigned tick() const override { return model_.tick(); }
  bool stage_nodes(unsigned stage, coprocessor::Nodes& nodes) const override {
    return model_.stage_nodes(stage, nodes);
  }
  std::unique_ptr<Device> clone() const override { return std::make_unique<FaultyModel>(*this); }

 private:
  static coprocessor::Options options(const Fault& fault) {
    coprocessor::Options result = fault.options;
    result.arithmetic = fault.arithmetic;
    return result;
  }

  uint32_t peek(uint32_t offset) const { return model_.read(0, offset, true).value; }

  /// The lost interrupt would be the only one.
  bool alone() const {
    coprocessor::Coprocessor other = model_;
    other.write(0, coprocessor::reg_ctrl, peek(coprocessor::reg_ctrl) & ~fault_.lost_enable);
    return !other.interrupt();
  }

  Fault fault_;
  mutable coprocessor::Coprocessor model_;  // a debug read changes nothing
  bool lost_ = false;
};

}  // namespace capsoc::regress::test
