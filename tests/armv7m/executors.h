#pragma once

#include <gtest/gtest.h>

#include <string>

#include "armv7m/core.h"

namespace capsoc::armv7m::test {

inline constexpr Executor all_executors[] = {Executor::stepping, Executor::blocks,
                                             Executor::translator};
/// Those that are compared with stepping.
inline constexpr Executor fast_executors[] = {Executor::blocks, Executor::translator};

/// The translator translates everything at once here.
inline void choose(Core& core, Executor executor, TranslatorLimits limits = {}) {
  limits.warm_up = 0;
  core.limit_translator(limits);
  core.set_executor(executor);
  core.set_translation_threshold(1);
}

/// A buffer for some dozens of blocks, so that they are dropped all the time.
inline TranslatorLimits smallest_translator() {
  TranslatorLimits limits;
  limits.buffer_bytes = TranslatorLimits::least_buffer;
  return limits;
}

/// False on hosts where blocks stand in for it.
inline bool has_translator() {
#if defined(__x86_64__)
  return true;
#else
  return false;
#endif
}

inline std::string executor_name(const testing::TestParamInfo<Executor>& executor) {
  return executor.param == Executor::stepping ? "Stepping"
         : executor.param == Executor::blocks ? "Blocks"
                                              : "Translator";
}

}  // namespace capsoc::armv7m::test
