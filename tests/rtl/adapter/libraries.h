// The libraries of the build, opened: those of the program, or with CAPSOC_CHECKED_RTL=1 in the
// environment those whose assertions are switched on.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "coprocessor/types.h"
#include "rtl/rtl_library.h"

namespace capsoc::rtl::test {

inline coprocessor::Options options_of(coprocessor::Arithmetic arithmetic) {
  coprocessor::Options options;
  options.arithmetic = arithmetic;
  return options;
}

inline RtlLibrary::Handle open_library(coprocessor::Arithmetic arithmetic) {
  std::string name = RtlLibrary::file_name(arithmetic);
  if (std::getenv("CAPSOC_CHECKED_RTL") != nullptr) name.insert(name.rfind('.'), "_checked");
  auto library = RtlLibrary::open(name, options_of(arithmetic));
  if (!library) {
    ADD_FAILURE() << library.error();
    return nullptr;
  }
  return library.value();
}

}  // namespace capsoc::rtl::test
