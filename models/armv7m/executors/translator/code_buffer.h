#pragma once

#include <cstddef>
#include <cstdint>

namespace capsoc::armv7m {

/// Memory for host code, mapped twice: once to be written, once to be executed, so that no page can
/// be both through one address. It is filled from the front and emptied as a whole. What never is
/// translated shall not pay for the mappings (40 us of a start of 4 ms), so they are made late.
class CodeBuffer {
 public:
  explicit CodeBuffer(std::size_t bytes) : size_(bytes) {}
  ~CodeBuffer();
  CodeBuffer(const CodeBuffer&) = delete;
  CodeBuffer& operator=(const CodeBuffer&) = delete;

  /// Maps it, once. False where the host refuses executable memory; nothing else may be
  /// called then, nor before this.
  bool open();
  /// Where the next code goes.
  std::size_t used() const { return used_; }
  std::size_t room() const { return size_ - used_; }
  /// The same byte as it is written and as it is executed.
  uint8_t* writable(std::size_t offset) const { return writable_ + offset; }
  const uint8_t* executable(std::size_t offset) const { return executable_ + offset; }
  /// Takes the next bytes; no more than room().
  void take(std::size_t bytes) { used_ += bytes; }
  /// Drops everything from an offset on.
  void cut(std::size_t offset) { used_ = offset; }

 private:
  std::size_t size_, used_ = 0;
  uint8_t* writable_ = nullptr;
  uint8_t* executable_ = nullptr;
};

}  // namespace capsoc::armv7m
