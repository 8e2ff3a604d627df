// The coprocessor's state by name, for the model and its RTL alike (rtl/rtl_state.def).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "rtl/rtl_abi.h"

namespace capsoc::inject {

/// A register of the RTL, or a word of one of its memories.
struct CoprocessorWord {
  std::string name;       ///< "a1", "block_sums.3"
  std::string flip_flop;  ///< below the coprocessor: "u_register_bank.u_state.u_a1.value_q"
  unsigned bits = 0;
  std::size_t index = 0;  ///< of its value in a capsoc_rtl_state
  /// The model has it, too, and both do the same with it while the pipeline is empty. Others say
  /// where the RTL keeps something, or are copies.
  bool is_shared = false;
};

/// In the order of capsoc_rtl_state.
const std::vector<CoprocessorWord>& coprocessor_words();

uint64_t& value_of(capsoc_rtl_state& state, const CoprocessorWord& word);

}  // namespace capsoc::inject
