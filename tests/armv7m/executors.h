#pragma once

#include <gtest/gtest.h>

#include <ostream>
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

/// The same with each core.
struct FastCore {
  Executor executor;
  const Profile* profile;
};
inline constexpr FastCore fast_cores[] = {
    {Executor::blocks, &cortex_m3},     {Executor::translator, &cortex_m3},
    {Executor::blocks, &cortex_m0plus}, {Executor::translator, &cortex_m0plus},
    {Executor::blocks, &cortex_m4},     {Executor::translator, &cortex_m4},
    {Executor::blocks, &cortex_m4f},    {Executor::translator, &cortex_m4f}};
inline std::ostream& operator<<(std::ostream& out, const FastCore& core) {
  return out << core.profile->name;
}
inline std::string core_name(const testing::TestParamInfo<FastCore>& tested) {
  const std::string executor =
      executor_name(testing::TestParamInfo<Executor>(tested.param.executor, 0));
  const Profile* profile = tested.param.profile;
  return executor + (profile == &cortex_m0plus ? "CortexM0plus"
                     : profile == &cortex_m4   ? "CortexM4"
                     : profile == &cortex_m4f  ? "CortexM4WithFpu"
                                               : "");
}

}  // namespace capsoc::armv7m::test
