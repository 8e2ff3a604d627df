#include "armv7m/execution_counts.h"

#include <cstdlib>
#include <new>

namespace capsoc::armv7m {
namespace {

constexpr uint32_t page_count = 1u << (32 - ExecutionCounts::page_bits);

uint32_t halfword_of(uint32_t address) {
  return address % (2 * ExecutionCounts::halfwords) / 2;
}

bool is_conditional(const DecodedOp& op) {
  return op.operation == Operation::bcond || op.operation == Operation::cbz ||
         op.operation == Operation::cbnz;
}

uint64_t key(uint32_t high, uint32_t low) {
  return uint64_t{high} << 32 | low;
}

}  // namespace

// calloc leaves the untouched part of the table without real memory.
ExecutionCounts::ExecutionCounts()
    : pages_(static_cast<Page**>(std::calloc(page_count, sizeof(void*)))) {
  if (pages_ == nullptr) throw std::bad_alloc();
}

ExecutionCounts::~ExecutionCounts() {
  for (const uint32_t number : page_numbers_) delete pages_[number];
  std::free(pages_);
}

ExecutionCounts::Page& ExecutionCounts::page(uint32_t address) {
  const uint32_t number = address >> page_bits;
  if (pages_[number] == nullptr) {
    pages_[number] = new Page;
    page_numbers_.push_back(number);
  }
  return *pages_[number];
}

void ExecutionCounts::add(Page& page, Change change, uint64_t times) {
  const uint32_t halfword = halfword_of(change.address);
  switch (change.kind) {
    case Kind::arrive:
      page.line[halfword] += static_cast<int64_t>(times);
      break;
    case Kind::depart:
      page.line[halfword] -= static_cast<int64_t>(times);
      break;
    case Kind::skip:
      page.skipped[halfword] += times;
      break;
    case Kind::take:
      page.taken[halfword] += times;
      break;
  }
}

void ExecutionCounts::note(Change change) {
  add(page(change.address), change, 1);
  if (recording_) recorded_.push_back(change);
}

void ExecutionCounts::decoded(const DecodedOp& op) {
  constexpr uint32_t r0 = 1, sp = 1 << 13;
  uint32_t changes = written_by(op);
  if (op.operation == Operation::msr) changes |= sp;
  if (op.operation == Operation::bkpt) changes |= r0;
  page(op.address).changes[halfword_of(op.address)] |= static_cast<uint16_t>(changes);
}

void ExecutionCounts::moved(uint32_t from, uint32_t to) {
  if (from == to) return;
  note({Kind::depart, from});
  note({Kind::arrive, to});
}

void ExecutionCounts::left(const DecodedOp& op, uint32_t pc) {
  if (is_conditional(op)) note({Kind::take, op.address});
  moved(next_address(op), pc);
}

void ExecutionCounts::skipped(const DecodedOp& op) {
  for (uint32_t at = op.address; at != next_address(op); at += 2) note({Kind::skip, at});
}

void ExecutionCounts::begins(uint32_t pc) {
  if (begun_) return moved(standing_, pc);
  begun_ = true;
  note({Kind::arrive, pc});
}

void ExecutionCounts::record(bool on) {
  if (on) recorded_.clear();
  recording_ = on;
}

void ExecutionCounts::repeat(uint64_t times) {
  for (const Change& each : recorded_) add(page(each.address), each, times);
}

uint64_t* ExecutionCounts::branch(const DecodedOp& op, uint32_t target) {
  // Instructions have even addresses; a program may put another one in the place of this one.
  uint64_t*& counter = branch_counters_[key(op.address | (op.size == 4 ? 1 : 0),
                                            target | (is_conditional(op) ? 1 : 0))];
  if (counter == nullptr) {
    branches_.push_back({op.address, next_address(op), target, is_conditional(op), 0});
    counter = &branches_.back().count;
  }
  return counter;
}

int64_t* ExecutionCounts::line(uint32_t address) {
  return &page(address).line[halfword_of(address)];
}

uint64_t* ExecutionCounts::skips(uint32_t first, uint32_t behind) {
  uint64_t*& counter = skip_counters_[key(first, behind)];
  if (counter == nullptr) {
    skips_.push_back({first, behind, 0});
    counter = &skips_.back().count;
  }
  return counter;
}

std::map<uint32_t, ExecutionCounts::Totals> ExecutionCounts::totals() const {
  std::map<uint32_t, Page> pages;
  for (const uint32_t number : page_numbers_) pages[number] = *pages_[number];
  const auto change = [&pages](Kind kind, uint32_t address, uint64_t times) {
    add(pages[address >> page_bits], {kind, address}, times);
  };
  for (const Branch& each : branches_) {
    change(Kind::depart, each.from, each.count);
    change(Kind::arrive, each.to, each.count);
    if (each.conditional) change(Kind::take, each.address, each.count);
  }
  for (const Skip& each : skips_)
    for (uint32_t at = each.first; at != each.behind; at += 2) change(Kind::skip, at, each.count);
  if (begun_) change(Kind::depart, standing_, 1);

  std::map<uint32_t, Totals> totals;
  uint64_t count = 0;
  uint32_t next = 0;
  const auto fill_up_to = [&](uint32_t number) {
    for (; count != 0 && next < number; ++next) totals[next].executed.fill(count);
  };
  for (const auto& [number, page] : pages) {
    fill_up_to(number);
    Totals& sums = totals[number];
    for (uint32_t i = 0; i < halfwords; ++i) {
      count += static_cast<uint64_t>(page.line[i]);
      sums.executed[i] = count;
    }
    sums.skipped = page.skipped;
    sums.taken = page.taken;
    next = number + 1;
  }
  return totals;
}

uint32_t ExecutionCounts::changed_registers(const std::map<uint32_t, Totals>& before) const {
  constexpr uint32_t below_pc = 0x7FFF;
  uint32_t changed = 0;
  const std::map<uint32_t, Totals> now = totals();
  for (const uint32_t number : page_numbers_) {
    const auto sums = now.find(number), old = before.find(number);
    if (sums == now.end()) continue;
    for (uint32_t i = 0; i < halfwords; ++i)
      if (sums->second.executed[i] != (old == before.end() ? 0 : old->second.executed[i]))
        changed |= pages_[number]->changes[i];
  }
  return changed & below_pc;
}

}  // namespace capsoc::armv7m
