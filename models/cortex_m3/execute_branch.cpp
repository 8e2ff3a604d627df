#include "cortex_m3/execute.h"

namespace capsoc::cortex_m3 {

bool Execute::take_branch(Core& c, uint32_t target) {
  c.branch_write_pc(target);
  c.cycles_ += timing::pipeline_refill;
  return false;
}

bool Execute::b(Core& c, const Step& op) {
  return take_branch(c, pc_of(op) + op.imm);
}

template <unsigned condition>
bool Execute::branch_if(Core& c, const Step& op) {
  return c.condition_passed(condition) ? take_branch(c, pc_of(op) + op.imm) : c.leave(op);
}

Handler Execute::branch_handler(const DecodedOp& op) {
  switch (op.operation) {
    case Operation::bcond: {
      static constexpr Handler handlers[16] = {branch_if<0>,
                                               branch_if<1>,
                                               branch_if<2>,
                                               branch_if<3>,
                                               branch_if<4>,
                                               branch_if<5>,
                                               branch_if<6>,
                                               branch_if<7>,
                                               branch_if<8>,
                                               branch_if<9>,
                                               branch_if<10>,
                                               branch_if<11>,
                                               branch_if<12>,
                                               branch_if<13>,
                                               b,
                                               b};
      return handlers[op.shift_n & 15];
    }
#define ONE(name)       \
  case Operation::name: \
    return name;
      // A table of cases, which the formatter indents anew each time.
      // clang-format off
      ONE(b)
      ONE(bl)
      ONE(bx)
      ONE(blx) ONE(cbz) ONE(cbnz) ONE(tbb) ONE(tbh)
      // clang-format on
#undef ONE
          default : return nullptr;
  }
}

bool Execute::bl(Core& c, const Step& op) {
  c.r_[14] = next_address(op) | 1;
  return take_branch(c, pc_of(op) + op.imm);
}

bool Execute::bx(Core& c, const Step& op) {
  c.cycles_ += timing::pipeline_refill;
  return c.bx_write_pc(read(c, op, op.rm));
}

// BLXWritePC: unlike BX it never returns from an exception (A2.3.1).
bool Execute::blx(Core& c, const Step& op) {
  uint32_t target = read(c, op, op.rm);
  c.r_[14] = next_address(op) | 1;
  c.thumb_ = (target & 1) != 0;
  if (!c.thumb_) c.reevaluate();
  return take_branch(c, target);
}

bool Execute::cbz(Core& c, const Step& op) {
  return c.r_[op.rn] == 0 ? take_branch(c, pc_of(op) + op.imm) : c.leave(op);
}

bool Execute::cbnz(Core& c, const Step& op) {
  return c.r_[op.rn] != 0 ? take_branch(c, pc_of(op) + op.imm) : c.leave(op);
}

bool Execute::tbb(Core& c, const Step& op) {
  uint32_t offset = 0;
  Access a = c.load<uint8_t>(op, read(c, op, op.rn) + c.r_[op.rm], offset);
  return table_branch(c, op, offset, a);
}

bool Execute::tbh(Core& c, const Step& op) {
  uint32_t offset = 0;
  Access a = c.load<uint16_t>(op, read(c, op, op.rn) + (c.r_[op.rm] << 1), offset);
  return table_branch(c, op, offset, a);
}

bool Execute::table_branch(Core& c, const Step& op, uint32_t offset, Access access) {
  if (access == Access::fault) return false;
  return take_branch(c, pc_of(op) + 2 * offset);
}

}  // namespace capsoc::cortex_m3
