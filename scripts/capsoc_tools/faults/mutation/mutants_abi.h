// The interface between the mutation run and a library that holds one netlist with all mutants.
#pragma once

#include "rtl/rtl_abi.h"

#define CAPSOC_MUTANTS_ENTRY "capsoc_mutants_entry"

extern "C" {

struct capsoc_mutants;

// As in capsoc_rtl_api. create: mutant 0 is the RTL as it is. Of the pins only those of the
// coprocessor itself are served.
struct capsoc_mutants_api {
  capsoc_mutants* (*create)(unsigned mutant);
  void (*destroy)(capsoc_mutants*);
  capsoc_rtl_pins* (*pins)(capsoc_mutants*);
  void (*eval)(capsoc_mutants*);
  void (*clock)(capsoc_mutants*);
};

typedef const capsoc_mutants_api* (*capsoc_mutants_entry_function)();

}  // extern "C"
