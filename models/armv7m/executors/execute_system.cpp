#include "armv7m/executors/execute.h"
#include "armv7m/isa/unpredictable.h"

namespace capsoc::armv7m {

const Executors* Execute::system_executors(const DecodedOp& op) {
  switch (op.operation) {
#define ONE(name)       \
  case Operation::name: \
    return &both<name>;
    // A table of cases, which the formatter indents again each time.
    // clang-format off
    ONE(coprocessor)
    ONE(nop)
    ONE(it)
    ONE(svc)
    ONE(bkpt)
    ONE(cps)
    ONE(mrs)
    ONE(msr)
    ONE(wfi)
    ONE(wfe)
    ONE(sev)
    ONE(barrier)
    ONE(isb)
    ONE(fall_through)
    // clang-format on
#undef ONE
    default:
      return &both<undefined>;
  }
}

const Executors* Execute::unconditional(const DecodedOp& op) {
  if (const Executors* e = data_executors(op)) return e;
  if (const Executors* e = memory_executors(op)) return e;
  if (const Executors* e = branch_executors(op)) return e;
  if (const Executors* e = dsp_executors(op)) return e;
  if (const Executors* e = fp_executors(op)) return e;
  return system_executors(op);
}

/// SP[1:0] read as zero (B1.4.7), so whatever writes R13 ends here.
bool Execute::align_sp(Machine& cpu, const Step& op) {
  bool go_on = unconditional(op)->one(cpu, op);
  if ((cpu.state.r[13] & 3) != 0) cpu.report(Unpredictable::stack_pointer_bits, op.address);
  cpu.state.r[13] &= ~3u;
  return go_on;
}

/// What unpredictable.def chooses for an encoding: that of the operation itself, with R15 as the
/// PC reads.
bool Execute::unpredictable(Machine& cpu, const Step& op) {
  cpu.report(*unpredictable_encoding(op), op.address);
  cpu.state.r[15] = pc_of(op);
  bool go_on = unconditional(op)->one(cpu, op);
  cpu.state.r[13] &= ~3u;
  return go_on;
}

bool Execute::conditional(Machine& cpu, const Step& op) {
  if (cpu.state.condition_passed(op.condition)) return op.body->one(cpu, op);
  cpu.state.cycles -= op.cycles - 1u;  // skipped in one cycle
  if (cpu.counts != nullptr) cpu.counts->skipped(op);
  return true;
}

const Step* Execute::conditional_chain(Machine& cpu, const Step* op) {
  if (cpu.state.condition_passed(op->condition)) return op->body->chain(cpu, op);
  cpu.state.cycles -= op->cycles - 1u;
  return go_on(cpu, op + 1);
}

namespace {
/// Moves of SP by whole words keep it aligned.
bool keeps_sp_aligned(const DecodedOp& op) {
  bool add = op.operation == Operation::add_imm || op.operation == Operation::sub_imm;
  return add && op.rn == 13 && (op.imm & 3) == 0;
}
}  // namespace

void Execute::bind(Step& step) {
  // BKPT is unconditional even inside an IT block (A7.7.17), and IT itself opens one.
  if (step.operation == Operation::bkpt || step.operation == Operation::it)
    step.condition = condition_always;
  step.body = unconditional(step);
  const bool names_sp =
      step.rd == 13 || step.ra == 13 || (step.writeback && step.rn == 13 && (step.imm & 3) != 0);
  const bool writes_sp = names_sp && !is(step, kind::any_branch | kind::system);
  if (writes_sp && !keeps_sp_aligned(step)) step.body = &both<align_sp>;
  if (unpredictable_encoding(step)) step.body = &both<unpredictable>;
  step.chain = step.condition == condition_always ? step.body->chain : conditional_chain;
}

const Step* Execute::counted_chain(Machine& cpu, const Step* op) {
  if (one(cpu, *op)) return go_on(cpu, op + 1);
  cpu.count(*op);
  return BlockLinks::leave(cpu, *op);
}

void Execute::bind_counted(Step& step) {
  if (ends_block(step) || is(step, kind::any_branch) || step.condition != condition_always)
    step.chain = counted_chain;
}

void Execute::bind_in_block(Step& step, bool flags_dead, const Step* next) {
  if (step.body == &both<align_sp> || step.body == &both<unpredictable>) return;
  if (step.condition != condition_always || step.it_after != 0) return;
  if (Chain linked = linked_branch_chain(step)) {
    step.chain = linked;
  } else if (flags_dead) {
    DecodedOp quiet = step;
    quiet.set_flags = false;
    step.chain = data_executors(quiet)->chain;
  } else if (next != nullptr) {
    if (Chain fused = compare_and_branch_chain(step, *next)) step.chain = fused;
  }
}

void Execute::add_cycles(const CoreContext& context, Step& step, uint16_t before,
                         uint32_t wait_states) {
  const bool folded = timing::folds(before, step) && context.state.scb.folds_it();
  const int paired = folded ? 0 : step.cycles + timing::pairing(before, step);
  const uint32_t fetch = wait_states * timing::words_fetched(step.address, step.size);
  step.cycles = static_cast<uint8_t>(static_cast<uint32_t>(paired) + fetch);
  step.trail = context.profile.timing.three_stages ? timing::trail_of(step) : timing::no_trail;
}

uint32_t Execute::most_extra_cycles(const DecodedOp& op, uint32_t largest_wait) {
  // A save that is due may come on top of what VLDM and VSTM transfer.
  if (is(op, kind::fp_extension))
    return timing::most_fp_save + (Fpu::registers + timing::most_fp_save) * largest_wait;
  if (is(op, kind::divide)) return timing::divide_most;
  if (op.by_operands) return timing::long_multiply_most;
  const unsigned transfers = is(op, kind::multiple) ? 16 : 4;
  return is(op, kind::transfer) ? transfers * (largest_wait + 1) : 0;
}

bool Execute::undefined(Machine& cpu, const Step& op) {
  return cpu.fault(op, Cause::undefined_instruction);
}
bool Execute::coprocessor(Machine& cpu, const Step& op) {
  return cpu.fault(op, Cause::no_coprocessor);
}
bool Execute::nop(Machine&, const Step&) {
  return true;
}
bool Execute::it(Machine&, const Step&) {
  return true;
}  // its effect is in what was decoded after it
bool Execute::barrier(Machine&, const Step&) {
  return true;
}
bool Execute::isb(Machine& cpu, const Step& op) {
  return cpu.leave(op);
}

bool Execute::fall_through(Machine& cpu, const Step& op) {
  cpu.state.pc = op.address;
  return false;
}

bool Execute::svc(Machine& cpu, const Step& op) {
  cpu.event.kind = Event::Kind::svc;
  return cpu.leave(op);
}

bool Execute::bkpt(Machine& cpu, const Step& op) {
  cpu.event = {Event::Kind::bkpt, Cause{}, op.imm, op.address};
  return cpu.leave(op);
}

// imm: bit 2 disables, bit 1 is PRIMASK, bit 0 FAULTMASK; nothing happens without privilege
// (B5.2.1).
bool Execute::cps(Machine& cpu, const Step& op) {
  bool disable = (op.imm & 4) != 0;
  if (cpu.state.privileged()) {
    if (op.imm & 2) cpu.state.primask = disable ? 1 : 0;
    if ((op.imm & 1) && (!disable || cpu.pending.execution_priority() > -1))
      cpu.state.faultmask = disable ? 1 : 0;
    cpu.requests.raise(Requests::changed);
  }
  return cpu.leave(op);
}

namespace {
/// The special register; one that the core lacks is as one that no core has.
uint32_t sysm(const DecodedOp& op) {
  constexpr uint32_t none = 0xFF;
  return op.unallocated ? none : op.encoding & 0xFF;
}

constexpr uint32_t apsr_bits = 0xF80F0000;  // N, Z, C, V, Q, GE
}  // namespace

// B5.2.2. EPSR reads as zero; without privilege IPSR, the stack pointers and the masks do too.
bool Execute::mrs(Machine& cpu, const Step& op) {
  uint32_t value = 0;
  unsigned which = sysm(op);
  bool priv = cpu.state.privileged();
  if (which <= 7) {
    if ((which & 4) == 0) value |= cpu.state.xpsr() & apsr_bits;
    if ((which & 1) && priv) value |= cpu.state.ipsr;
  } else if (which == 20) {
    value = cpu.state.control;
  } else if (priv) {
    switch (which) {
      case 8:
        value = cpu.state.msp();
        break;
      case 9:
        value = cpu.state.psp();
        break;
      case 16:
        value = cpu.state.primask;
        break;
      case 17:
      case 18:
        value = cpu.state.basepri;
        break;
      case 19:
        value = cpu.state.faultmask;
        break;
      default:
        break;
    }
  }
  cpu.state.r[op.rd] = value;
  return true;
}

// B5.2.3.
bool Execute::msr(Machine& cpu, const Step& op) {
  uint32_t value = cpu.state.r[op.rn];
  unsigned which = sysm(op);
  if (which <= 3) {
    constexpr uint32_t nzcvq = 0xF8000000u, ge = apsr_bits & ~nzcvq;
    const uint32_t mask = ((op.encoding & 0x800) != 0 ? nzcvq : 0) | (op.sets_ge ? ge : 0);
    const uint32_t written = mask & cpu.profile.xpsr_bits;
    cpu.state.set_apsr((value & written) | (cpu.state.xpsr() & ~written));
  } else if (which > 7 && cpu.state.privileged()) {
    switch (which) {
      case 8:
        cpu.state.set_msp(value);
        return cpu.leave(op);  // nothing depends on a stack pointer
      case 9:
        cpu.state.set_psp(value);
        return cpu.leave(op);
      case 16:
        cpu.state.primask = value & 1;
        break;
      case 17:
        cpu.system.check_basepri(op, value);
        cpu.state.set_basepri(value);
        break;
      case 18:
        cpu.system.check_basepri(op, value);
        value &= cpu.state.nvic.priority_mask();
        if (value != 0 && (value < cpu.state.basepri || cpu.state.basepri == 0))
          cpu.state.basepri = value;
        break;
      case 19:
        if (cpu.pending.execution_priority() > -1 || (value & 1) == 0)
          cpu.state.faultmask = value & 1;
        break;
      case 20:
        cpu.state.set_control(value & cpu.profile.control_bits());
        break;
      default:
        break;
    }
    cpu.requests.raise(Requests::changed);
  }
  return cpu.leave(op);
}

bool Execute::wfi(Machine& cpu, const Step& op) {
  cpu.sleep(false);
  return cpu.leave(op);
}

bool Execute::wfe(Machine& cpu, const Step& op) {
  if (cpu.state.event_register) {
    cpu.state.event_register = false;
  } else {
    cpu.sleep(true);
  }
  return cpu.leave(op);
}

bool Execute::sev(Machine& cpu, const Step& op) {
  cpu.state.event_register = true;
  return cpu.leave(op);
}

}  // namespace capsoc::armv7m
