#include "run/coprocessor_backend.h"

#include <utility>

#include "coprocessor/coprocessor.h"
#include "host/files.h"

namespace capsoc::run {

void add_backend_settings(Settings& settings) {
  settings.add({"coprocessor.backend",
                SettingKind::choice,
                "tlm",
                "tlm (model), rtl (Verilated) or lockstep (both, compared)",
                {"tlm", "rtl", "lockstep"}});
  settings.add({"coprocessor.rtl_library",
                SettingKind::path,
                "",
                "Verilated coprocessor; empty: the build's own",
                {}});
  settings.add({"coprocessor.rtl_clock",
                SettingKind::choice,
                "skip",
                "skip idle clocks or make every one; same results",
                {"skip", "every"}});
  settings.add({"results.waves",
                SettingKind::path,
                "",
                "FST file: of the SoC, of the RTL, or of both sides around a difference",
                {}});
}

std::string lockstep_waves(const Settings& settings) {
  const std::string& chosen = settings.text("results.waves");
  return chosen.empty() ? "lockstep.fst" : chosen;
}

Result<CoprocessorBackend> make_backend(const Settings& settings,
                                        const coprocessor::Options& options) {
  const std::string& kind = settings.text("coprocessor.backend");
  const std::string& waves = settings.text("results.waves");
  CoprocessorBackend backend;
  if (kind == "tlm") {
    backend.device = std::make_unique<coprocessor::Coprocessor>(options);
    return backend;
  }
  std::string file = settings.text("coprocessor.rtl_library");
  if (file.empty()) file = rtl::RtlLibrary::file_name(options.arithmetic);
  auto library = rtl::RtlLibrary::open(file, options);
  if (!library) return Error{library.error()};
  if (!waves.empty())
    if (auto error = host::check_writable(waves)) return *error;
  const auto clocking = settings.text("coprocessor.rtl_clock") == "every" ? rtl::Clocking::every
                                                                          : rtl::Clocking::skip;
  auto verilated = std::make_unique<rtl::CoprocessorRtl>(library.value(), clocking);
  backend.rtl = verilated.get();
  if (kind == "rtl") {
    if (!waves.empty())
      if (auto error = verilated->open_waves(waves)) return *error;
    backend.device = std::move(verilated);
    return backend;
  }
  auto lockstep = std::make_unique<rtl::Lockstep>(
      std::make_unique<coprocessor::Coprocessor>(options), std::move(verilated));
  backend.lockstep = lockstep.get();
  backend.device = std::move(lockstep);
  return backend;
}

}  // namespace capsoc::run
