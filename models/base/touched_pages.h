#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace capsoc {

/// Which pages of a range of this process's private memory may hold something: a page that was
/// never touched is 0, and looking at it would make the system map it. Linux tells (proc(5),
/// pagemap); where it does not, every page counts as touched. As it was when this was made.
class TouchedPages {
 public:
  TouchedPages(const uint8_t* bytes, std::size_t size);

  /// Whether one of `size` bytes from `offset` on, in the range, lies in a touched page.
  bool any(std::size_t offset, std::size_t size) const;

 private:
  std::size_t first_offset_ = 0;  // of the range in its first page
  std::size_t page_ = 1;
  std::vector<bool> touched_;  // empty: not known
};

}  // namespace capsoc
