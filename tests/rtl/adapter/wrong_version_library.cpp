// A library of a later interface.
#include "rtl/rtl_abi.h"

extern "C" const capsoc_rtl_api* capsoc_rtl_entry() {
  static const capsoc_rtl_api api = [] {
    capsoc_rtl_api later{};
    later.abi_version = CAPSOC_RTL_ABI_VERSION + 1;
    return later;
  }();
  return &api;
}
