#include <cstdio>

#include "cortex_m3/executors/translator/block_emitter.h"
#include "cortex_m3/isa/decoder.h"

namespace capsoc::cortex_m3 {

using namespace asmjit;

/// The library writes what it assembles behind these lines.
void BlockEmitter::begin_listing() {
  log_.clear();
  if (!listing_wanted_) return;
  log_.setFlags(FormatFlags::kMachineCode | FormatFlags::kHexImms | FormatFlags::kHexOffsets);
  log_.setIndentation(FormatIndentationGroup::kCode, 12);
  log_.setIndentation(FormatIndentationGroup::kLabel, 10);
  code_.setLogger(&log_);
}

void BlockEmitter::list_step(const Step& step) {
  if (!listing_wanted_) return;
  char text[160];
  std::snprintf(text, sizeof text, "%08x %s", static_cast<unsigned>(step.address),
                step.operation == Operation::fall_through ? "(goes on behind the block)"
                                                          : disassemble(step).c_str());
  list_line(text);
}

void BlockEmitter::list_line(const char* text) {
  if (listing_wanted_) log_.logf("  %s\n", text);
}

}  // namespace capsoc::cortex_m3
