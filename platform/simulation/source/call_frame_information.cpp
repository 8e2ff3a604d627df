#include "source/call_frame_information.h"

#include <dwarf.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <vector>

#include "source/register_numbers.h"

namespace capsoc::source {
namespace {

using Frame = std::unique_ptr<Dwarf_Frame, decltype(&std::free)>;

/// The stack machine of DWARF expressions (2.5), as far as compilers need it for frames.
class Expression {
 public:
  Expression(const Registers& registers, std::optional<uint32_t> cfa, const ReadWord& read)
      : registers_(registers), cfa_(cfa), read_(read) {}

  /// What is on top at the end; nothing for an operation that is not known, or a damaged one.
  std::optional<uint32_t> evaluate(const Dwarf_Op* ops, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      if (!step(ops[i])) return std::nullopt;
    if (stack_.empty()) return std::nullopt;
    return stack_.back();
  }
  /// It ended with DW_OP_stack_value: the result is no address but the value itself.
  bool is_value() const { return is_value_; }

 private:
  bool push(uint64_t value) {
    constexpr std::size_t deepest = 64;
    if (stack_.size() >= deepest) return false;
    stack_.push_back(static_cast<uint32_t>(value));
    return true;
  }
  bool push_register(uint64_t number, uint64_t offset) {
    return number < registers_.size() && push(registers_[number] + offset);
  }
  std::optional<uint32_t> pop() {
    if (stack_.empty()) return std::nullopt;
    const uint32_t value = stack_.back();
    stack_.pop_back();
    return value;
  }
  template <typename Operation>
  bool combine(Operation operation) {
    const auto right = pop(), left = pop();
    return left && right && push(operation(*left, *right));
  }
  bool dereference() {
    const auto address = pop();
    const auto word = address ? read_(*address) : std::nullopt;
    return word && push(*word);
  }

  bool step(const Dwarf_Op& op) {
    if (op.atom >= DW_OP_lit0 && op.atom <= DW_OP_lit31) return push(op.atom - DW_OP_lit0);
    if (op.atom >= DW_OP_breg0 && op.atom <= DW_OP_breg31)
      return push_register(op.atom - DW_OP_breg0, op.number);
    switch (op.atom) {
      case DW_OP_addr:
      case DW_OP_const1u:
      case DW_OP_const1s:
      case DW_OP_const2u:
      case DW_OP_const2s:
      case DW_OP_const4u:
      case DW_OP_const4s:
      case DW_OP_constu:
      case DW_OP_consts:
        return push(op.number);
      case DW_OP_bregx:
        return push_register(op.number, op.number2);
      case DW_OP_call_frame_cfa:
        return cfa_ && push(*cfa_);
      case DW_OP_deref:
        return dereference();
      case DW_OP_dup:
        return !stack_.empty() && push(stack_.back());
      case DW_OP_drop:
        return pop().has_value();
      case DW_OP_plus_uconst: {
        const auto value = pop();
        return value && push(*value + op.number);
      }
      case DW_OP_plus:
        return combine([](uint32_t a, uint32_t b) { return a + b; });
      case DW_OP_minus:
        return combine([](uint32_t a, uint32_t b) { return a - b; });
      case DW_OP_and:
        return combine([](uint32_t a, uint32_t b) { return a & b; });
      case DW_OP_or:
        return combine([](uint32_t a, uint32_t b) { return a | b; });
      case DW_OP_shl:
        return combine([](uint32_t a, uint32_t b) { return b < 32 ? a << b : 0; });
      case DW_OP_stack_value:
        is_value_ = true;
        return true;
      default:
        return op.atom == DW_OP_nop;
    }
  }

  const Registers& registers_;
  std::optional<uint32_t> cfa_;
  const ReadWord& read_;
  std::vector<uint32_t> stack_;
  bool is_value_ = false;
};

std::optional<uint32_t> frame_address(Dwarf_Frame* frame, const Registers& registers,
                                      const ReadWord& read) {
  Dwarf_Op* ops = nullptr;
  std::size_t count = 0;
  if (dwarf_frame_cfa(frame, &ops, &count) != 0 || count == 0) return std::nullopt;
  return Expression(registers, std::nullopt, read).evaluate(ops, count);
}

enum class Rule { value, undefined, damaged };

/// What the caller had in a register.
Rule caller_register(Dwarf_Frame* frame, unsigned number, const Registers& registers, uint32_t cfa,
                     const ReadWord& read, uint32_t& value) {
  Dwarf_Op own[3];
  Dwarf_Op* ops = nullptr;
  std::size_t count = 0;
  if (dwarf_frame_register(frame, static_cast<int>(number), own, &ops, &count) != 0)
    return Rule::damaged;
  if (count == 0) return ops == nullptr ? Rule::value : Rule::undefined;  // nullptr: unchanged
  Expression expression(registers, cfa, read);
  const auto result = expression.evaluate(ops, count);
  const auto found = result && !expression.is_value() ? read(*result) : result;
  if (!found) return Rule::damaged;
  value = *found;
  return Rule::value;
}

}  // namespace

Unwound unwind_by_description(Dwarf_CFI* frames, uint32_t address, Registers& registers,
                              const ReadWord& read) {
  Dwarf_Frame* found = nullptr;
  if (frames == nullptr || dwarf_cfi_addrframe(frames, address, &found) != 0)
    return Unwound::not_described;
  const Frame frame(found, &std::free);
  Dwarf_Addr first = 0, behind = 0;
  if (dwarf_frame_info(frame.get(), &first, &behind, nullptr) < 0 || address < first ||
      address >= behind)
    return Unwound::not_described;
  const auto cfa = frame_address(frame.get(), registers, read);
  if (!cfa) return Unwound::not_described;
  Registers caller = registers;
  for (unsigned number = 0; number <= link; ++number) {
    if (number == stack_pointer) continue;
    const Rule rule = caller_register(frame.get(), number, registers, *cfa, read, caller[number]);
    if (rule == Rule::damaged) return Unwound::not_described;
    if (rule == Rule::undefined && number == link) return Unwound::outermost;
  }
  caller[stack_pointer] = *cfa;
  caller[program_counter] = caller[link] & ~1u;
  // EXC_RETURN is no address of an instruction.
  if (caller[link] >= 0xF0000000) caller[program_counter] = caller[link];
  registers = caller;
  return Unwound::caller;
}

}  // namespace capsoc::source
