// What a run reads before it begins: programs, the sensor, parameters.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "loader/elf_image.h"
#include "loader/program_settings.h"
#include "metrics/metrics.h"
#include "run/results.h"
#include "sensor/load.h"
#include "soc/soc.h"
#include "support/result.h"
#include "support/setting_fields.h"

namespace capsoc::run {

class RunSettings;

/// The programs; program.NAME (-P) are settings of the first one itself.
struct FirmwareSettings {
  explicit FirmwareSettings(Settings& settings);
  Settings& all;
  TextField elf;
  TextField load{
      all, setting("firmware.load", SettingKind::text, "",
                   "further images, FILE@ADDRESS (raw), ELF or Intel HEX, separated by commas")
               .by({"--load", "FILE[@ADDR]",
                    "Further images: raw bytes at an address, ELF or Intel HEX; may be repeated",
                    SettingOption::Form::list})};
  TextField vector_table{
      all, setting("firmware.vector_table", SettingKind::text, "auto",
                   "address of the vector table; auto: 0, or where the program has it")
               .by({"--vector-table", "ADDR",
                    "Where the vector table is (auto: 0, or where the program has it)"})};
  TextField parameters{
      all, setting("firmware.parameters", SettingKind::input, "",
                   "JSON with parameters to write in the program; empty: none")
               .by({"--parameters", "FILE.json",
                    "Start in calibration mode with the parameters that capsoc fit or run --json "
                    "wrote"})};
};

/// The sensor; its description's keys are settings, too: sensor.NAME.
struct SensorSettings {
  explicit SensorSettings(Settings& settings);
  /// The keys of the description that were set, with what set them.
  std::vector<sensor::KeyValue> keys() const;

  Settings& all;
  TextField file;
  IntegerField adc_bits{all, setting("sensor.adc_bits", SettingKind::integer, "0",
                                     "width of the converter at reset; 0: as the sensor says")
                                 .in(0, 32)};
  // Of recordings. Not in results unless they are set: a description has none of them.
  TextField columns{
      all, of_recording("columns",
                        "columns of a recording: U,V or T,U,V,ANGLE by name or number; empty: by "
                        "name")
               .by({"--columns", "T,U,V,ANGLE",
                    "Columns of a recording by name or number from 1 (or U,V, or T,U,V)"})};
  TextField full_scale{
      all,
      of_recording("full_scale", "value of a recording that is 1 of full scale; empty: 1")
          .by({"--full-scale", "X", "Value of a recording that is full scale (12 bits: 2048)"})};
  TextField zero{all,
                 of_recording("zero", "value of a recording that is 0 of full scale; empty: 0")
                     .by({"--zero", "X", "Value of a recording that is zero (12 bits: 2048)"})};
  TextField scale{
      all, of_recording("scale", "auto: find full scale and zero of a recording by its values")
               .by({"--scale", "auto", "Find full scale and zero of a recording by its values"})};
  /// What they say of a recording. Error: a value that is no number.
  Result<sensor::RecordingOptions> recording() const;

 private:
  static Setting of_recording(const std::string& name, const char* help) {
    Setting declared = setting("sensor." + name, SettingKind::text, "", help);
    declared.optional = true;
    return declared;
  }
};

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

/// The program: of the settings, or the one that has a place for parameters from outside.
std::string program_of(const RunSettings& settings);

/// FILE or FILE@ADDRESS of each further image, in order; later ones overwrite.
std::vector<std::string> places_to_load(const RunSettings& settings);

/// The program of a run as its file has it.
Result<loader::ElfImage> read_program(const RunSettings& settings);

/// An Error is a file that is missing or wrong, or a setting that does not fit it.
Result<RunInputs> read_inputs(const RunSettings& settings);

}  // namespace capsoc::run
