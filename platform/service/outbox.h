#pragma once

#include <cstddef>
#include <string>

namespace capsoc::service {

/// Bytes on their way to a descriptor that does not block.
class Outbox {
 public:
  /// As much as may wait before nothing more is asked for that would add to it.
  static constexpr std::size_t full = std::size_t{64} << 20;

  void add(std::string bytes);
  bool empty() const { return taken_ == bytes_.size(); }
  bool is_full() const { return bytes_.size() - taken_ >= full; }
  /// Writes what the descriptor takes now; false: it has no reader any more.
  bool write_to(int descriptor);

 private:
  std::string bytes_;
  std::size_t taken_ = 0;
};

}  // namespace capsoc::service
