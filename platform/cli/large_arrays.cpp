// Large arrays in large pages. SystemC clears three megabytes for its temporary values when it is
// loaded: hundreds of page faults, a sixth of a short run's time. CMake's option CAPSOC_LARGE_PAGES
// leaves it out.
#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <new>

// AddressSanitizer has its own operators, which belong together.
#ifndef __SANITIZE_ADDRESS__

namespace {

constexpr std::size_t large_page = std::size_t{1} << 21;

}  // namespace

/// As in the standard library, which frees with free(), except for the location of large arrays.
void* operator new[](std::size_t size) {
  if (size < large_page || size > SIZE_MAX - large_page) return operator new(size);
  const std::size_t whole = (size + large_page - 1) & ~(large_page - 1);
  void* const memory = std::aligned_alloc(large_page, whole);
  if (memory == nullptr) return operator new(size);  // throws, after what it tries
  madvise(memory, whole, MADV_HUGEPAGE);             // a wish
  return memory;
}

#endif
