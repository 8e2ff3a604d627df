// A library of other RTL sources.
#include "rtl/rtl_abi.h"

extern "C" const capsoc_rtl_api* capsoc_rtl_entry() {
  static const capsoc_rtl_api api = [] {
    capsoc_rtl_api stale{};
    stale.abi_version = CAPSOC_RTL_ABI_VERSION;
    stale.pins_size = sizeof(capsoc_rtl_pins);
    stale.state_size = sizeof(capsoc_rtl_state);
    stale.source_hash = "0123456789abcdef";
    return stale;
  }();
  return &api;
}
