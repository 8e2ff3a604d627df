#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "armv7m/executors/step.h"

namespace capsoc::armv7m {

/// Directly mapped memory: a flat table of 4 KiB pages with host pointers. A null pointer selects
/// the slow path: for a device, for the rest of a page that a region fills only in part, or for a
/// store into a page with decoded code. Guest and host are little-endian.
class Memory {
 public:
  struct Page {
    uint8_t* read = nullptr;  // host address of the page's first byte
    uint8_t* write = nullptr;
    CodePage* code = nullptr;  // decoded blocks, if any
    uint32_t wait_states = 0;
    bool mixed = false;  // of a view: region borders cross the page, so every access is checked
  };
  struct Region {
    uint32_t base, size;
    uint8_t* host;
    bool writable;
    uint32_t wait_states;
  };
  static constexpr unsigned page_bits = 12;
  static constexpr uint32_t page_size = 1u << page_bits;

  Memory();
  ~Memory();
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  void map(const Region& region);
  void unmap(uint32_t base, uint32_t size);
  const Region* find(uint32_t address) const;
  /// Of the region at an address; 0 where there is none.
  uint32_t wait_states(uint32_t address) const;

  Page& page(uint32_t address) { return pages_[address >> page_bits]; }
  const Page& page(uint32_t address) const { return pages_[address >> page_bits]; }
  Page* table() const { return pages_; }
  /// A further table with a subset of the pages. For unprivileged and for privileged code: pages
  /// that the MPU allows without a check. Without an MPU: pages that are not watched. Filled page
  /// by page, cleared as a whole.
  enum class View : uint8_t { user, privileged, unprotected };
  Page* view(View which);
  /// A page of a view, to be filled.
  Page& view_page(Page* view, uint32_t address);
  void clear_views();

  /// The decoded-code record of an address in mapped memory, created on demand; null elsewhere.
  CodePage* code_page(uint32_t address);

  /// Host bytes for a store of at most 64 bytes into a page with code, if its lines have no code
  /// and are not closed; else null.
  uint8_t* beside_code(uint32_t address, uint32_t size) const;
  /// Closes a range of at most a page to direct stores, in place of the previous range. Call again
  /// after memory was mapped or all code dropped.
  void guard(uint32_t address, uint32_t size);

  /// Drops decoded code that may contain any byte of the range; true if there was some.
  bool invalidate(uint32_t address, uint32_t size);
  void invalidate_all();

  /// Frees what was invalidated; only between blocks.
  void collect() { retired_.clear(); }

  uint32_t largest_wait() const { return largest_wait_; }

  const std::vector<Region>& regions() const { return regions_; }
  /// The numbers of the pages with decoded code.
  const std::vector<uint32_t>& code_pages() const { return code_pages_; }
  /// Counts the changes that may change the result of these two.
  uint64_t changes() const { return changes_; }
  /// Counts the changes that remove pages from a view.
  uint64_t view_changes() const { return view_changes_; }
  /// Call after all host code was dropped.
  void forget_entries();

 private:
  void refresh(uint32_t base, uint32_t size);
  void retire(uint32_t page_index);
  void close(uint32_t address, uint32_t size, bool closed);

  Page* pages_;
  std::array<Page*, 3> views_{};
  std::array<std::vector<uint32_t>, 3> filled_;  // pages of each view
  std::vector<Region> regions_;
  std::vector<uint32_t> code_pages_;
  std::vector<std::unique_ptr<CodePage>> retired_;
  uint32_t largest_wait_ = 0;
  uint32_t guarded_ = 0, guarded_size_ = 0;
  uint64_t changes_ = 0, view_changes_ = 0;
};

}  // namespace capsoc::armv7m
