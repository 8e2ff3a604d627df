// Libraries of other RTL: OTHER says what of it is not as in ours.
#include <string_view>

#include "rtl/rtl_abi.h"

namespace {

constexpr std::string_view other = OTHER;

#define NODE(name, stage, unit, format, model, when, rtl) #name,
const char* names[] = {
#include "coprocessor/nodes.def"
};

}  // namespace

extern "C" const capsoc_rtl_api* capsoc_rtl_entry() {
  static const capsoc_rtl_inside inside = [] {
    capsoc_rtl_inside with{};
    with.state_layout = other == "registers" ? "demod:1;" : capsoc_rtl_state_layout;
    if (other == "nodes") names[1] = "w";
    with.node_names = names;
    with.node_count = sizeof names / sizeof names[0];
    return with;
  }();
  static const capsoc_rtl_api api = [] {
    capsoc_rtl_api with{};
    with.abi_version = CAPSOC_RTL_ABI_VERSION;
    with.pins_size = sizeof(capsoc_rtl_pins);
    with.source_hash = "0123456789abcdef";
    with.channels = 1;
    if (other != "pins") with.inside = &inside;
    return with;
  }();
  return &api;
}
