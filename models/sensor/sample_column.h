// One channel of a recording in memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace capsoc::sensor {

/// Numbers in blocks of half a megabyte: growing moves none of them, and take() frees each block as
/// soon as it is copied, so that a long record is never in memory twice.
class SampleColumn {
 public:
  void push_back(double value) {
    if (size_ % block == 0) blocks_.emplace_back(new double[block]);
    blocks_.back()[size_ % block] = value;
    ++size_;
  }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  double operator[](std::size_t k) const { return blocks_[k / block][k % block]; }

  /// Calls `function` with each value in order.
  template <typename Function>
  void for_each(Function function) const {
    for (std::size_t i = 0; i < blocks_.size(); ++i)
      for (std::size_t k = 0; k < in_block(i); ++k) function(blocks_[i][k]);
  }

  /// Replaces each value by what `function` returns for it.
  template <typename Function>
  void transform(Function function) {
    for (std::size_t i = 0; i < blocks_.size(); ++i)
      std::transform(&blocks_[i][0], &blocks_[i][0] + in_block(i), &blocks_[i][0], function);
  }

  /// Copies the first `count` values to `out` and leaves the column empty.
  void take(double* out, std::size_t count) {
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      if (i * block < count)
        std::copy_n(&blocks_[i][0], std::min(count - i * block, in_block(i)), out + i * block);
      blocks_[i].reset();
      if (i % given_back == given_back - 1) give_back();
    }
    give_back();
    blocks_.clear();
    size_ = 0;
  }

 private:
  static constexpr std::size_t block = 1U << 16U;
  static constexpr std::size_t given_back = 32;  ///< blocks at a time

  /// What is free between the blocks of other columns stays with the process otherwise.
  static void give_back() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
  }

  std::size_t in_block(std::size_t i) const {
    return std::min(block, size_ - i * block);
  }

  std::vector<std::unique_ptr<double[]>> blocks_;
  std::size_t size_ = 0;
};

}  // namespace capsoc::sensor
