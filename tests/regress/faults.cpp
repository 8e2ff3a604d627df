#include <utility>

#include "coprocessor/register_map.h"
#include "faulty_model.h"

namespace capsoc::regress::test {

using namespace coprocessor;

namespace {

Fault write_fault(const char* name, const char* node, const char* what,
                  std::function<std::optional<Write>(Write)> write) {
  Fault fault{name, node, what};
  fault.write = std::move(write);
  return fault;
}

Fault read_fault(const char* name, const char* what,
                 std::function<uint32_t(uint32_t, uint32_t)> read) {
  Fault fault{name, "", what};
  fault.read = std::move(read);
  return fault;
}

Fault paper_fault(const char* name, const char* node, Options options) {
  Fault fault{name, node, "node"};
  fault.arithmetic = Arithmetic::paper;
  fault.options = options;
  return fault;
}

std::vector<Fault> make() {
  std::vector<Fault> list;
  const auto bit = [](uint32_t offset, uint32_t mask) {
    return [offset, mask](Write w) -> std::optional<Write> {
      if (w.offset == offset) w.value &= ~mask;
      return w;
    };
  };
  list.push_back(
      write_fault("a step lacks its lowest bit", "next_b_v (T3", "node", bit(reg_step_au + 16, 1)));
  list.push_back(write_fault("KP lacks a bit", "next_phase (T2", "node", bit(reg_loop, 1)));
  list.push_back(
      write_fault("KI lacks a bit", "next_frequency (T2", "node", bit(reg_loop, 1u << 12)));
  list.push_back(write_fault("PHI's sign is lost", "", "", bit(reg_phi, 1u << 31)));
  list.push_back(write_fault("the lock threshold lacks a bit", "", "LOCK_THRESHOLD",
                             bit(reg_lock_threshold, 1u << 20)));
  list.push_back(
      write_fault("FLAGS.ZERO cannot be cleared", "", "FLAGS", bit(reg_flags, flag_zero)));
  list.push_back(write_fault("CMD.CLEAR is forgotten", "", "EARLY_COUNT", bit(reg_cmd, cmd_clear)));
  list.push_back(write_fault("LOAD is forgotten", "", "idle", bit(reg_cmd, cmd_load)));
  list.push_back(
      write_fault("writes to a_u's low half are lost", "", "", [](Write w) -> std::optional<Write> {
        if (w.offset == reg_au_lo) return std::nullopt;
        return w;
      }));
  list.push_back(write_fault("the interrupt by LOCKCHG is never enabled", "", "interrupt line",
                             [](Write w) -> std::optional<Write> { return w; }));
  list.back().interrupt = [](bool) { return false; };
  list.push_back(read_fault("HI of c_v is sticky", "CV_HI", [](uint32_t offset, uint32_t value) {
    return offset == reg_cv_hi ? value | 1 : value;
  }));
  list.push_back(read_fault("LATENCY is one off", "LATENCY", [](uint32_t offset, uint32_t value) {
    return offset == reg_latency ? value + 1 : value;
  }));
  Fault lost_clip{"clip does not travel with the sample", "clip (T0", "node"};
  lost_clip.sample = [](int32_t&, int32_t&, bool& clip) { clip = false; };
  list.push_back(lost_clip);
  Fault low_bit{"v lacks its lowest bit", "v (T0", "node"};
  low_bit.sample = [](int32_t&, int32_t& v, bool&) { v &= ~1; };
  list.push_back(low_bit);
  // A line that follows the event and not the flag: one interrupt of each enable.
  constexpr std::pair<uint32_t, uint32_t> interrupts[] = {
      {flag_result, ctrl_ie_result}, {flag_lockchg, ctrl_ie_lock}, {flag_config, ctrl_ie_error},
      {flag_turn, ctrl_ie_turn},     {flag_alarm, ctrl_ie_alarm},  {flag_parity, ctrl_ie_safety}};
  for (const auto& [flag, enable] : interrupts) {
    Fault lost{"an interrupt that is enabled late is lost", "", "interrupt line"};
    lost.lost_flag = flag;
    lost.lost_enable = enable;
    list.push_back(lost);
  }
  for (unsigned strobes : {0b0000, 0b0001, 0b0111, 0b1110}) {
    Fault partial{"a partial write is taken", "", "response to the write of"};
    partial.taken_strobes |= 1u << strobes;
    list.push_back(partial);
  }
  list.push_back(paper_fault("steps shifted by one", "next_", {Arithmetic::paper, 32, 0, 1}));
  list.push_back(paper_fault("the reference leads", "sine (T2", {Arithmetic::paper, 32, 1, 0}));
  list.push_back(paper_fault("narrow arctangent", "relative (T1", {Arithmetic::paper, 24, 0, 0}));
  return list;
}

}  // namespace

const std::vector<Fault>& faults() {
  static const std::vector<Fault> list = make();
  return list;
}

}  // namespace capsoc::regress::test
