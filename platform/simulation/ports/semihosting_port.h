// Semihosting of a run: the guest's calls answered with the run's settings, memory and time.
#pragma once

#include <memory>
#include <string>

#include "base/setting_fields.h"
#include "loader/elf_image.h"
#include "semihosting/semihosting.h"
#include "serial/kept_stream.h"
#include "serial/open_backend.h"
#include "soc/soc.h"

namespace capsoc::run {

/// What the status of a program's SYS_EXIT becomes.
enum class ExitStatus { verdict, process };

struct SemihostingSettings {
  Settings& all;
  TextField directory{
      all, setting("semihosting.directory", SettingKind::directory, "",
                   "where the program's files are; empty: it gets none")
               .is_host_side()
               .by({"--semihosting-dir", "DIR",
                    "Directory that the program's semihosting files are in; without it there are "
                    "none"})};
  TextField console{
      all, setting("semihosting.console", SettingKind::backend, "stderr", serial::backend_names)
               .is_place()
               .by({"--semihosting-console", "BACKEND", "Where :tt goes; as --uart0 (stderr)"})};
  TextField arguments{all, setting("semihosting.arguments", SettingKind::text, "",
                                   "the program's command line after its name")
                               .by({"--semihosting-args", "TEXT", "The program's command line"})};
  IntegerField epoch_s{all, setting("semihosting.epoch_s", SettingKind::integer, "1767225600",
                                    "the program's time at the start, s since 1970 (2026-01-01)")
                                .in(0, 4102444800.0)};
  ChoiceField<ExitStatus> status{
      all,
      {{"verdict", ExitStatus::verdict}, {"process", ExitStatus::process}},
      setting("semihosting.status", SettingKind::choice, "verdict",
              "verdict: any status but 0 is exit code 1; process: its low byte is the exit code")
          .is_host_side()};
};

/// Answers the BKPT 0xAB of one processor. Time is the processor's own, to the cycle, whatever the
/// quantum is.
class SemihostingPort : private semihosting::GuestMemory {
 public:
  /// An Error is a wrong setting. `kept`: the console's instead of a standard stream; null: that.
  static Result<std::unique_ptr<SemihostingPort>> open(const SemihostingSettings& settings,
                                                       soc::Soc& soc, const loader::ElfImage& image,
                                                       const std::string& program,
                                                       serial::KeptStream* kept,
                                                       const serial::GiveUp& give_up);

  int exit_status() const { return semihosting_.exit_status(); }
  /// What the guest wrote is with the host.
  void flush() { console_.flush(); }
  void visit(Archive& archive) { semihosting_.visit(archive); }
  void restored() { semihosting_.restored(); }
  /// At the end of the run: why text of the console was lost, or "". Standard error may lose it: it
  /// is the console's place when none was requested.
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
