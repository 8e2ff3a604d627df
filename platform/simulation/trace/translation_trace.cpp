#include "trace/translation_trace.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>
#include <utility>

namespace capsoc::trace {

Result<std::unique_ptr<TranslationTrace>> TranslationTrace::open(const std::string& listing,
                                                                 bool perf_map,
                                                                 Functions& functions) {
  std::unique_ptr<TranslationTrace> trace(new TranslationTrace(functions));
  if (!listing.empty()) {
    auto file = LineFile::open(listing, 0);
    if (!file) return Error{file.error()};
    trace->listing_ = std::move(file.value());
  }
  if (!perf_map) return trace;
  if (auto error = trace->open_map()) return *error;
  return trace;
}

/// In a world-writable folder: never follows a link, never overwrites another user's file.
std::optional<Error> TranslationTrace::open_map() {
  map_path_ = fmt::format("/tmp/perf-{}.map", getpid());
  unlink(map_path_.c_str());  // of an earlier process of this number
  const int file = ::open(map_path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
                          S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH);
  if (file < 0) return host::cannot_write(map_path_, errno);
  map_ = fdopen(file, "w");
  if (map_ != nullptr) return std::nullopt;
  const int error = errno;
  close(file);
  return host::cannot_write(map_path_, error);
}

TranslationTrace::~TranslationTrace() {
  if (map_ != nullptr) std::fclose(map_);
}

void TranslationTrace::put(const armv7m::Translation& t) {
  const std::string place = functions_.place(t.address);
  if (map_ != nullptr)
    fmt::print(map_, "{:x} {:x} {:08x} {}\n", reinterpret_cast<uintptr_t>(t.code), t.bytes,
               t.address, place);
  if (listing_ == nullptr) return;
  if (t.evictions != evictions_) listing_->put("all code dropped: the buffer was full\n");
  evictions_ = t.evictions;
  // The place in the buffer, not in memory: the same run gives the same bytes.
  listing_->put(
      fmt::format("block {:08x} {}: {} bytes at {:#x}", t.address, place, t.bytes, t.offset));
  listing_->put(t.listing);
}

std::optional<Error> TranslationTrace::finish() {
  std::optional<Error> error;
  if (listing_ != nullptr) error = listing_->finish();
  if (map_ == nullptr) return error;
  const bool failed = std::ferror(map_) != 0;
  if ((std::fclose(std::exchange(map_, nullptr)) != 0 || failed) && !error)
    error = host::cannot_write(map_path_, errno);
  return error;
}

}  // namespace capsoc::trace
