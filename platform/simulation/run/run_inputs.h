// What a run reads before it begins: programs, the sensor, parameters.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "loader/elf_image.h"
#include "loader/program_settings.h"
#include "metrics/metrics.h"
#include "run/input_settings.h"
#include "run/results.h"
#include "sensor/load.h"
#include "soc/soc.h"
#include "support/result.h"
#include "support/setting_fields.h"

namespace capsoc::run {

class RunSettings;

struct RunInputs {
  std::string program_file, sensor_file, parameter_file;  ///< the last "" without
  loader::ElfImage program;                               ///< with parameters and settings in it
  loader::ProgramSettings program_settings;               ///< as they are in it
  std::vector<loader::ElfImage> further_images;           ///< later ones overwrite
  std::unique_ptr<sensor::Source> source;
  std::string sensor_sha256;
  std::vector<std::string> sensor_warnings;  ///< on a recording, with its file
  unsigned adc_bits = 0;
  std::optional<double> recorded_speed;              ///< of the sensor, turns a sample
  std::optional<metrics::TruthAlignment> alignment;  ///< of a recording with angles
  std::optional<metrics::ParameterWords> preset;

  /// The programs into the SoC's memories and the start of the processor. An Error: they do not
  /// fit, or none has a vector table.
  std::optional<Error> load(const RunSettings& settings, soc::Soc& soc) const;

  /// Nothing found yet, the truth and the length of a revolution (20 s where the sensor does not
  /// say).
  metrics::Metrics make_metrics() const;

  /// Every file that counts, with its hash.
  std::vector<Input> files(const RunSettings& settings) const;
};

/// FILE or FILE@ADDRESS of each further image, in order; later ones overwrite.
std::vector<std::string> places_to_load(const RunSettings& settings);

/// An Error is a file that is missing or wrong, or a setting that does not fit it.
Result<RunInputs> read_inputs(const RunSettings& settings);

}  // namespace capsoc::run
