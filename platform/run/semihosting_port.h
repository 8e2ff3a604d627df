// Semihosting of a run: the guest's calls answered with the run's settings, memory and time.
#pragma once

#include <memory>
#include <string>

#include "loader/elf_image.h"
#include "semihosting/semihosting.h"
#include "soc/soc.h"
#include "support/settings.h"

namespace capsoc::run {

/// semihosting.directory, .console, .arguments, .epoch_s and .status.
void add_semihosting_settings(Settings& settings);

/// Answers the BKPT 0xAB of one processor. Time is the processor's own, to the cycle, whatever the
/// quantum is.
class SemihostingPort : private semihosting::GuestMemory {
 public:
  /// An Error is a wrong setting.
  static Result<std::unique_ptr<SemihostingPort>> open(const Settings& settings, soc::Soc& soc,
                                                       const loader::ElfImage& image,
                                                       const std::string& program,
                                                       const serial::GiveUp& give_up);

  int exit_status() const { return semihosting_.exit_status(); }
  /// What the guest wrote is with the host.
  void flush() { console_.flush(); }
  void visit(kit::Archive& archive) { semihosting_.visit(archive); }
  void restored() { semihosting_.restored(); }
  /// At the end of the run: why text of the console was lost, or "". Standard error may lose it: it
  /// is the console's place when nobody asked for one.
  std::string finish();

 private:
  SemihostingPort(soc::Soc& soc, std::unique_ptr<serial::CharacterBackend> console,
                  semihosting::GuestFiles files, semihosting::Environment environment,
                  const serial::GiveUp& give_up);
  bool read(uint32_t address, void* data, uint32_t size) override;
  bool write(uint32_t address, const void* data, uint32_t size) override;

  soc::Soc& soc_;
  bool on_standard_error_ = false;
  semihosting::Console console_;
  semihosting::Semihosting semihosting_;
};

}  // namespace capsoc::run
