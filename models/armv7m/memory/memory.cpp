#include "armv7m/memory/memory.h"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace capsoc::armv7m {

// calloc leaves the untouched part of the 32 MiB table without real memory; all-zero is the empty
// page.
Memory::Memory() : pages_(static_cast<Page*>(std::calloc(1u << 20, sizeof(Page)))) {
  if (pages_ == nullptr) throw std::bad_alloc();
}

Memory::~Memory() {
  invalidate_all();
  std::free(pages_);
  for (Page* view : views_) std::free(view);
}

Memory::Page* Memory::view(View which) {
  Page*& view = views_[static_cast<std::size_t>(which)];
  if (view == nullptr) view = static_cast<Page*>(std::calloc(1u << 20, sizeof(Page)));
  if (view == nullptr) throw std::bad_alloc();
  return view;
}

Memory::Page& Memory::view_page(Page* view, uint32_t address) {
  const auto which = std::find(views_.begin(), views_.end(), view) - views_.begin();
  filled_[static_cast<std::size_t>(which)].push_back(address >> page_bits);
  return view[address >> page_bits];
}

void Memory::clear_views() {
  ++view_changes_;
  for (unsigned i = 0; i < views_.size(); ++i) {
    for (uint32_t index : filled_[i]) views_[i][index] = Page{};
    filled_[i].clear();
  }
}

void Memory::map(const Region& region) {
  if (region.size == 0 || region.host == nullptr) return;
  unmap(region.base, region.size);
  regions_.push_back(region);
  largest_wait_ = std::max(largest_wait_, region.wait_states);
  invalidate_all();
  refresh(region.base, region.size);
}

void Memory::unmap(uint32_t base, uint32_t size) {
  if (size == 0) return;
  uint64_t end = uint64_t{base} + size;
  std::vector<Region> kept;
  for (const Region& r : regions_) {
    uint64_t r_end = uint64_t{r.base} + r.size;
    if (r_end <= base || r.base >= end) {
      kept.push_back(r);
      continue;
    }
    if (r.base < base) kept.push_back({r.base, base - r.base, r.host, r.writable, r.wait_states});
    if (r_end > end) {
      uint32_t skip = static_cast<uint32_t>(end - r.base);
      kept.push_back({r.base + skip, r.size - skip, r.host + skip, r.writable, r.wait_states});
    }
  }
  regions_ = std::move(kept);
  invalidate_all();
  refresh(base, size);
}

const Memory::Region* Memory::find(uint32_t address) const {
  for (const Region& r : regions_) {
    if (address - r.base < r.size) return &r;
  }
  return nullptr;
}

uint32_t Memory::wait_states(uint32_t address) const {
  if (const Page& whole = pages_[address >> page_bits]; whole.read != nullptr)
    return whole.wait_states;
  const Region* region = find(address);
  return region != nullptr ? region->wait_states : 0;
}

void Memory::refresh(uint32_t base, uint32_t size) {
  clear_views();
  ++changes_;
  uint64_t first = base >> page_bits, last = (uint64_t{base} + size - 1) >> page_bits;
  for (uint64_t index = first; index <= last && index < (1u << 20); ++index) {
    uint32_t address = static_cast<uint32_t>(index << page_bits);
    Page& p = pages_[index];
    p = Page{};
    const Region* r = find(address);
    if (r == nullptr || r->size - (address - r->base) < page_size) continue;
    p.read = r->host + (address - r->base);
    p.write = r->writable ? p.read : nullptr;
    p.wait_states = r->wait_states;
  }
}

CodePage* Memory::code_page(uint32_t address) {
  Page& p = page(address);
  if (p.read == nullptr) return nullptr;
  if (p.code == nullptr) {
    p.code = new CodePage;
    if (p.write == nullptr) p.code->closed_lines = ~uint64_t{0};
    ++changes_;
    p.write = nullptr;
    for (Page* view : views_) {
      if (view != nullptr) view[address >> page_bits].write = nullptr;
    }
    code_pages_.push_back(address >> page_bits);
  }
  return p.code;
}

uint8_t* Memory::beside_code(uint32_t address, uint32_t size) const {
  const Page& page = pages_[address >> page_bits];
  const uint32_t offset = address & (page_size - 1), last = offset + size - 1;
  if (page.code == nullptr || last >= page_size) return nullptr;
  const uint64_t closed = page.code->code_lines | page.code->closed_lines;
  return ((closed >> (offset / 64) | closed >> (last / 64)) & 1) == 0 ? page.read + offset
                                                                      : nullptr;
}

/// Of the pages that can be stored to at all: whether stores to their lines in a range go directly.
void Memory::close(uint32_t address, uint32_t size, bool closed) {
  constexpr uint64_t all = ~uint64_t{0};
  while (size != 0) {
    const uint32_t offset = address & (page_size - 1), bytes = std::min(size, page_size - offset);
    const uint64_t lines = all << (offset / 64) & all >> (63 - (offset + bytes - 1) / 64);
    // A page that is not stored to directly: one with a record of its code.
    CodePage* code = closed ? code_page(address) : page(address).code;
    if (code != nullptr && code->closed_lines != all) {
      if (closed)
        code->closed_lines |= lines;
      else
        code->closed_lines &= ~lines;
    }
    address += bytes;
    size -= bytes;
  }
}

void Memory::guard(uint32_t address, uint32_t size) {
  if (address != guarded_ || size != guarded_size_) close(guarded_, guarded_size_, false);
  guarded_ = address;
  guarded_size_ = size;
  close(address, size, true);
}

void Memory::retire(uint32_t page_index) {
  Page& p = pages_[page_index];
  if (p.code == nullptr) return;
  retired_.emplace_back(p.code);
  ++changes_;
  p.code = nullptr;
  const Region* r = find(page_index << page_bits);
  p.write = r != nullptr && r->writable ? p.read : nullptr;
  for (Page* view : views_) {
    if (view != nullptr) view[page_index] = Page{};
  }
}

bool Memory::invalidate(uint32_t address, uint32_t size) {
  if (size == 0) return false;
  const Page& p = page(address);
  const bool in_one_page = (address & (page_size - 1)) + size <= page_size;
  if (in_one_page && p.code == nullptr) return false;
  if (in_one_page && size <= 4) {
    uint32_t first = (address & (page_size - 1)) / 64,
             last = ((address & (page_size - 1)) + size - 1) / 64;
    if (((p.code->code_lines >> first | p.code->code_lines >> last) & 1) == 0) return false;
  }
  bool found = false;
  uint64_t end = uint64_t{address} + size;
  std::vector<uint32_t> kept;
  for (uint32_t index : code_pages_) {
    uint64_t start = uint64_t{index} << page_bits;
    bool hit = false;
    if (start < end && start + page_size > address) {
      uint64_t from = std::max<uint64_t>(start, address), to = std::min(end, start + page_size);
      for (uint64_t line = (from - start) / 64; line <= (to - 1 - start) / 64; ++line) {
        hit = hit || ((pages_[index].code->code_lines >> line) & 1) != 0;
      }
    }
    if (hit) {
      retire(index);
      found = true;
    } else {
      kept.push_back(index);
    }
  }
  if (found) {
    code_pages_ = std::move(kept);
    close(guarded_, guarded_size_, true);  // an STM may continue there
  }
  return found;
}

void Memory::forget_entries() {
  for (uint32_t index : code_pages_) {
    CodePage& code = *pages_[index].code;
    code.entries.fill(nullptr);
    code.heat.fill(0);
  }
}

void Memory::invalidate_all() {
  for (uint32_t index : code_pages_) retire(index);
  code_pages_.clear();
}

}  // namespace capsoc::armv7m
