// What a run reads before it begins: programs, the sensor, parameters.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "base/setting_fields.h"
#include "inputs/input_file.h"
#include "inputs/input_settings.h"
#include "loader/elf_image.h"
#include "loader/program_settings.h"
#include "metrics/metrics.h"
#include "sensor/load.h"
#include "soc/soc.h"

namespace capsoc::run {

struct RunInputs {
  std::string program_file, sensor_file, parameter_file;  ///< the last "" without
  loader::ElfImage program;                               ///< with parameters and settings in it
  loader::ProgramSettings program_settings;               ///< as they are in it
  std::vector<loader::ElfImage> further_images;           ///< later ones overwrite
  std::unique_ptr<sensor::Source> source;
  std::string sensor_sha256;
  /// Of channels 1, 2 and so on.
  struct FurtherSensor {
    std::unique_ptr<sensor::Source> source;
    std::string file, sha256;
  };
  std::vector<FurtherSensor> further_sensors;
  std::vector<std::string> sensor_warnings;  ///< on a recording, with its file
  unsigned adc_bits = 0;
  std::optional<double> recorded_speed;              ///< of the sensor, turns a sample
  std::optional<metrics::TruthAlignment> alignment;  ///< of a recording with angles
  std::optional<metrics::ParameterWords> preset;

  /// The programs into the SoC's memories and the start of the processor. An Error: they do not
  /// fit, or none has a vector table.
  std::optional<Error> load(const FirmwareSettings& settings, soc::Soc& soc) const;

  /// The programs in the order in which they are loaded. They stay with it.
  std::vector<const loader::ElfImage*> images() const;

  /// Nothing found yet, the truth and the length of a revolution (20 s where the sensor does not
  /// say).
  metrics::Metrics make_metrics() const;
  /// The same of each sensor, in the order of channels.
  std::vector<metrics::Metrics> metrics_of_each() const;

  /// Every file that counts, with its hash. `received`: what ports read in addition, a role and a
  /// file each.
  std::vector<Input> files(const FirmwareSettings& settings,
                           const std::vector<std::pair<std::string, std::string>>& received) const;
};

/// The program: of the settings, or the one that has a place for parameters from outside.
std::string program_of(const FirmwareSettings& settings);

/// FILE or FILE@ADDRESS of each further image, in order; later ones overwrite.
std::vector<std::string> places_to_load(const FirmwareSettings& settings);

/// The program of a run as its file has it.
Result<loader::ElfImage> read_program(const FirmwareSettings& settings);

/// `console_readers`: settings of backends, of which one may read standard input (stdio), too. An
/// Error is a file that is missing or wrong, or a setting that does not fit it.
Result<RunInputs> read_inputs(const FirmwareSettings& firmware, const SensorSettings& sensor,
                              const std::vector<const TextField*>& console_readers);

}  // namespace capsoc::run
