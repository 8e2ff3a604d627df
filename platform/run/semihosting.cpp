#include "run/semihosting.h"

#include <spdlog/spdlog.h>

namespace capsoc::run {
namespace {

constexpr uint32_t sys_writec = 0x03, sys_write0 = 0x04, sys_exit = 0x18, sys_exit_extended = 0x20;
constexpr uint32_t application_exit = 0x20026;  // ADP_Stopped_ApplicationExit
constexpr uint32_t longest_text = 4096;

}  // namespace

bool Semihosting::call(cortex_m3::Core& core) {
  const uint32_t operation = core.reg(0), argument = core.reg(1);
  switch (operation) {
    case sys_exit:  // in 32-bit states the argument is the reason itself and carries no status
      exit_status_ = argument == application_exit ? 0 : 1;
      return false;
    case sys_exit_extended: {
      uint32_t block[2] = {0, 1};
      if (!core.debug_read(argument, block, sizeof block)) {
        spdlog::warn("semihosting: SYS_EXIT_EXTENDED points to {:#010x}, where nothing can be read",
                     argument);
        block[1] = 1;
      }
      exit_status_ = block[0] == application_exit ? static_cast<int>(block[1]) : 1;
      return false;
    }
    case sys_writec: {
      char character = 0;
      if (core.debug_read(argument, &character, 1)) put(character);
      return true;
    }
    case sys_write0:
      write0(core, argument);
      return true;
    default:
      spdlog::warn("semihosting: operation {:#x} is not supported; r0 becomes -1", operation);
      core.set_reg(0, 0xFFFFFFFF);
      return true;
  }
}

void Semihosting::write0(cortex_m3::Core& core, uint32_t address) {
  char character = 0;
  for (uint32_t i = 0;
       i < longest_text && core.debug_read(address + i, &character, 1) && character != 0; ++i)
    put(character);
}

void Semihosting::put(char character) {
  if (character != '\n') line_ += character;
  if (character != '\n' && line_.size() < longest_text) return;
  spdlog::info("semihosting: {}", line_);
  line_.clear();
}

}  // namespace capsoc::run
