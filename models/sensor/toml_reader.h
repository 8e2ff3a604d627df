#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "sensor/description_keys.h"
#include "sensor/signal_config.h"

namespace capsoc::sensor {

/// Reads the description of a signal (the format is in traces/README.md). `file` is only used in
/// error sentences. Every key and its range is checked; nothing is taken over silently. `keys` are
/// laid over the text; what is wrong with one of them begins with its origin.
Result<SignalConfig> read_signal_toml(std::string_view text, const std::string& file,
                                      const std::vector<KeyValue>& keys = {});

}  // namespace capsoc::sensor
