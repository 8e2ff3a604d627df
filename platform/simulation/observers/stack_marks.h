// How deep the program's stacks have been, and whether one went too deep.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/setting_fields.h"
#include "explain/program_view.h"
#include "observers/run_observer.h"
#include "observers/stack_settings.h"
#include "soc/soc.h"

namespace capsoc::run {

/// A stack that was seen: the main one, or one that PSP pointed into.
struct StackMark {
  bool process = false;
  uint32_t top = 0, lowest = 0;  ///< greatest and least stack pointer
  uint32_t instruction = 0;      ///< that made it the least
  uint32_t suspended_at = 0;     ///< of a process stack: PSP when it was left

  void visit(Archive& archive);
};

/// Follows both stack pointers, instruction by instruction. A process stack is a new one when
/// Thread mode continues at a PSP at which none was left.
class StackMarks final : public RunObserver, private armv7m::Observer {
 public:
  StackMarks(const ProgramView& view, const StackSettings& settings)
      : view_(view), settings_(settings) {}
  ~StackMarks() override;

  /// Observes nothing unless the settings ask for it. An Error: a limit that is neither a symbol
  /// nor an address.
  std::optional<Error> open() override;
  const char* gathered() const override { return "stacks"; }
  void visit_gathered(Archive& archive) override;
  void finish(RunResult& result) override;
  std::string crash() const override;
  std::optional<Finding> finding() const override;

 private:
  struct Limit {
    uint32_t address;
    std::string name;
  };
  std::optional<Error> add_limit(const std::string& text);
  /// "MSP" or "PSP", and the object that the stack lies in, if there is one.
  std::string name_of(const StackMark& mark) const;

  void issued(const armv7m::Core&, const armv7m::DecodedOp&) override {}
  void retired(const armv7m::Core& core, const armv7m::DecodedOp& op) override;
  void entered(const armv7m::Core& core, unsigned exception, armv7m::Entry how,
               uint64_t since) override;
  void returned(const armv7m::Core& core, unsigned exception) override;
  void accessed(const armv7m::Core&, const armv7m::DirectAccess&) override {}
  void started(const armv7m::Core& core) override;

  StackMark& main_stack();
  StackMark& process_stack(uint32_t psp);
  void look(StackMark& stack, uint32_t stack_pointer, uint32_t instruction);

  const ProgramView& view_;
  const StackSettings& settings_;
  std::vector<Limit> limits_;
  std::vector<StackMark> stacks_;  ///< the first one is MSP's
  std::size_t process_ = 0;        ///< PSP's present one; 0: none
  std::string overflow_;           ///< of the first stack that went below a limit, a sentence
};

}  // namespace capsoc::run
