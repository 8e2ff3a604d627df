#include "run/coprocessor_backend.h"

#include <utility>

#include "coprocessor/coprocessor.h"

namespace capsoc::run {

void add_backend_settings(Settings& settings) {
  settings.add({"coprocessor.backend",
                SettingKind::choice,
                "tlm",
                "tlm (model), rtl (Verilated) or lockstep (both, compared)",
                {"tlm", "rtl", "lockstep"}});
  settings.add({"coprocessor.rtl_library",
                SettingKind::input,
                "",
                "Verilated coprocessor; empty: the build's own",
                {}});
  settings.add({"coprocessor.rtl_clock",
                SettingKind::choice,
                "skip",
                "skip idle clocks or make every one; same results",
                {"skip", "every"}});
  settings.add({"results.waves",
                SettingKind::output,
                "",
                "FST file: of the SoC, of the RTL, or of both sides around a difference",
                {}});
}

std::string rtl_library(const Settings& settings) {
  if (settings.text("coprocessor.backend") == "tlm") return "";
  if (const std::string& chosen = settings.text("coprocessor.rtl_library"); !chosen.empty())
    return chosen;
  return rtl::RtlLibrary::file_name(settings.text("coprocessor.arithmetic") == "paper"
                                        ? coprocessor::Arithmetic::paper
                                        : coprocessor::Arithmetic::precise);
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
  auto library = rtl::RtlLibrary::open(rtl_library(settings), options);
  if (!library) return Error{library.error()};
  if (!waves.empty()) {
    auto file = trace::WaveFile::at(waves);
    if (!file) return Error{file.error()};
    if (kind == "rtl") backend.waves.emplace(std::move(file.value()));
  }
  const auto clocking = settings.text("coprocessor.rtl_clock") == "every" ? rtl::Clocking::every
                                                                          : rtl::Clocking::skip;
  auto verilated = std::make_unique<rtl::CoprocessorRtl>(library.value(), clocking);
  backend.rtl = verilated.get();
  if (kind == "rtl") {
    if (backend.waves)
      if (auto error = verilated->open_waves(backend.waves->growing())) return *error;
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
