#include "base/touched_pages.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>

namespace capsoc {
namespace {

/// Bits of an entry of the page map: in memory, or in the swap.
constexpr uint64_t present = uint64_t{1} << 63U, swapped = uint64_t{1} << 62U;
/// For less the answer costs more than the pages.
constexpr std::size_t worth_asking = std::size_t{256} << 10U;

}  // namespace

TouchedPages::TouchedPages(const uint8_t* bytes, std::size_t size) {
  if (size < worth_asking) return;
  page_ = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<uintptr_t>(bytes);
  const std::size_t first = begin / page_, count = (begin + size - 1) / page_ - first + 1;
  first_offset_ = begin % page_;
  const int map = open("/proc/self/pagemap", O_RDONLY | O_CLOEXEC);
  if (map < 0) return;
  std::vector<uint64_t> entries(count);
  const std::size_t wanted = count * sizeof(uint64_t);
  std::size_t done = 0;
  while (done < wanted) {
    const ssize_t read = pread(map, reinterpret_cast<char*>(entries.data()) + done, wanted - done,
                               static_cast<off_t>(first * sizeof(uint64_t) + done));
    if (read <= 0) break;
    done += static_cast<std::size_t>(read);
  }
  close(map);
  if (done < wanted) return;
  touched_.reserve(count);
  for (const uint64_t entry : entries) touched_.push_back((entry & (present | swapped)) != 0);
}

bool TouchedPages::any(std::size_t offset, std::size_t size) const {
  if (touched_.empty()) return true;
  const auto at = [this](std::size_t byte) {
    return touched_.begin() + static_cast<std::ptrdiff_t>((first_offset_ + byte) / page_);
  };
  const auto end = at(offset + size - 1) + 1;
  return std::find(at(offset), end, true) != end;
}

}  // namespace capsoc
