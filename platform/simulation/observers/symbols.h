// Places in memory as settings name them.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "source/call_stack.h"

namespace capsoc::run {

/// Of a symbol or an address (0x20001000). An Error names the setting and what comes near.
Result<uint32_t> address_of(const std::string& text, const std::string& setting,
                            const source::Program& program);

}  // namespace capsoc::run
