// The Verilated coprocessor with a fault, by CAPSOC_TEST_FAULT:
// - "value": a wrong bit of ANGLE, as a bus sees it
// - "hang", "crash" and "loop" (a combinational one): at its first sample
// - "node": a wrong node of the reference generator
#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "coprocessor/register_map.h"
#include "rtl/rtl_abi.h"

namespace {

const capsoc_rtl_api* real = nullptr;
const char* fault = "";

bool is(const char* name) {
  return std::strcmp(fault, name) == 0;
}

void eval(capsoc_rtl* instance) {
  real->eval(instance);
  capsoc_rtl_pins& pins = *real->pins(instance);
  if (is("value") && pins.psel && !pins.pwrite && pins.paddr == capsoc::coprocessor::reg_angle)
    pins.prdata ^= 1;
  if (!pins.sample_valid) return;
  for (volatile bool forever = is("hang"); forever;) {
  }
  if (is("loop")) {  // as vl_fatal() of Verilator ends, which is standard output
    std::fputs("%Error: polar_unit.sv:12: Active region did not converge.\nAborting...\n", stdout);
    std::abort();
  }
  if (!is("crash")) return;
  std::fputs("the RTL did not converge\n", stderr);
  std::abort();
}

void nodes(capsoc_rtl* instance, int64_t* values) {
  real->inside->nodes(instance, values);
  for (uint32_t i = 0; i < real->inside->node_count; ++i)
    if (is("node") && std::strcmp(real->inside->node_names[i], "sine") == 0) values[i] ^= 2;
}

}  // namespace

extern "C" const capsoc_rtl_api* capsoc_rtl_entry() {
  static capsoc_rtl_api api;
  if (const char* chosen = std::getenv("CAPSOC_TEST_FAULT")) fault = chosen;
  void* library = dlopen(LIBRARY, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) std::abort();
  real = reinterpret_cast<capsoc_rtl_entry_function>(dlsym(library, CAPSOC_RTL_ENTRY))();
  static capsoc_rtl_inside inside;
  inside = *real->inside;
  inside.nodes = nodes;
  api = *real;
  api.eval = eval;
  api.inside = &inside;
  return &api;
}
