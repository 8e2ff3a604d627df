#include "inject/coprocessor_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
#include <type_traits>

#include "coprocessor/register_map.h"

namespace capsoc::inject {
namespace {

static_assert(std::is_standard_layout_v<capsoc_rtl_state> &&
              sizeof(capsoc_rtl_state) % sizeof(uint64_t) == 0);

struct Declared {
  const char *name, *instance, *variable;
  unsigned bits, count;  ///< count 0: it is no memory
};
constexpr Declared declared[] = {
#define WORD(name, bits, instance, variable) {#name, #instance, #variable, bits, 0},
#define WORDS(name, count, bits, instance, variable) {#name, #instance, #variable, bits, count},
#include "rtl/rtl_state.def"
#undef WORD
#undef WORDS
};

/// Where the RTL keeps something: the slot of a result, the bank of a window, what is valid.
constexpr std::array<std::string_view, 8> administration = {
    "result_slot", "result_any", "angle_any",  "bank_valid",
    "fresh",       "bank",       "any_window", "error_empty"};

/// The words of the bank's memory that nothing else holds: staged and latched LO words, SOFT_U.
bool is_bank_word(unsigned index) {
  constexpr std::array<uint32_t, coprocessor::pair_count> pairs = {
      coprocessor::word_freq_lo, coprocessor::word_phase_lo, coprocessor::word_au_lo,
      coprocessor::word_bu_lo,   coprocessor::word_cu_lo,    coprocessor::word_av_lo,
      coprocessor::word_bv_lo,   coprocessor::word_cv_lo};
  return index == coprocessor::word_soft_u ||
         std::any_of(pairs.begin(), pairs.end(),
                     [&](uint32_t pair) { return index == pair || index == pair + 1; });
}

/// The model's state in the form of the RTL has the last result in slot 0, the window under way in
/// bank 0 and the one before it in bank 1 (rtl/rtl_state.h).
bool is_shared(std::string_view name, unsigned index) {
  constexpr unsigned average = 8, window_det = 22, last_det = 23, window = 24, last = 28;
  if (name == "bank_words") return is_bank_word(index);
  if (name == "sample_words" || name == "error_words") return index < 4;
  if (name == "quality_words")
    return index == 0 || index == average || index == last_det || index >= last;
  if (name == "judge_words") return index == window_det || (index >= window && index < last);
  return std::find(administration.begin(), administration.end(), name) == administration.end();
}

std::string with_dots(std::string instance) {
  const std::string mark = "__DOT__";
  for (std::size_t at; (at = instance.find(mark)) != std::string::npos;)
    instance.replace(at, mark.size(), ".");
  return instance;
}

void add(std::vector<CoprocessorWord>& words, const Declared& one, const std::string& index,
         bool shared) {
  const std::string instance = with_dots(one.instance);
  words.push_back(
      {one.name + index, instance + "." + one.variable + index, one.bits, words.size(), shared});
}

std::vector<CoprocessorWord> all_words() {
  std::vector<CoprocessorWord> words;
  for (const Declared& one : declared) {
    if (one.count == 0) add(words, one, "", is_shared(one.name, 0));
    for (unsigned i = 0; i < one.count; ++i)
      add(words, one, fmt::format(".{}", i), is_shared(one.name, i));
  }
  return words;
}

}  // namespace

const std::vector<CoprocessorWord>& coprocessor_words() {
  static const std::vector<CoprocessorWord> words = all_words();
  return words;
}

uint64_t& value_of(capsoc_rtl_state& state, const CoprocessorWord& word) {
  return reinterpret_cast<uint64_t*>(&state)[word.index];
}

}  // namespace capsoc::inject
