// The main stack, for AddressSanitizer; in no other build. SystemC names the stack of a process
// that it switches to, but neither place nor size of the main one, and none at all once a process
// has ended. Exceptions on the main stack would leave marks there, which later calls would meet as
// errors that are none.
#include <dlfcn.h>
#include <pthread.h>
#include <sanitizer/common_interface_defs.h>

#include <cstddef>
#include <cstdint>

namespace {

struct Stack {
  void* lowest = nullptr;
  std::size_t size = 0;

  bool has(const void* place) const {
    return reinterpret_cast<uintptr_t>(place) - reinterpret_cast<uintptr_t>(lowest) < size;
  }
};

Stack own_stack() {
  Stack stack;
  pthread_attr_t attributes;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return stack;
  pthread_attr_getstack(&attributes, &stack.lowest, &stack.size);
  pthread_attr_destroy(&attributes);
  return stack;
}

const Stack main_stack = own_stack();

}  // namespace

extern "C" {

/// The linker's options name it, which brings this file into a program.
extern const char capsoc_main_stack;
const char capsoc_main_stack = 0;

/// Instead of the sanitizer's, which compiled code calls before an exception leaves functions.
__attribute__((no_sanitize("address"))) void __asan_handle_no_return() {
  const char here = 0;
  if (main_stack.has(&here)) {
    __sanitizer_start_switch_fiber(nullptr, main_stack.lowest, main_stack.size);
    __sanitizer_finish_switch_fiber(nullptr, nullptr, nullptr);
  }
  static const auto original =
      reinterpret_cast<void (*)()>(dlsym(RTLD_NEXT, "__asan_handle_no_return"));
  original();
}
}
