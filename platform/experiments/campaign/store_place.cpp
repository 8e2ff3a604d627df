#include "campaign/store_place.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace capsoc::campaign {
namespace {

namespace fs = std::filesystem;

constexpr const char* companions[] = {"-wal", "-journal"};

/// By the magic numbers of statfs(2). FUSE is most often sshfs or another network's.
bool is_of_a_network(int file) {
  constexpr unsigned others[] = {0xFF534D42 /* CIFS */,   0x00C36400 /* Ceph */,
                                 0x0BD00BD0 /* Lustre */, 0x47504653 /* GPFS */,
                                 0x19830326 /* BeeGFS */, 0x65735546 /* FUSE */};
  struct statfs about {};
  if (fstatfs(file, &about) != 0) return false;
  const auto type = static_cast<unsigned>(about.f_type);
  for (const unsigned other : others)
    if (type == other) return true;
  return type == NFS_SUPER_MAGIC || type == SMB_SUPER_MAGIC || type == SMB2_SUPER_MAGIC ||
         type == V9FS_MAGIC || type == AFS_SUPER_MAGIC || type == CODA_SUPER_MAGIC;
}

}  // namespace

std::string why_no_locks(int file) {
  struct flock range {};
  range.l_type = F_RDLCK;
  range.l_whence = SEEK_SET;
  range.l_start = off_t{1} << 60;
  range.l_len = 1;
  return fcntl(file, F_GETLK, &range) == 0 ? "" : std::strerror(errno);
}

bool shares_memory(int file) {
  constexpr std::size_t size = 4096;
  if (is_of_a_network(file)) return false;
  void* const view = mmap(nullptr, size, PROT_READ, MAP_SHARED, file, 0);
  if (view == MAP_FAILED) return false;
  munmap(view, size);
  return true;
}

bool has_unfinished(const std::string& store) {
  for (const char* companion : companions) {
    std::error_code failure;
    const auto size = fs::file_size(store + companion, failure);
    if (!failure && size > 0) return true;
  }
  return false;
}

Result<std::unique_ptr<StoreCopy>> StoreCopy::of(const std::string& store) {
  auto folder = host::TemporaryFolder::make("store");
  if (!folder)
    return Error{fmt::format("{}: can only be read, and there is no place for a copy: {}", store,
                             folder.error())};
  std::unique_ptr<StoreCopy> copy(new StoreCopy(std::move(folder.value())));
  std::error_code failure;
  fs::copy_file(store, copy->path(), failure);
  for (const char* companion : companions)
    if (!failure && fs::exists(store + companion))
      fs::copy_file(store + companion, copy->path() + companion, failure);
  if (failure)
    return Error{fmt::format("{}: can only be read, and cannot be copied to {} ({})", store,
                             copy->folder_.path(), failure.message())};
  for (const fs::directory_entry& file : fs::directory_iterator(copy->folder_.path()))
    fs::permissions(file, fs::perms::owner_write, fs::perm_options::add, failure);
  return copy;
}

}  // namespace capsoc::campaign
