#include "cortex_m3/executors/translator/block_emitter.h"

#include <cstring>

#include "cortex_m3/executors/execute.h"
#include "cortex_m3/isa/decoder.h"

namespace capsoc::cortex_m3 {

using namespace asmjit;

namespace {

constexpr uint8_t not_pinned = 0xFF;
// By guest register: the number of the host's. The first three need no prefix in 32-bit operations.
constexpr uint8_t host_number[16] = {3,          6,  7,          8,          9,          10,
                                     11,         12, not_pinned, not_pinned, not_pinned, not_pinned,
                                     not_pinned, 13, 14,         not_pinned};
constexpr uint32_t unaligned_most = 2;  // cycles of the parts of an access beyond the first

}  // namespace

BlockEmitter::BlockEmitter(Machine& machine, HostContext& context, CodeBuffer& buffer)
    : machine_(machine), context_(context), buffer_(buffer) {
  forget();
}

void BlockEmitter::forget() {
  exits_.clear();
  recipes_.assign(1, {});
  largest_bound_ = 0;
}

bool BlockEmitter::pinned(unsigned n) {
  return n < 16 && host_number[n] != not_pinned;
}

Imm BlockEmitter::number(uint32_t value) {
  return Imm(static_cast<int32_t>(value));
}

// clang's analyser does not follow how asmjit packs operands into words, and takes some for
// uninitialised inside its headers.
#ifndef __clang_analyzer__
x86::Mem BlockEmitter::sum_of(const Gp& base, int32_t displacement) {
  return x86::ptr(base.r64(), displacement);
}

x86::Mem BlockEmitter::sum_of(const Gp& base, const Gp& index, unsigned shift,
                              int32_t displacement) {
  return x86::ptr(base.r64(), index.r64(), shift, displacement);
}
#endif

x86::Gp BlockEmitter::host(unsigned n) {
  return x86::gpd(host_number[n]);
}

/// A register that is in no host register, or a word put aside.
x86::Mem BlockEmitter::in_state(unsigned n) const {
  if (n >= FlagOperand::first_aside)
    return context(&context_.aside[n - FlagOperand::first_aside], 4);
  return x86::dword_ptr(x86::rbp, static_cast<int32_t>(4 * n));
}

Operand BlockEmitter::at(unsigned n) const {
  return pinned(n) ? Operand(host(n)) : Operand(in_state(n));
}

/// A register's value, in `scratch` if it is not in a host register.
x86::Gp BlockEmitter::read(unsigned n, const Gp& scratch) {
  if (pinned(n)) return host(n);
  read_to(scratch, n);
  return scratch;
}

void BlockEmitter::read_to(const Gp& to, unsigned n) {
  if (n == literal_pc) {
    a_.mov(to, pc_of(*steps_[index_]));
  } else if (!pinned(n)) {
    a_.mov(to, in_state(n));
  } else if (host(n) != to) {
    a_.mov(to, host(n));
  }
}

void BlockEmitter::write(unsigned n, const Gp& from) {
  if (!pinned(n))
    a_.mov(in_state(n), from);
  else if (host(n) != from)
    a_.mov(host(n), from);
}

namespace {

int32_t distance(const void* from, const void* to) {
  return static_cast<int32_t>(static_cast<const uint8_t*>(to) - static_cast<const uint8_t*>(from));
}

}  // namespace

x86::Mem BlockEmitter::state_word(const void* member) const {
  return x86::dword_ptr(x86::rbp, distance(&machine_.state, member));
}
x86::Mem BlockEmitter::state_byte(const void* member) const {
  return x86::byte_ptr(x86::rbp, distance(&machine_.state, member));
}
x86::Mem BlockEmitter::context(const void* member, unsigned size) const {
  return x86::ptr(x86::rbp, distance(&machine_.state, member), size);
}

x86::Mem BlockEmitter::constant(uint64_t value) {
  for (const Constant& c : constants_)
    if (c.value == value) return x86::qword_ptr(c.label);
  constants_.push_back({a_.newLabel(), value});
  return x86::qword_ptr(constants_.back().label);
}

Label BlockEmitter::stub(const BlockExit& exit) {
  stubs_.push_back({a_.newLabel(), static_cast<uint32_t>(exits_.size())});
  exits_.push_back(exit);
  return stubs_.back().label;
}

/// The way out before a step, which is decoded and executed then, and the rest of the block.
Label BlockEmitter::exit_at(const Step& step) {
  if (!step_exits_.empty() && step_exits_.back().first == &step) return step_exits_.back().second;
  BlockExit exit;
  exit.step = &step;
  exit.bound = head_->block_cycles;
  exit.recipe = recipe_of(flags_before_);
  step_exits_.emplace_back(&step, stub(exit));
  return step_exits_.back().second;
}

/// Which registers an operation writes, a bit each.
uint32_t BlockEmitter::written_by(const DecodedOp& op) {
  const auto bit = [](unsigned n) { return n < 16 ? 1u << n : 0u; };
  const bool indexed = op.writeback || op.addressing == Addressing::pre_indexed ||
                       op.addressing == Addressing::post_indexed;
  if (is(op, kind::transfer)) {
    uint32_t set = indexed ? bit(op.rn) : 0;
    if (is(op, kind::load | kind::dual_load | kind::exclusive_load)) set |= bit(op.rd);
    if (is(op, kind::dual_load | kind::exclusive_store)) set |= bit(op.ra);
    if (is(op, kind::multiple_load)) set |= op.list.bits;
    return set;
  }
  if (op.operation == Operation::bl || op.operation == Operation::blx) return bit(14);
  if (is(op, kind::compare | kind::any_branch | kind::none)) return 0;
  if (is(op, kind::system)) return op.operation == Operation::mrs ? bit(op.rd) : 0;
  return bit(op.rd) | (is(op, kind::long_multiply) ? bit(op.ra) : 0);
}

bool BlockEmitter::writes_sp(const Step& step) const {
  if (step.body != &both<Execute::align_sp> || step.rd != 13 || step.set_flags) return false;
  switch (step.operation) {
    case Operation::add_imm:
    case Operation::sub_imm:
    case Operation::add_reg:
    case Operation::sub_reg:
    case Operation::mov_reg:
    case Operation::mov_high:
    case Operation::add_high:
      return step.shift.type != ShiftType::rrx;
    default:
      return false;
  }
}

/// False for what is left to C++: what is rare, faults, changes the mode, or is UNPREDICTABLE.
bool BlockEmitter::is_translated(const Step& step) const {
  if (writes_sp(step)) return true;
  if (step.body != Execute::unconditional(step)) return false;
  const bool leaves = is(step, kind::any_branch) || step.rd == 15 || step.list.has(15);
  if (leaves && step.it_after != 0) return false;
  switch (step.operation) {
    case Operation::mrs:
    case Operation::msr:
      return moves_stack_pointer(step);
    case Operation::isb:
      return stands_alone(step);
    case Operation::b:
      return pc_of(step) + step.imm != step.address;
    case Operation::ssat:
    case Operation::usat:
      return false;
    case Operation::nop:
    case Operation::it:
    case Operation::barrier:
    case Operation::fall_through:
      return true;
    default:
      break;
  }
  if (step.addressing == Addressing::unprivileged) return false;
  if (is(step, kind::multiple)) return step.list.bits != 0 && !step.list.has(13);
  return is(step, kind::data_processing | kind::any_branch | kind::load | kind::store |
                      kind::dual_load | kind::dual_store);
}

/// Most cycles a translated step takes, without branching.
uint32_t BlockEmitter::bound_of(const Step& step) const {
  uint32_t bound = step.cycles;
  const uint32_t wait = machine_.memory.map().largest_wait();
  if (is(step, kind::transfer)) bound += wait * std::max(2u, step.list.count()) + unaligned_most;
  if (is(step, kind::divide)) bound += timing::divide_most;
  if (is(step, kind::long_multiply)) bound += timing::long_multiply_most;
  return bound;
}

void BlockEmitter::begin(const Step* head, CodePage& page) {
  head_ = head;
  page_ = &page;
  code_.reset();
  errors_.any = false;
  code_.init(Environment::host());
  code_.setErrorHandler(&errors_);
  code_.attach(&a_);
  begin_listing();
  index_ = 0;
  serial_ = 0;
  host_serial_ = 0;
  flags_ = {};
  flags_.nz.of = flags_.c.of = flags_.v.of = FlagSource::Of::inherited;
  open_ = true;
  for (unsigned n = 0; n < 16; ++n) values_[n] = machine_.state.r[n];
  stubs_.clear();
  constants_.clear();
  slots_.clear();
  slow_.clear();
  misses_.clear();
  taken_.clear();
  step_exits_.clear();
  collect_steps();
  find_visible_flags();
}

/// The steps up to the first that is left to C++ for good, that one with them.
void BlockEmitter::collect_steps() {
  steps_.clear();
  bound_ = timing::most_refill;
  for (const Step* step = head_;; ++step) {
    steps_.push_back(step);
    cut_ = steps_.size();
    if (bound_ + bound_of(*step) > most_cycles) {
      cut_ = steps_.size() - 1;
      return split();
    }
    bound_ += bound_of(*step);
    if (step->operation == Operation::fall_through) return;
    if (step->condition == condition_always && !is_translated(*step)) return;
  }
}

/// Lets the block run into another one where it is cut, or as soon before as one may begin there:
/// with flags that are all the block's own, or none, since the recipe of those that were left to it
/// uncomputed can be passed on as a whole only.
void BlockEmitter::split() {
  std::size_t place = 0;
  uint8_t own = 0;
  for (std::size_t i = 1; i <= cut_; ++i) {
    const Step& last = *steps_[i - 1];
    const FlagUse effects = flag_use(last);
    own |= effects.sets | effects.kills;
    const bool whole = own == 0 || own == flag::all;
    if (whole && steps_[i]->it_before == 0 && !timing::hangs_on(last.trail, *steps_[i])) place = i;
  }
  if (place == 0) return;
  close_ = closing_step(*steps_[place - 1]);
  Execute::bind(close_);
  steps_.resize(place);
  steps_.push_back(&close_);
  cut_ = steps_.size();
}

void BlockEmitter::find_visible_flags() {
  visible_ = live_flags(
      steps_.size(), [&](std::size_t i) -> const DecodedOp& { return *steps_[i]; },
      [&](std::size_t i) { return may_be_left_at(*steps_[i]); });
}

bool BlockEmitter::may_be_left_at(const Step& step) const {
  return flag_use(step).exits || !is_translated(step) || writes_sp(step);
}

void BlockEmitter::emit_steps() {
  for (index_ = 0; index_ < steps_.size() && open_; ++index_) {
    const Step& step = *steps_[index_];
    if (index_ == cut_) {
      flags_before_ = flags_;
      return give_up(step);
    }
    if (step.condition != condition_always)
      emit_conditional_group();
    else
      emit_step(step);
  }
}

void BlockEmitter::emit_step(const Step& step) {
  flags_before_ = flags_;
  list_step(step);
  if (!is_translated(step)) return give_up(step);
  const FlagUse effects = flag_use(step);
  protect(written_by(step), effects.kills, visible_[index_]);
  ++serial_;
  host_kept_ = false;
  emit_operation(step);
  if (host_serial_ != serial_ && !host_kept_) host_serial_ = 0;
  forget_host_carries();
  note_values(step);
}

void BlockEmitter::emit_operation(const Step& step) {
  if (writes_sp(step)) return emit_sp(step);
  const bool to_pc = is(step, kind::data) && step.rd == 15;
  if (step.operation == Operation::fall_through) {
    emit_close(step);
  } else if (to_pc) {
    emit_indirect(step);
  } else if (is(step, kind::any_branch)) {
    emit_branch(step);
  } else if (is(step, kind::transfer)) {
    emit_transfer(step);
  } else if (is(step, kind::data_processing)) {
    emit_data(step);
  } else if (step.operation == Operation::isb) {
    emit_close(step);
  } else if (step.operation == Operation::mrs || step.operation == Operation::msr) {
    emit_stack_pointer(step);
  } else {
    keep_host_flags();  // NOP, IT, barriers
  }
}

/// What is rarely executed, behind the block.
void BlockEmitter::emit_cold() {
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    const TakenBranch branch = taken_[i];
    list_line("taken");
    a_.bind(branch.label);
    flags_ = branch.flags;
    host_serial_ = branch.host_serial;
    host_flags_ = branch.host_flags;
    emit_edge(*branch.step, pc_of(*branch.step) + branch.step->imm, timing::refill_immediate);
  }
  if (!slow_.empty()) list_line("outside the window");
  for (const SlowAccess& slow : slow_) emit_slow(slow);
  if (!misses_.empty()) list_line("jumps to elsewhere");
  for (const JumpMiss& miss : misses_) emit_miss(miss);
  list_line("ways out");
  for (const Stub& stub : stubs_) {
    a_.bind(stub.label);
    a_.mov(x86::eax, stub.exit);
    a_.jmp(context(&context_.leave));
  }
}

void BlockEmitter::emit_data_area() {
  a_.align(AlignMode::kZero, 8);
  for (const Constant& c : constants_) {
    a_.bind(c.label);
    a_.embedUInt64(c.value);
  }
  for (const Slot& slot : slots_) {
    a_.bind(slot.label);
    a_.embedUInt64(0);
  }
}

/// Copies the code to its place and points its jumps to their ways out.
const uint8_t* BlockEmitter::finish() {
  const CodeBuffer& buffer = buffer_;
  const std::size_t size = code_.textSection()->bufferSize(), start = buffer.used();
  if (errors_.any || code_.hasUnresolvedLinks() || size > buffer.room()) return nullptr;
  std::memcpy(buffer.writable(start), code_.textSection()->data(), size);
  const auto place = [&](const Label& label) { return start + code_.labelOffset(label); };
  for (const Slot& slot : slots_) {
    const uint8_t* target = buffer.executable(place(slot.unlinked));
    std::memcpy(buffer.writable(place(slot.label)), &target, sizeof target);
    exits_[slot.exit].slot = static_cast<uint32_t>(place(slot.label));
  }
  buffer_.take((size + 15) & ~std::size_t{15});
  largest_bound_ = std::max(largest_bound_, bound_);
  return buffer.executable(start + minded_bytes);
}

/// In front of the block what hangs on the way to it.
void BlockEmitter::emit_entries() {
  static constexpr uint8_t nothing[refill_bytes] = {0x0F, 0x1F, 0x84};  // NOP of eight bytes
  a_.embedUInt64(timing::minded_by(*head_));
  refilled_entry_ = a_.newLabel();
  a_.bind(refilled_entry_);
  if (const uint64_t beyond = timing::refill_beyond(*head_)) {
    a_.sub(x86::r15, constant(beyond << 32));
    a_.nop();
  } else {
    a_.embed(nothing, sizeof nothing);
  }
  if (a_.offset() != minded_bytes) errors_.any = true;
  entry_ = a_.newLabel();
  a_.bind(entry_);
}

const uint8_t* BlockEmitter::emit(const Step* head, CodePage& page) {
  if (full()) return nullptr;
  begin(head, page);
  if (!is_translated(*head)) return nullptr;
  emit_entries();
  emit_steps();
  if (open_) return nullptr;
  emit_cold();
  emit_data_area();
  return finish();
}

std::size_t BlockEmitter::emit_frame() {
  code_.reset();
  errors_.any = false;
  code_.init(Environment::host());
  code_.setErrorHandler(&errors_);
  code_.attach(&a_);
  const Gp saved[] = {x86::rbx, x86::rbp, x86::r12, x86::r13, x86::r14, x86::r15};
  for (const Gp& r : saved) a_.push(r);
  a_.mov(x86::rbp, x86::rdi);
  a_.mov(x86::rax, x86::rsi);
  a_.mov(x86::r15, context(&context_.budget));
  for (unsigned n = 0; n < 16; ++n)
    if (pinned(n)) a_.mov(host(n), in_state(n));
  a_.jmp(x86::rax);
  const Label leave = a_.newLabel();
  a_.align(AlignMode::kCode, 16);
  a_.bind(leave);
  a_.mov(context(&context_.budget), x86::r15);
  for (unsigned n = 0; n < 16; ++n)
    if (pinned(n)) a_.mov(in_state(n), host(n));
  for (std::size_t i = std::size(saved); i-- > 0;) a_.pop(saved[i]);
  a_.ret();
  const std::size_t start = buffer_.used(), size = code_.textSection()->bufferSize();
  std::memcpy(buffer_.writable(start), code_.textSection()->data(), size);
  context_.leave = buffer_.executable(start + code_.labelOffset(leave));
  buffer_.take((size + 63) & ~std::size_t{63});
  return start;
}

}  // namespace capsoc::cortex_m3
