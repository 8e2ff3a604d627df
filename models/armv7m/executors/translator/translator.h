#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "armv7m/executors/executor.h"

namespace capsoc::armv7m {

class Blocks;
class Machine;

/// What a translator may use of its host.
struct TranslatorLimits {
  static constexpr std::size_t least_buffer = 72u << 10;

  std::size_t buffer_bytes = 32u << 20;  ///< for host code; no less than least_buffer
  /// See Translator::set_threshold(). Translating a block of six instructions took 2.5 to 3.6 us
  /// and saved 2.3 to 2.8 ns an instruction. That pays after 180 to 250 executions (960 blocks in
  /// random order, AMD EPYC). Long programs run equally fast with 10 and with 254.
  uint8_t threshold = 200;
  /// Instructions before the first search for hot blocks. They take 0.3 ms, as much as the first
  /// translations, so a program that ends earlier does not pay for translations.
  uint64_t warm_up = 100'000;
  bool bit_manipulation = true;  ///< BMI1 and BMI2, where the host has them
};

/// What a translator has done so far.
struct TranslationCounts {
  uint64_t blocks = 0;        ///< translated
  uint64_t bytes = 0;         ///< of host code written
  uint64_t evictions = 0;     ///< times that all code was dropped because the buffer was full
  uint64_t instructions = 0;  ///< executed in translated code
  uint64_t stepped = 0;       ///< executed one by one, where there can be no block
  uint64_t executed = 0;      ///< executed in all, the rest of them in decoded blocks
};

/// The executor for long programs: decoded blocks that are executed often become code of the host
/// (x86-64). Everything else is executed as Blocks does it, in the middle of a block if need be, so
/// that the semantics of what is rare exist once.
class Translator : public InstructionExecutor {
 public:
  /// Null where the host is another one or lacks BMI1 or BMI2; `reason` says which.
  /// Machine and blocks, which execute the rest, are not owned.
  static std::unique_ptr<Translator> make(Machine& machine, Blocks& blocks,
                                          const TranslatorLimits& limits, std::string& reason);
  virtual TranslationCounts counts() const = 0;
  /// Why there are blocks alone after all, which turns out once something is hot: the host refuses
  /// executable memory (Listeners::untranslated). Empty: nothing is in the way.
  virtual const std::string& refusal() const = 0;
  /// How often a block is executed before it is translated, 1 to 254.
  virtual void set_threshold(uint8_t executions) = 0;
};

}  // namespace capsoc::armv7m
