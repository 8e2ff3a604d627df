#include "armv7m/executors/translator/host_code.h"

#include <cstdio>

#include "armv7m/isa/decoder.h"

namespace capsoc::armv7m {

using namespace asmjit;

namespace {

int32_t distance(const void* from, const void* to) {
  return static_cast<int32_t>(static_cast<const uint8_t*>(to) - static_cast<const uint8_t*>(from));
}

}  // namespace

Imm immediate_of(uint32_t value) {
  return Imm(static_cast<int32_t>(value));
}

// clang's analyser does not follow how asmjit packs operands into words, and takes some for
// uninitialised inside its headers.
#ifndef __clang_analyzer__
Mem sum_of(const Gp& base, int32_t displacement) {
  return x86::ptr(base.r64(), displacement);
}

Mem sum_of(const Gp& base, const Gp& index, unsigned shift, int32_t displacement) {
  return x86::ptr(base.r64(), index.r64(), shift, displacement);
}
#endif

void HostCode::begin() {
  holder_.reset();
  errors_.any = false;
  holder_.init(Environment::host());
  holder_.setErrorHandler(&errors_);
  holder_.attach(&assembler_);
  constants_.clear();
  begin_listing();
}

Mem HostCode::state_word(const void* member) const {
  return x86::dword_ptr(x86::rbp, distance(&state_, member));
}

Mem HostCode::state_byte(const void* member) const {
  return x86::byte_ptr(x86::rbp, distance(&state_, member));
}

Mem HostCode::context(const void* member, unsigned size) const {
  return x86::ptr(x86::rbp, distance(&state_, member), size);
}

Mem HostCode::constant(uint64_t value) {
  for (const Constant& c : constants_)
    if (c.value == value) return x86::qword_ptr(c.label);
  constants_.push_back({assembler_.newLabel(), value});
  return x86::qword_ptr(constants_.back().label);
}

void HostCode::charge(const Gp& cycles) {
  assembler_.shl(cycles.r64(), 32);
  assembler_.sub(x86::r15, cycles.r64());
}

void HostCode::charge(uint64_t cycles) {
  assembler_.sub(x86::r15, constant(cycles << 32));
}

void HostCode::embed_constants() {
  assembler_.align(AlignMode::kZero, 8);
  for (const Constant& c : constants_) {
    assembler_.bind(c.label);
    assembler_.embedUInt64(c.value);
  }
}

void HostCode::begin_listing() {
  log_.clear();
  if (!listing_wanted_) return;
  log_.setFlags(FormatFlags::kMachineCode | FormatFlags::kHexImms | FormatFlags::kHexOffsets);
  log_.setIndentation(FormatIndentationGroup::kCode, 12);
  log_.setIndentation(FormatIndentationGroup::kLabel, 10);
  holder_.setLogger(&log_);
}

void HostCode::list_step(const Step& step) {
  if (!listing_wanted_) return;
  char text[160];
  std::snprintf(text, sizeof text, "%08x %s", static_cast<unsigned>(step.address),
                step.operation == Operation::fall_through ? "(continues after the block)"
                                                          : disassemble(step).c_str());
  list_line(text);
}

void HostCode::list_line(const char* text) {
  if (listing_wanted_) log_.logf("  %s\n", text);
}

}  // namespace capsoc::armv7m
