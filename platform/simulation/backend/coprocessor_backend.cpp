#include "backend/coprocessor_backend.h"

#include <utility>

#include "coprocessor/coprocessor.h"

namespace capsoc::run {

std::string rtl_library(const CoprocessorSettings& settings) {
  if (settings.backend() == Backend::model) return "";
  if (const std::string& chosen = settings.rtl_library(); !chosen.empty()) return chosen;
  return rtl::RtlLibrary::file_name(settings.options());
}

std::string lockstep_waves(const CoprocessorSettings& settings) {
  const std::string& chosen = settings.waves();
  return chosen.empty() ? "lockstep.fst" : chosen;
}

Result<CoprocessorBackend> make_backend(const CoprocessorSettings& settings) {
  const coprocessor::Options options = settings.options();
  const Backend kind = settings.backend();
  const std::string& waves = settings.waves();
  CoprocessorBackend backend;
  if (kind == Backend::model) {
    backend.device = std::make_unique<coprocessor::Coprocessor>(options);
    return backend;
  }
  auto library = rtl::RtlLibrary::open(rtl_library(settings), options);
  if (!library) return Error{library.error()};
  if (!waves.empty()) {
    auto file = trace::WaveFile::at(waves);
    if (!file) return Error{file.error()};
    if (kind == Backend::rtl) backend.waves.emplace(std::move(file.value()));
  }
  const auto clocking = settings.rtl_clock();
  auto verilated = std::make_unique<rtl::CoprocessorRtl>(library.value(), clocking);
  backend.rtl = verilated.get();
  if (kind == Backend::rtl) {
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
