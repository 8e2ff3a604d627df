#include "cortex_m3/execute.h"
#include "cortex_m3/unpredictable.h"

namespace capsoc::cortex_m3 {

const Executors* Execute::system_executors(const DecodedOp& op) {
  switch (op.operation) {
#define ONE(name)       \
  case Operation::name: \
    return &both<name>;
    // A table of cases, which the formatter indents anew each time.
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
  return system_executors(op);
}

/// SP[1:0] read as zero (B1.4.7), so whatever writes R13 ends here.
bool Execute::align_sp(Core& c, const Step& op) {
  bool go_on = unconditional(op)->one(c, op);
  if ((c.state_.r[13] & 3) != 0) c.unpredictable(Unpredictable::stack_pointer_bits, op.address);
  c.state_.r[13] &= ~3u;
  return go_on;
}

/// What unpredictable.def chooses for an encoding: that of the operation itself, with R15 as the
/// PC reads.
bool Execute::unpredictable(Core& c, const Step& op) {
  c.unpredictable(*unpredictable_encoding(op), op.address);
  c.state_.r[15] = pc_of(op);
  bool go_on = unconditional(op)->one(c, op);
  c.state_.r[13] &= ~3u;
  return go_on;
}

bool Execute::conditional(Core& c, const Step& op) {
  if (c.condition_passed(op.condition)) return op.body->one(c, op);
  c.state_.cycles -= op.cycles - 1u;  // skipped in one cycle
  return true;
}

const Step* Execute::conditional_chain(Core& c, const Step* op) {
  if (c.condition_passed(op->condition)) return op->body->chain(c, op);
  c.state_.cycles -= op->cycles - 1u;
  return go_on(c, op + 1);
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
  bool writes_sp =
      step.rd == 13 || step.ra == 13 || (step.writeback && step.rn == 13 && (step.imm & 3) != 0);
  if (writes_sp && step.operation < Operation::b && !keeps_sp_aligned(step))
    step.body = &both<align_sp>;
  if (unpredictable_encoding(step)) step.body = &both<unpredictable>;
  step.chain = step.condition == condition_always ? step.body->chain : conditional_chain;
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

uint32_t Execute::most_extra_cycles(const DecodedOp& op, uint32_t largest_wait) {
  switch (op.operation) {
    case Operation::udiv:
    case Operation::sdiv:
      return timing::divide_most;
    case Operation::smull:
    case Operation::umull:
    case Operation::smlal:
    case Operation::umlal:
      return timing::long_multiply_most;
    default:
      break;
  }
  unsigned transfers = op.operation >= Operation::ldm && op.operation <= Operation::stmdb ? 16 : 4;
  bool memory = op.operation >= Operation::ldr && op.operation <= Operation::strexh;
  return memory ? transfers * (largest_wait + 1) : 0;
}

bool Execute::undefined(Core& c, const Step& op) {
  return c.fault(op, Core::Cause::undefined_instruction);
}
bool Execute::coprocessor(Core& c, const Step& op) {
  return c.fault(op, Core::Cause::no_coprocessor);
}
bool Execute::nop(Core&, const Step&) {
  return true;
}
bool Execute::it(Core&, const Step&) {
  return true;
}  // its effect is in what was decoded after it
bool Execute::barrier(Core&, const Step&) {
  return true;
}
bool Execute::isb(Core& c, const Step& op) {
  return c.leave(op);
}

bool Execute::fall_through(Core& c, const Step& op) {
  c.state_.pc = op.address;
  return false;
}

bool Execute::svc(Core& c, const Step& op) {
  c.event_ = Core::Event::svc;
  return c.leave(op);
}

bool Execute::bkpt(Core& c, const Step& op) {
  c.event_ = Core::Event::bkpt;
  c.event_value_ = op.imm;
  c.event_return_ = op.address;
  return c.leave(op);
}

// imm: bit 4 disables, I is PRIMASK, F is FAULTMASK; nothing happens without privilege (B5.2.1).
bool Execute::cps(Core& c, const Step& op) {
  bool disable = (op.encoding & 0x10) != 0;
  if (c.privileged()) {
    if (op.encoding & 2) c.state_.primask = disable ? 1 : 0;
    if ((op.encoding & 1) && (!disable || c.execution_priority() > -1))
      c.state_.faultmask = disable ? 1 : 0;
    c.reevaluate();
  }
  return c.leave(op);
}

namespace {
uint32_t sysm(const DecodedOp& op) {
  return op.encoding & 0xFF;
}
}  // namespace

// B5.2.2. EPSR reads as zero; without privilege IPSR, the stack pointers and the masks do too.
bool Execute::mrs(Core& c, const Step& op) {
  uint32_t value = 0;
  unsigned which = sysm(op);
  bool priv = c.privileged();
  if (which <= 7) {
    if ((which & 4) == 0) value |= c.xpsr() & 0xF8000000u;
    if ((which & 1) && priv) value |= c.state_.ipsr;
  } else if (which == 20) {
    value = c.state_.control;
  } else if (priv) {
    switch (which) {
      case 8:
        value = c.msp();
        break;
      case 9:
        value = c.psp();
        break;
      case 16:
        value = c.state_.primask;
        break;
      case 17:
      case 18:
        value = c.state_.basepri;
        break;
      case 19:
        value = c.state_.faultmask;
        break;
      default:
        break;
    }
  }
  c.state_.r[op.rd] = value;
  return true;
}

// B5.2.3.
bool Execute::msr(Core& c, const Step& op) {
  uint32_t value = c.state_.r[op.rn];
  unsigned which = sysm(op);
  if (which <= 3 && (op.encoding & 0x800)) {
    c.state_.n = value;
    c.state_.z = (value >> 30 & 1) ? 0 : 1;
    c.state_.c = (value >> 29 & 1) != 0;
    c.state_.v = (value >> 28 & 1) != 0;
    c.state_.q = (value >> 27 & 1) != 0;
  } else if (which > 7 && c.privileged()) {
    switch (which) {
      case 8:
        c.set_msp(value);
        break;
      case 9:
        c.set_psp(value);
        break;
      case 16:
        c.state_.primask = value & 1;
        break;
      case 17:
        c.check_basepri(op, value);
        c.state_.basepri = value & c.priority_mask_;
        break;
      case 18:
        c.check_basepri(op, value);
        value &= c.priority_mask_;
        if (value != 0 && (value < c.state_.basepri || c.state_.basepri == 0))
          c.state_.basepri = value;
        break;
      case 19:
        if (c.execution_priority() > -1 || (value & 1) == 0) c.state_.faultmask = value & 1;
        break;
      case 20:
        c.set_control(value);
        break;
      default:
        break;
    }
    c.reevaluate();
  }
  return c.leave(op);
}

bool Execute::wfi(Core& c, const Step& op) {
  c.sleep_until_wake(false);
  return c.leave(op);
}

bool Execute::wfe(Core& c, const Step& op) {
  if (c.state_.event_register) {
    c.state_.event_register = false;
  } else {
    c.sleep_until_wake(true);
  }
  return c.leave(op);
}

bool Execute::sev(Core& c, const Step& op) {
  c.state_.event_register = true;
  return c.leave(op);
}

}  // namespace capsoc::cortex_m3
