// The two libraries of the build, opened.
#pragma once

#include <gtest/gtest.h>

#include "coprocessor/types.h"
#include "rtl/rtl_library.h"

namespace capsoc::rtl::test {

inline coprocessor::Options options_of(coprocessor::Arithmetic arithmetic) {
  coprocessor::Options options;
  options.arithmetic = arithmetic;
  return options;
}

inline RtlLibrary::Handle open_library(coprocessor::Arithmetic arithmetic) {
  auto library = RtlLibrary::open(RtlLibrary::file_name(arithmetic), options_of(arithmetic));
  if (!library) {
    ADD_FAILURE() << library.error();
    return nullptr;
  }
  return library.value();
}

}  // namespace capsoc::rtl::test
