// What stands at the coprocessor's bus target in a run: the model, the RTL or both in lockstep.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "backend/coprocessor_settings.h"
#include "base/result.h"
#include "base/setting_fields.h"
#include "coprocessor/device.h"
#include "coprocessor/types.h"
#include "rtl/coprocessor_rtl.h"
#include "rtl/lockstep.h"
#include "trace/wave_file.h"

namespace capsoc::run {

/// The device and ways to look at it. The pointers live as long as the device.
struct CoprocessorBackend {
  std::unique_ptr<coprocessor::Device> device;
  rtl::CoprocessorRtl* rtl = nullptr;
  rtl::Lockstep* lockstep = nullptr;
  std::optional<trace::WaveFile> waves;  ///< of the RTL's inside, if they are asked for
};

/// The coprocessor that the settings ask for. An Error: the library is missing, stale or has other
/// parameters than the settings, or the wave file cannot be written.
Result<CoprocessorBackend> make_backend(const CoprocessorSettings& settings);

/// The library of the Verilated coprocessor, "" if the model is all that there is.
std::string rtl_library(const CoprocessorSettings& settings);

/// Where the waves of a difference go.
std::string lockstep_waves(const CoprocessorSettings& settings);

}  // namespace capsoc::run
