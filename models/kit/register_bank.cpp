#include "kit/register_bank.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace capsoc::kit {

using registers::Access;

Register::Register(RegisterBank& bank, const registers::RegisterDescription& description)
    : description_(description), value_(description.reset) {
  bank.enter(*this);
}

Register& Register::on_peek(std::function<uint32_t()> peek) {
  peek_ = std::move(peek);
  return *this;
}

Register& Register::on_read(std::function<uint32_t()> read) {
  read_ = std::move(read);
  return *this;
}

Register& Register::on_write(std::function<void(uint32_t)> write) {
  write_ = std::move(write);
  return *this;
}

void Register::store(uint32_t value) {
  value_ = registers::stored(description_, value_, value, all_bits);
}

uint32_t Register::peek() const {
  return (peek_ ? peek_() : value_) & description_.readable_mask;
}

uint32_t Register::read() {
  return read_ ? read_() & description_.readable_mask : peek();
}

void Register::write(uint32_t value, uint32_t lanes) {
  const uint32_t stored = value_ & ~lanes & description_.writable_mask;
  const uint32_t written =
      value & lanes & (description_.writable_mask | description_.one_to_clear_mask);
  if (write_) {
    write_(stored | written);
  } else {
    store(stored | written);
  }
}

uint32_t Register::known_bits() const {
  return description_.readable_mask | description_.writable_mask | description_.one_to_clear_mask;
}

RegisterBank::RegisterBank(const sc_core::sc_module_name& name, uint64_t size, AccessRule rule,
                           Holes holes)
    : RegisterTarget(name, size, rule), holes_(holes), by_word_(size / 4, nullptr) {}

void RegisterBank::enter(Register& added) {
  const auto& description = added.description();
  if (description.offset % 4 != 0 || description.offset >= size()) {
    throw std::logic_error(fmt::format("{}: register {} cannot be at 0x{:x}", name(),
                                       description.name, description.offset));
  }
  Register*& place = by_word_[description.offset / 4];
  if (place != nullptr) {
    throw std::logic_error(fmt::format("{}: registers {} and {} are both at 0x{:x}", name(),
                                       place->description().name, description.name,
                                       description.offset));
  }
  place = &added;
  in_order_.push_back(&added);
}

void RegisterBank::reset_registers() {
  for (Register* each : in_order_) each->reset();
}

bool RegisterBank::read_word(uint32_t offset, uint32_t& value, bool debug) {
  value = 0;
  Register* const target = by_word_[offset / 4];
  if (target == nullptr) {
    if (!debug) report(fmt::format("read at 0x{:03x}, where no register is", offset));
    return holes_ == Holes::reads_zero;
  }
  if (debug) {
    value = target->peek();
    return true;
  }
  if (target->description().access == Access::write_only) {
    report(fmt::format("read of write-only {} yields 0", target->description().name));
    return true;
  }
  value = target->read();
  return true;
}

bool RegisterBank::write_word(uint32_t offset, uint32_t value, uint32_t lanes) {
  Register* const target = by_word_[offset / 4];
  if (target == nullptr) {
    report(fmt::format("write of 0x{:08x} at 0x{:03x}, where no register is", value, offset));
    return holes_ == Holes::reads_zero;
  }
  const auto& description = target->description();
  if (description.access == Access::read_only) {
    report(fmt::format("write of 0x{:08x} to read-only {} ignored", value, description.name));
    return true;
  }
  if ((value & ~target->known_bits()) != 0) {
    report(fmt::format("write of 0x{:08x} to {} sets reserved bits 0x{:08x}", value,
                       description.name, value & ~target->known_bits()));
  }
  target->write(value, lanes);
  return true;
}

bool RegisterBank::is_steady(uint32_t offset) const {
  const Register* const target = by_word_[offset / 4];
  return target != nullptr && target->steady_ && !target->read_;
}

bool RegisterBank::has_plain_read(uint32_t offset) const {
  const Register* const target = by_word_[offset / 4];
  return target != nullptr && !target->read_ && target->description().access != Access::write_only;
}

void RegisterBank::visit(Archive& archive) {
  for (Register* each : in_order_) archive(each->description_.name, each->value_);
}

}  // namespace capsoc::kit
