#include "semihosting/semihosting.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "base/printable.h"

namespace capsoc::semihosting {
namespace {

enum Operation : uint32_t {
  sys_open = 0x01,
  sys_close = 0x02,
  sys_writec = 0x03,
  sys_write0 = 0x04,
  sys_write = 0x05,
  sys_read = 0x06,
  sys_readc = 0x07,
  sys_iserror = 0x08,
  sys_istty = 0x09,
  sys_seek = 0x0A,
  sys_flen = 0x0C,
  sys_tmpnam = 0x0D,
  sys_remove = 0x0E,
  sys_rename = 0x0F,
  sys_clock = 0x10,
  sys_time = 0x11,
  sys_errno = 0x13,
  sys_get_cmdline = 0x15,
  sys_heapinfo = 0x16,
  sys_exit = 0x18,
  sys_exit_extended = 0x20,
  sys_elapsed = 0x30,
  sys_tickfreq = 0x31
};

constexpr uint32_t application_exit = 0x20026;  // ADP_Stopped_ApplicationExit
constexpr uint32_t ticks_per_second = 1'000'000'000;
constexpr uint32_t longest_name = 1024, piece = 4096;
constexpr std::size_t most_files = 64, most_warnings = 8;
constexpr unsigned first_write_mode = 4, first_append_mode = 8, mode_count = 12;
// Magic and feature byte 0: SYS_EXIT_EXTENDED, and `:tt` for append is stderr.
constexpr std::string_view features = "SHFB\x03";

}  // namespace

Semihosting::Semihosting(GuestMemory& memory, GuestFiles files, Console& console,
                         Environment environment)
    : memory_(memory),
      files_(std::move(files)),
      console_(console),
      environment_(std::move(environment)) {}

Semihosting::Outcome Semihosting::call(uint32_t operation, uint32_t argument, uint32_t& result) {
  if (operation == sys_exit || operation == sys_exit_extended) {
    end(operation, argument);
    return Outcome::ended;
  }
  const int errno_before = errno_;
  const auto answer = static_cast<uint32_t>(dispatch(operation, argument));
  if (std::exchange(asks_again_, false)) {
    errno_ = errno_before;
    return Outcome::asks_again;
  }
  result = answer;
  return Outcome::answered;
}

int64_t Semihosting::dispatch(uint32_t operation, uint32_t argument) {
  const uint64_t now = environment_.now_ns();
  switch (operation) {
    case sys_open:
      return open(argument);
    case sys_close:
      return close(argument);
    case sys_writec:
    case sys_write0:
      if (operation == sys_write0) write_text(argument);
      if (char character = 0; operation == sys_writec && memory_.read(argument, &character, 1))
        console_.write({&character, 1});
      return operation;  // both leave r0 undefined
    case sys_write:
      return write(argument);
    case sys_read:
      return read(argument);
    case sys_readc:
      return read_character();
    case sys_iserror: {
      const auto block = words<1>(argument);
      return block && static_cast<int32_t>((*block)[0]) >= 0 ? 0 : 1;
    }
    case sys_istty:
      return is_terminal(argument);
    case sys_seek:
      return seek(argument);
    case sys_flen:
      return length(argument);
    case sys_tmpnam:
      return temporary_name(argument);
    case sys_remove:
      return remove(argument);
    case sys_rename:
      return rename(argument);
    case sys_clock:
      return static_cast<int64_t>(now / 10'000'000 & 0x7FFFFFFF);
    case sys_time:
      return static_cast<int64_t>(environment_.epoch_s + now / 1'000'000'000);
    case sys_errno:
      return errno_;
    case sys_get_cmdline:
      return command_line(argument);
    case sys_heapinfo:
      return heap_info(argument);
    case sys_elapsed:
      return elapsed(argument);
    case sys_tickfreq:
      return ticks_per_second;
    default:
      if (unknown_.size() < most_warnings && unknown_.insert(operation).second)
        spdlog::warn("semihosting: operation {:#x} is not supported; r0 becomes -1", operation);
      return fail(ENOSYS);
  }
}

int64_t Semihosting::fail(int error) {
  errno_ = error;
  return -1;
}

template <std::size_t count>
std::optional<std::array<uint32_t, count>> Semihosting::words(uint32_t address) {
  std::array<uint32_t, count> block{};
  if (memory_.read(address, block.data(), sizeof block)) return block;
  errno_ = EFAULT;
  return std::nullopt;
}

std::optional<std::string> Semihosting::name_at(uint32_t address, uint32_t size) {
  std::string name(std::min(size, longest_name), '\0');
  if (size > longest_name) {
    errno_ = ENAMETOOLONG;
  } else if (!memory_.read(address, name.data(), size)) {
    errno_ = EFAULT;
  } else if (name.find('\0') != std::string::npos) {
    errno_ = EINVAL;
  } else {
    return name;
  }
  return std::nullopt;
}

Semihosting::File* Semihosting::file(uint32_t handle) {
  const auto found = open_.find(handle);
  if (found != open_.end()) return &found->second;
  errno_ = EBADF;
  return nullptr;
}

int64_t Semihosting::open(uint32_t argument) {
  const auto block = words<3>(argument);
  if (!block) return -1;
  const auto [address, mode, size] = *block;
  const auto name = name_at(address, size);
  if (!name) return -1;
  if (mode >= mode_count) return fail(EINVAL);
  if (open_.size() >= most_files) return fail(EMFILE);
  File opened{File::Kind::host, host::Descriptor(), 0};
  if (*name == ":tt") {
    opened.kind = mode < first_write_mode ? File::Kind::console_in : File::Kind::console_out;
  } else if (*name == ":semihosting-features") {
    if (mode >= first_write_mode) return fail(EACCES);
    opened.kind = File::Kind::features;
  } else if (const int error = files_.open(*name, mode, opened.descriptor); error < 0) {
    return fail(-error);
  }
  opened.name = *name;
  opened.mode = mode;
  uint32_t handle = 1;
  while (open_.count(handle) != 0) ++handle;
  open_.emplace(handle, std::move(opened));
  return handle;
}

int64_t Semihosting::close(uint32_t argument) {
  const auto block = words<1>(argument);
  if (!block || file((*block)[0]) == nullptr) return -1;
  open_.erase((*block)[0]);
  return 0;
}

/// The result of a write is the number of bytes that were not written.
int64_t Semihosting::write(uint32_t argument) {
  const auto block = words<3>(argument);
  if (!block) return -1;
  const auto [handle, address, size] = *block;
  File* const to = file(handle);
  if (to == nullptr) return size;
  if (to->kind != File::Kind::console_out && to->kind != File::Kind::host) {
    errno_ = EBADF;
    return size;
  }
  std::array<char, piece> bytes{};
  for (uint32_t done = 0; done < size;) {
    const uint32_t count = std::min(piece, size - done);
    if (!memory_.read(address + done, bytes.data(), count)) {
      errno_ = EFAULT;
      return size - done;
    }
    if (to->kind == File::Kind::console_out) {
      console_.write({bytes.data(), count});
      done += count;
      continue;
    }
    const ssize_t written = files_.write(to->descriptor, bytes.data(), count);
    if (written < 0) errno_ = static_cast<int>(-written);
    if (written <= 0) return size - done;
    done += static_cast<uint32_t>(written);
  }
  return 0;
}

std::string Semihosting::read_console(std::size_t most) {
  std::optional<std::string> bytes = console_.read(most);
  asks_again_ = !bytes;
  return std::move(bytes).value_or("");
}

/// The next bytes of what can be read, none at its end.
std::string Semihosting::take(File& from, std::size_t most, int& error) {
  error = 0;
  switch (from.kind) {
    case File::Kind::console_in:
      return read_console(most);
    case File::Kind::features: {
      const auto rest = features.substr(std::min<std::size_t>(from.position, features.size()));
      from.position += static_cast<uint32_t>(std::min(most, rest.size()));
      return std::string(rest.substr(0, most));
    }
    case File::Kind::console_out:
      error = EBADF;
      return {};
    case File::Kind::host:
      break;
  }
  std::string bytes(most, '\0');
  const ssize_t got = ::read(from.descriptor.get(), bytes.data(), bytes.size());
  if (got < 0) error = errno;
  bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return bytes;
}

/// The result of a read is the number of bytes that were not read, after an error, too; SYS_ERRNO
/// tells an error from the end of the file.
int64_t Semihosting::read(uint32_t argument) {
  const auto block = words<3>(argument);
  if (!block) return -1;
  const auto [handle, address, size] = *block;
  File* const from = file(handle);
  if (from == nullptr) return size;
  for (uint32_t done = 0; done < size;) {
    int error = 0;
    const std::string bytes = take(*from, std::min(piece, size - done), error);
    const auto count = static_cast<uint32_t>(bytes.size());
    if (error == 0 && !memory_.write(address + done, bytes.data(), count)) error = EFAULT;
    if (error != 0) errno_ = error;
    if (error != 0 || bytes.empty()) return size - done;
    done += count;
    if (from->kind == File::Kind::console_in) return size - done;  // a line, not a bufferful
  }
  return 0;
}

int64_t Semihosting::read_character() {
  const std::string character = read_console(1);
  return character.empty() ? fail(EIO) : static_cast<uint8_t>(character[0]);
}

int64_t Semihosting::seek(uint32_t argument) {
  const auto block = words<2>(argument);
  if (!block) return -1;
  const auto [handle, position] = *block;
  File* const of = file(handle);
  if (of == nullptr) return -1;
  if (of->kind == File::Kind::features) {
    of->position = position;
    return 0;
  }
  if (of->kind != File::Kind::host) return fail(ESPIPE);
  return lseek(of->descriptor.get(), position, SEEK_SET) < 0 ? fail(errno) : 0;
}

int64_t Semihosting::length(uint32_t argument) {
  const auto block = words<1>(argument);
  File* const of = block ? file((*block)[0]) : nullptr;
  if (of == nullptr) return -1;
  if (of->kind == File::Kind::features) return static_cast<int64_t>(features.size());
  if (of->kind != File::Kind::host) return 0;
  struct stat status {};
  if (fstat(of->descriptor.get(), &status) != 0) return fail(errno);
  return status.st_size > INT32_MAX ? fail(EFBIG) : status.st_size;
}

int64_t Semihosting::is_terminal(uint32_t argument) {
  const auto block = words<1>(argument);
  const File* const of = block ? file((*block)[0]) : nullptr;
  if (of == nullptr) return -1;
  return of->kind == File::Kind::console_in || of->kind == File::Kind::console_out ? 1 : 0;
}

int64_t Semihosting::remove(uint32_t argument) {
  const auto block = words<2>(argument);
  if (!block) return -1;
  const auto name = name_at((*block)[0], (*block)[1]);
  if (!name) return -1;
  const int error = files_.remove(*name);
  return error < 0 ? fail(-error) : 0;
}

int64_t Semihosting::rename(uint32_t argument) {
  const auto block = words<4>(argument);
  if (!block) return -1;
  const auto from = name_at((*block)[0], (*block)[1]);
  if (!from) return -1;
  const auto to = name_at((*block)[2], (*block)[3]);
  if (!to) return -1;
  const int error = files_.rename(*from, *to);
  return error < 0 ? fail(-error) : 0;
}

int64_t Semihosting::temporary_name(uint32_t argument) {
  const auto block = words<3>(argument);
  if (!block) return -1;
  const auto [address, identifier, size] = *block;
  if (identifier > 255) return fail(EINVAL);
  const std::string name = fmt::format("capsoc-{:03}.tmp", identifier);
  if (size <= name.size()) return fail(ENAMETOOLONG);
  return memory_.write(address, name.c_str(), static_cast<uint32_t>(name.size() + 1))
             ? 0
             : fail(EFAULT);
}

int64_t Semihosting::command_line(uint32_t argument) {
  const auto block = words<2>(argument);
  if (!block) return -1;
  const auto [address, size] = *block;
  const std::string& text = environment_.command_line;
  const auto length = static_cast<uint32_t>(text.size());
  if (size <= length) return fail(ENAMETOOLONG);
  if (!memory_.write(address, text.c_str(), length + 1)) return fail(EFAULT);
  return memory_.write(argument + 4, &length, sizeof length) ? 0 : fail(EFAULT);
}

int64_t Semihosting::heap_info(uint32_t argument) {
  const auto block = words<1>(argument);
  if (!block) return -1;
  const HeapInfo& heap = environment_.heap;
  const std::array<uint32_t, 4> answer = {heap.heap_base, heap.heap_limit, heap.stack_base,
                                          heap.stack_limit};
  return memory_.write((*block)[0], answer.data(), sizeof answer) ? 0 : fail(EFAULT);
}

int64_t Semihosting::elapsed(uint32_t argument) {
  const uint64_t ticks = environment_.now_ns();
  const std::array<uint32_t, 2> answer = {static_cast<uint32_t>(ticks),
                                          static_cast<uint32_t>(ticks >> 32U)};
  return memory_.write(argument, answer.data(), sizeof answer) ? 0 : fail(EFAULT);
}

/// Up to the zero, or to the end of memory. Each piece ends at an aligned address, so that it is in
/// one memory or in none.
void Semihosting::write_text(uint32_t address) {
  std::array<char, 64> bytes{};
  for (;;) {
    const auto size = static_cast<uint32_t>(bytes.size()) - address % bytes.size();
    if (!memory_.read(address, bytes.data(), size)) return;
    const std::string_view text(bytes.data(), size);
    const std::size_t end = std::min<std::size_t>(text.find('\0'), size);
    console_.write(text.substr(0, end));
    if (end != size) return;
    address += size;
  }
}

/// In 32-bit states the argument of SYS_EXIT is the reason itself and carries no status.
void Semihosting::end(uint32_t operation, uint32_t argument) {
  uint32_t reason = argument, status = 0;
  if (operation == sys_exit_extended) {
    const auto block = words<2>(argument);
    if (!block)
      spdlog::warn("semihosting: SYS_EXIT_EXTENDED points to {:#010x}, where nothing can be read",
                   argument);
    reason = block ? (*block)[0] : 0;
    status = block ? (*block)[1] : 0;
  }
  exit_status_ = reason == application_exit ? static_cast<int>(status) : 1;
  console_.flush();
}

void Semihosting::File::visit(Archive& archive, const GuestFiles& files) {
  archive.at_most("kind", kind, Kind::host);
  archive("position", position);
  archive("name", name);
  archive("mode", mode);
  uint64_t offset = 0;
  if (kind == Kind::host && !archive.loading()) {
    struct stat status {};
    if (fstat(descriptor.get(), &status) == 0) size = static_cast<uint64_t>(status.st_size);
    offset = static_cast<uint64_t>(lseek(descriptor.get(), 0, SEEK_CUR));
  }
  archive("size", size);
  archive("offset", offset);
  if (kind != Kind::host || !archive.loading() || !archive.ok()) return;
  if (const int error = files.reopen(name, mode, size, offset, descriptor); error < 0)
    archive.refuse(fmt::format(
        "'{}' cannot be opened as it was ({}); --semihosting-dir must have it", printable(name, 80),
        error == -ESTALE ? "it is shorter than it was" : std::strerror(-error)));
}

void Semihosting::restored() {
  for (const auto& entry : open_)
    if (entry.second.kind == File::Kind::host)
      GuestFiles::cut(entry.second.descriptor, entry.second.size);
}

void Semihosting::visit(Archive& archive) {
  console_.flush();
  archive("files", files_);
  archive("console", console_);
  std::vector<uint32_t> handles, unknown(unknown_.begin(), unknown_.end());
  for (const auto& entry : open_) handles.push_back(entry.first);
  archive.sequence("handles", handles, most_files);
  archive.sequence("unknown", unknown, 256);
  if (archive.loading()) {
    open_.clear();
    unknown_ = std::set<uint32_t>(unknown.begin(), unknown.end());
  }
  for (const uint32_t handle : handles) open_[handle].visit(archive, files_);
  archive("errno", errno_);
  archive("exit_status", exit_status_);
}

}  // namespace capsoc::semihosting
