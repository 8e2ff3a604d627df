#include <asmjit/x86.h>
#include <xmmintrin.h>

#include <algorithm>

#include "armv7m/executors/block_links.h"
#include "armv7m/executors/blocks.h"
#include "armv7m/executors/translator/block_compiler.h"
#include "armv7m/executors/translator/translator.h"
#include "armv7m/machine.h"
#include "base/host_features.h"

namespace capsoc::armv7m {
namespace {

constexpr uint8_t never = 255;  // its first step is left to C++

unsigned index_of(uint32_t address) {
  return (address & (Memory::page_size - 1)) >> 1;
}

class HostTranslator : public Translator {
 public:
  HostTranslator(Machine& machine, Blocks& blocks, const TranslatorLimits& limits)
      : machine_(machine),
        blocks_(blocks),
        context_(machine.host_context),
        buffer_(std::max(limits.buffer_bytes, TranslatorLimits::least_buffer)),
        compiler_(machine, context_, buffer_),
        threshold_(limits.threshold),
        warm_up_(limits.warm_up) {}

  TranslationCounts counts() const override;
  const std::string& refusal() const override { return refusal_; }
  void set_threshold(uint8_t executions) override { threshold_ = executions; }
  void run(uint64_t limit) override;

 private:
  using Entry = uint32_t (*)(State*, const void*);

  bool open();
  const Step* go_on(const Step* head);
  const void* heat(const Step* head, CodePage& page);
  const Step* execute(const void* entry, uint64_t left);
  const Step* leave(const BlockExit& exit);
  void refresh_fpu();
  void refresh_windows();
  void open_windows(const Memory::Region& region, std::size_t number);
  void drop_all();

  Machine& machine_;
  Blocks& blocks_;
  HostContext& context_;
  CodeBuffer buffer_;
  BlockCompiler compiler_;
  TranslationCounts counts_;
  std::size_t frame_ = 0, first_block_ = 0;
  std::string refusal_;
  uint8_t threshold_;
  uint64_t warm_up_;
  uint64_t limit_ = 0;
  uint64_t windows_of_ = ~uint64_t{0};  // Memory::changes() that the windows show
  uint64_t jumps_of_ = ~uint64_t{0};    // Memory::view_changes() that the jump cache is good for
};

void HostTranslator::run(uint64_t limit) {
  limit_ = limit;
  const State& state = machine_.state;
  const uint64_t before = state.instructions;
  if (counts_.executed < warm_up_) {
    blocks_.run(std::min(limit, state.cycles + warm_up_));
  } else {
    const Step* op = blocks_.begin(limit);
    while (op != nullptr) op = go_on(op);
  }
  counts_.executed += state.instructions - before;
}

/// Maps the buffer and writes what all blocks have in common, the first time.
bool HostTranslator::open() {
  if (first_block_ != 0) return true;
  if (!refusal_.empty()) return false;
  if (!buffer_.open()) {
    refusal_ = "this system refuses executable memory";
    if (machine_.listeners.untranslated) machine_.listeners.untranslated(refusal_);
    return false;
  }
  frame_ = compiler_.emit_frame();
  first_block_ = buffer_.used();
  return true;
}

TranslationCounts HostTranslator::counts() const {
  TranslationCounts counts = counts_;
  counts.stepped = blocks_.stepped();
  return counts;
}

/// Executes from the first step of a block on; what comes next, or null for the run loop to decide.
const Step* HostTranslator::go_on(const Step* head) {
  CodePage* page = machine_.memory.direct(head->address).code;
  // Translated code relies on the two bits of SP that are always zero; a restored state may not.
  const bool odd_stack = (machine_.state.r[13] & 3) != 0;
  if (page == nullptr || odd_stack || machine_.memory.is_watched())
    return head->chain(machine_, head);
  const void* entry = page->entries[index_of(head->address)];
  if (entry == nullptr) entry = heat(head, *page);
  const uint64_t used = machine_.state.cycles + compiler_.largest_bound();
  if (entry == nullptr || used >= limit_) return head->chain(machine_, head);
  return execute(entry, limit_ - used - 1);
}

/// Counts the executions of a block; its code when they are many.
const void* HostTranslator::heat(const Step* head, CodePage& page) {
  uint8_t& count = page.heat[index_of(head->address)];
  if (count == never) return nullptr;
  if (++count < threshold_ || !open()) return nullptr;
  if (compiler_.full()) drop_all();
  refresh_windows();
  const std::size_t before = buffer_.used();
  compiler_.list(static_cast<bool>(machine_.listeners.translated));
  const void* entry = compiler_.emit(head, page);
  count = never;
  if (entry == nullptr) return nullptr;
  page.entries[index_of(head->address)] = entry;
  ++counts_.blocks;
  counts_.bytes += buffer_.used() - before;
  if (machine_.listeners.translated)
    machine_.listeners.translated({head->address, buffer_.executable(before), before,
                                   buffer_.used() - before, counts_.evictions,
                                   compiler_.listing()});
  return entry;
}

/// Runs translated code for `left` cycles, and at most one block beyond.
const Step* HostTranslator::execute(const void* entry, uint64_t left) {
  constexpr uint64_t most = 0x7FFFFFFF;  // what the counters hold
  State& state = machine_.state;
  left = std::min(left, most);
  refresh_windows();
  if (machine_.profile.has_fpu()) refresh_fpu();
  context_.set_left(static_cast<int64_t>(left));
  context_.recipe = 0;
  context_.recipes = &compiler_.recipe(0);
  const auto enter = reinterpret_cast<Entry>(  // NOLINT: code that was written by BlockCompiler
      reinterpret_cast<uintptr_t>(buffer_.executable(frame_)));
  const uint64_t before = state.instructions;
  const BlockExit& exit = compiler_.exits()[enter(&state, entry)];
  context_.count(state);
  counts_.instructions += state.instructions - before;
  compiler_.recipe(exit.recipe).settle(state, context_.aside, compiler_.recipe(context_.recipe));
  return leave(exit);
}

const Step* HostTranslator::leave(const BlockExit& exit) {
  State& state = machine_.state;
  if (exit.kind == BlockExit::Kind::step) {
    const bool closes = exit.step->operation == Operation::fall_through;
    counts_.instructions += exit.step->instructions_to - (closes ? 0u : 1u);
    if (state.cycles + exit.bound < limit_) return exit.step->chain(machine_, exit.step);
    blocks_.run_to_limit(exit.step);
    return nullptr;
  }
  if (exit.kind == BlockExit::Kind::edge) state.pc = exit.pc;
  state.trail = exit.trail;
  if (machine_.requests.any()) return nullptr;
  const Step* next = BlockLinks::find(machine_);
  if (next == nullptr || timing::hangs_on(state.trail, *next) || !blocks_.fits(*next))
    return nullptr;
  const bool completes = (state.trail & timing::trail_refill) != 0;
  BlockLinks::arrive(state, *next);
  if (exit.slot == BlockExit::no_slot) return next;
  const CodePage* page = machine_.memory.direct(state.pc).code;
  const auto* entry =
      static_cast<const uint8_t*>(page != nullptr ? page->entries[index_of(state.pc)] : nullptr);
  if (entry == nullptr) return next;
  if (completes) entry -= BlockEdges::refill_bytes;
  std::memcpy(buffer_.writable(exit.slot), &entry, sizeof entry);
  return next;
}

/// Who may use the floating-point extension, and FPSCR, may have changed.
void HostTranslator::refresh_fpu() {
  constexpr unsigned raised = 0x3F, at_start = 0x1F80;  // of MXCSR
  const uint32_t status = machine_.state.fpu.status().bits();
  context_.fp_open = machine_.floating_point.is_open() ? 1 : 0;
  context_.fp_host = (_mm_getcsr() & ~raised) == at_start ? 1 : 0;
  const bool native = (status & (Fpscr::modes | Fpscr::inexact)) == Fpscr::inexact;
  context_.fp_native = native ? context_.fp_host : 0;
}

/// What can be reached directly may have changed.
void HostTranslator::refresh_windows() {
  const Memory& memory = machine_.memory.map();
  const Memory::Page* pages = machine_.memory.pages();
  const bool same = context_.pages == pages && windows_of_ == memory.changes();
  if (!same || jumps_of_ != memory.view_changes()) context_.jumps.clear();
  jumps_of_ = memory.view_changes();
  if (same) return;
  context_.pages = pages;
  windows_of_ = memory.changes();
  context_.read.fill({});
  context_.write.fill({});
  context_.write_from_base.fill({});
  const auto& regions = memory.regions();
  for (std::size_t i = 0; i < regions.size() && i < HostContext::windows; ++i)
    open_windows(regions[i], i);
  context_.closed = machine_.memory.is_whole_view() ? 0 : ~uint64_t{0};
  if (machine_.memory.is_whole_view()) return;
  for (auto* windows : {&context_.read, &context_.write, &context_.write_from_base})
    for (MemoryWindow& window : *windows) std::fill_n(window.units, 3, 0);
}

/// The whole pages of a region for reading; for writing two rows of them without code.
void HostTranslator::open_windows(const Memory::Region& region, std::size_t number) {
  const bool aligned = (region.base & (Memory::page_size - 1)) == 0;
  const uint32_t size = region.size & ~(Memory::page_size - 1);
  if (!aligned || size == 0) return;
  const auto open = [&](MemoryWindow& window, uint32_t from, uint32_t bytes, bool fixed) {
    window = {{bytes, bytes / 2, bytes / 4},
              region.host + (from - region.base),
              reinterpret_cast<uintptr_t>(region.host) - region.base,
              from,
              fixed,
              region.wait_states};
  };
  open(context_.read[number], region.base, size, true);
  if (!region.writable) return;
  std::vector<uint32_t> code = machine_.memory.map().code_pages();
  std::sort(code.begin(), code.end());
  uint32_t from = region.base, best = region.base, longest = 0, first = 0;
  const uint32_t end = region.base + size;  // 0 at the top of the address space
  const auto row = [&](uint32_t until) {
    if (from == region.base) first = until - from;
    if (until - from > longest) {
      longest = until - from;
      best = from;
    }
  };
  for (const uint32_t index : code) {
    const uint32_t page = index << Memory::page_bits;
    if (page - region.base >= size) continue;
    row(page);
    from = page + Memory::page_size;
  }
  row(end);
  if (longest != 0) open(context_.write[number], best, longest, false);
  open(context_.write_from_base[number], region.base, first, true);
}

/// The buffer is full: everything is translated again where it is still hot.
void HostTranslator::drop_all() {
  machine_.memory.map().forget_entries();
  context_.jumps.clear();
  buffer_.cut(first_block_);
  compiler_.forget();
  ++counts_.evictions;
}

}  // namespace

std::unique_ptr<Translator> Translator::make(Machine& machine, Blocks& blocks,
                                             const TranslatorLimits& limits, std::string& reason) {
  if (!limits.bit_manipulation || !host_has_bit_manipulation()) {
    reason = "this processor has no BMI1 and BMI2";
    return nullptr;
  }
  return std::make_unique<HostTranslator>(machine, blocks, limits);
}

}  // namespace capsoc::armv7m
