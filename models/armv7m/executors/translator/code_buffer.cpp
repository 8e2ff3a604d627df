#include "armv7m/executors/translator/code_buffer.h"

#include <sys/mman.h>

namespace capsoc::armv7m {

/// Shared memory without a name, which mremap maps again (an old size of 0). A memfd would be
/// subject to the limit of file sizes, and perf takes its pages for those of a program on disk.
/// Both are executable at first and the second one ceases to be, since kernels that are hardened
/// (PR_SET_MDWE) let no page become executable later. perf learns of mmap, not of mremap.
bool CodeBuffer::open() {
  void* first = mmap(nullptr, size_, PROT_READ | PROT_EXEC,
                     MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (first == MAP_FAILED) return false;
  void* second = mremap(first, 0, size_, MREMAP_MAYMOVE);
  if (second != MAP_FAILED) {
    if (mprotect(second, size_, PROT_READ | PROT_WRITE) == 0) {
      executable_ = static_cast<uint8_t*>(first);
      writable_ = static_cast<uint8_t*>(second);
      return true;
    }
    munmap(second, size_);
  }
  munmap(first, size_);
  return false;
}

CodeBuffer::~CodeBuffer() {
  if (executable_ == nullptr) return;
  munmap(writable_, size_);
  munmap(const_cast<uint8_t*>(executable_), size_);
}

}  // namespace capsoc::armv7m
