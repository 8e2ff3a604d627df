#include "cortex_m3/executors/translator/code_buffer.h"

#include <sys/mman.h>
#include <unistd.h>

namespace capsoc::cortex_m3 {
namespace {

uint8_t* map(int file, std::size_t size, int protection) {
  void* address = mmap(nullptr, size, protection, MAP_SHARED, file, 0);
  return address == MAP_FAILED ? nullptr : static_cast<uint8_t*>(address);
}

}  // namespace

CodeBuffer::CodeBuffer(std::size_t bytes) : size_(bytes) {
  const int file = memfd_create("capsoc-code", MFD_CLOEXEC);
  if (file < 0) return;
  if (ftruncate(file, static_cast<off_t>(size_)) == 0) {
    writable_ = map(file, size_, PROT_READ | PROT_WRITE);
    if (writable_ != nullptr) executable_ = map(file, size_, PROT_READ | PROT_EXEC);
  }
  close(file);
}

CodeBuffer::~CodeBuffer() {
  if (writable_ != nullptr) munmap(writable_, size_);
  if (executable_ != nullptr) munmap(const_cast<uint8_t*>(executable_), size_);
}

}  // namespace capsoc::cortex_m3
