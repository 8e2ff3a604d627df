// The inside of a library of somebody's own design (capsoc_add_rtl_library() in rtl_library.cmake):
// rtl_abi.h over its pins.
#include "Vcapsoc_black_box.h"
#include "rtl/rtl_abi.h"
#include "rtl/verilated_instance.h"

struct capsoc_rtl : capsoc::rtl::VerilatedInstance<Vcapsoc_black_box> {
  void sample() { capsoc::rtl::fetch_pins(*top, pins); }
};

extern "C" __attribute__((visibility("default"))) const capsoc_rtl_api* capsoc_rtl_entry() {
  static constexpr capsoc_rtl_api api =
      capsoc::rtl::api_of<capsoc_rtl>(CAPSOC_RTL_ABSENT_PINS, nullptr);
  return &api;
}
