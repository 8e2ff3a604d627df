#include "armv7m/executors/translator/device_calls.h"

#include <utility>

#include "armv7m/isa/flag_liveness.h"
#include "armv7m/machine.h"

namespace capsoc::armv7m {

using namespace asmjit;

namespace {

// An access for C++, in one word: its size, the flags that its block still inherits, and the cycles
// of the block before it.
constexpr unsigned flags_at = 8, cycles_at = 16;
uint32_t packed(const Step& step, unsigned size, uint8_t inherited) {
  return size | uint32_t{inherited} << flags_at | uint32_t{step.cycles_before} << cycles_at;
}
unsigned size_of(uint32_t how) {
  return how & 0xFF;
}
uint32_t cycles_before(uint32_t how) {
  return how >> cycles_at;
}

/// Computes what the block before left uncomputed and this one has not set.
void settle_inherited(HostContext& context, State& state, uint32_t how) {
  const auto inherited = static_cast<uint8_t>(how >> flags_at);
  FlagSources left = context.recipes[std::exchange(context.recipe, 0)];
  if ((inherited & flag::nz) == 0) left.nz = {};
  if ((inherited & flag::c) == 0) left.c = {};
  if ((inherited & flag::v) == 0) left.v = {};
  left.settle(state, context.aside, {});
}

/// The bit of an answer that says that the access was made; a load's value is below it.
constexpr unsigned made_bit = 32;
constexpr uint64_t made = uint64_t{1} << made_bit;

/// Makes the access with the state as the device may see it, and counts what it took.
template <typename Access>
uint64_t at_once(Machine& cpu, uint32_t how, const Access& access) {
  HostContext& context = cpu.host_context;
  context.count(cpu.state);
  if (context.recipe != 0) settle_inherited(context, cpu.state, how);
  const uint64_t before = cpu.state.cycles;
  const uint64_t answer = access();
  // A request of the access is looked at between two instructions: the edge after it leaves then.
  if (cpu.requests.any())
    context.set_left(-1);
  else
    context.set_left(context.left - static_cast<int64_t>(cpu.state.cycles - before));
  return answer;
}

uint64_t load(Machine& cpu, uint32_t address, uint32_t instruction, uint32_t how) {
  return at_once(cpu, how, [&]() -> uint64_t {
    uint32_t value = 0;
    return cpu.memory.load_at_once({instruction, cycles_before(how), address, size_of(how)}, value)
               ? made | value
               : 0;
  });
}

uint64_t store(Machine& cpu, uint32_t address, uint32_t instruction, uint32_t how, uint32_t value) {
  return at_once(cpu, how, [&]() -> uint64_t {
    return cpu.memory.store_at_once({instruction, cycles_before(how), address, size_of(how)}, value)
               ? made
               : 0;
  });
}

}  // namespace

DeviceCalls::DeviceCalls(const Machine& machine, HostContext& context, HostCode& code,
                         RegisterMap& registers, FlagTracker& flags, BlockEdges& edges)
    : machine_(machine),
      context_(context),
      code_(code),
      registers_(registers),
      flags_(flags),
      edges_(edges) {
  context.load_at_once = load;
  context.store_at_once = store;
}

bool DeviceCalls::has_call(const Step& step, uint32_t address) const {
  const bool is_plain = step.addressing == Addressing::offset || step.addressing == Addressing::reg;
  const bool is_conditional =
      step.condition != condition_always || step.it_before != 0 || step.it_after != 0;
  return is(step, kind::load | kind::store) && is_plain && !is_conditional && step.rd != 15 &&
         machine_.counts == nullptr && MemoryAccess::is_device(address);
}

Label DeviceCalls::call(const Step& step, const Move& move) {
  calls_.push_back({a_.newLabel(), edges_.exit_at(step), &step, move, flags_.before_step()});
  return calls_.back().entry;
}

void DeviceCalls::emit() {
  if (!calls_.empty()) code_.list_line("devices");
  for (const Call& call : calls_) emit_call(call);
}

/// Writes the flags of this block to the state: the device may see them, and the next block finds
/// them there. Those that it still inherits are left to C++; returns which these are.
uint8_t DeviceCalls::settle_flags(const Call& call) {
  flags_.restore(call.flags);
  const FlagSources& sources = flags_.sources();
  const auto inherited = [](const FlagSource& source, uint8_t bit) {
    return source.of == FlagSource::Of::inherited ? bit : 0;
  };
  const auto all =
      static_cast<uint8_t>(inherited(sources.nz, flag::nz) | inherited(sources.c, flag::c) |
                           inherited(sources.v, flag::v));
  if (!sources.any_pending()) return all;
  a_.mov(code_.context(&context_.place), x86::rax);
  flags_.settle_all();
  a_.mov(x86::rax, code_.context(&context_.place));
  return all;
}

void DeviceCalls::emit_call(const Call& call) {
  const uint32_t lost = RegisterMap::changed_by_calls();
  a_.bind(call.entry);
  const uint8_t inherited = settle_flags(call);
  registers_.store_all();
  a_.mov(code_.context(&context_.budget), x86::r15);
  if (call.move.store) a_.mov(x86::r8d, registers_.in_state(call.move.rd));
  a_.lea(x86::rdi, code_.context(&machine_));
  a_.mov(x86::esi, x86::eax);
  a_.mov(x86::edx, call.step->address);
  a_.mov(x86::ecx, packed(*call.step, call.move.size, inherited));
  a_.sub(x86::rsp, 8);  // calls want a stack of 16-byte units
  if (call.move.store)
    a_.call(code_.context(&context_.store_at_once));
  else
    a_.call(code_.context(&context_.load_at_once));
  a_.add(x86::rsp, 8);
  a_.mov(x86::r15, code_.context(&context_.budget));
  registers_.load(lost);
  a_.bt(x86::rax, made_bit);
  a_.jnc(call.exit);
  if (!call.move.store) {
    const Gp to = registers_.destination(call.move.rd, x86::eax);
    if (call.move.is_signed && call.move.size == 1)
      a_.movsx(to, x86::al);
    else if (call.move.is_signed)
      a_.movsx(to, x86::ax);
    else if (to != x86::eax)
      a_.mov(to, x86::eax);
    registers_.written(call.move.rd, to);
  }
  edges_.emit_edge_behind_device(*call.step);
}

}  // namespace capsoc::armv7m
