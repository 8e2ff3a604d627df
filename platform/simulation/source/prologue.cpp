#include "source/prologue.h"

#include "armv7m/isa/decoder.h"
#include "source/register_numbers.h"

namespace capsoc::source {
namespace {

using armv7m::DecodedOp;
using armv7m::Operation;

constexpr unsigned longest_prologue = 48;  // instructions; compilers mix others in

std::optional<uint16_t> read_halfword(uint32_t address, const ReadWord& read) {
  const auto word = read(address & ~3u);
  if (!word) return std::nullopt;
  return static_cast<uint16_t>(*word >> ((address & 2) * 8));
}

std::optional<DecodedOp> decode_at(uint32_t address, const ReadWord& read) {
  const auto first = read_halfword(address, read);
  if (!first) return std::nullopt;
  const auto second =
      armv7m::is_wide(*first) ? read_halfword(address + 2, read) : std::optional<uint16_t>(0);
  if (!second) return std::nullopt;
  return armv7m::decode(address, *first, *second, 0);
}

/// What a function has done to the stack so far; depths are bytes below its caller's stack pointer.
struct Prologue {
  uint32_t depth = 0;
  std::array<std::optional<uint32_t>, 16> saved;  ///< depth of each register that was stored
  std::optional<unsigned> frame_pointer;
  uint32_t frame_depth = 0;  ///< of what the frame pointer points to

  void store(const armv7m::RegisterList& list) {
    depth += 4 * list.count();
    uint32_t at = depth;
    for (unsigned n = 0; n < 15; ++n) {
      if (!list.has(n)) continue;
      if (!saved[n]) saved[n] = at;
      at -= 4;
    }
  }
  void follow(const DecodedOp& op) {
    const bool on_stack = op.rn == stack_pointer && op.writeback;
    if (op.operation == Operation::stmdb && on_stack) return store(op.list);
    if (op.operation == Operation::str && on_stack &&
        op.addressing == armv7m::Addressing::pre_indexed) {
      depth -= op.imm;
      if (!saved[op.rd]) saved[op.rd] = depth;
      return;
    }
    const bool points = op.operation == Operation::mov_high && op.rm == stack_pointer;
    if (points && (op.rd == 7 || op.rd == 11)) {
      frame_pointer = op.rd;
      frame_depth = depth;
      return;
    }
    const bool subtracts = op.operation == Operation::sub_imm,
               adds = op.operation == Operation::add_imm;
    if ((!subtracts && !adds) || op.rn != stack_pointer) return;
    const uint32_t moved = subtracts ? depth + op.imm : depth - op.imm;
    if (op.rd == stack_pointer) {
      depth = moved;
    } else if (op.rd == 7 || op.rd == 11) {
      frame_pointer = op.rd;
      frame_depth = moved;
    }
  }
};

}  // namespace

bool unwind_by_prologue(uint32_t function, uint32_t address, Registers& registers,
                        const ReadWord& read) {
  Prologue prologue;
  uint32_t at = function;
  for (unsigned count = 0; at < address && count < longest_prologue; ++count) {
    const auto op = decode_at(at, read);
    if (!op) return false;
    if (armv7m::ends_block(*op)) break;
    prologue.follow(*op);
    at = armv7m::next_address(*op);
  }
  const uint32_t above = prologue.frame_pointer
                             ? registers[*prologue.frame_pointer] + prologue.frame_depth
                             : registers[stack_pointer] + prologue.depth;
  Registers caller = registers;
  for (unsigned n = 0; n < 15; ++n) {
    if (!prologue.saved[n]) continue;
    const auto word = read(above - *prologue.saved[n]);
    if (!word) return false;
    caller[n] = *word;
  }
  caller[stack_pointer] = above;
  caller[program_counter] = caller[link] >= 0xF0000000 ? caller[link] : caller[link] & ~1u;
  registers = caller;
  return true;
}

}  // namespace capsoc::source
