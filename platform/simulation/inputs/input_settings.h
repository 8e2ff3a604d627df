// The settings of what a run reads: programs, sensor, parameters.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "base/setting_fields.h"
#include "sensor/load.h"

namespace capsoc::run {

/// What all paths of the program's own settings begin with.
constexpr const char* program_prefix = "program.";

/// A program by its file, or one that comes with capsoc by its name alone ("selfcal"): the value is
/// the file. A file of that name in the current folder comes first.
class ProgramField final : public SettingField {
 public:
  ProgramField(Settings& owner, Setting declared) : SettingField(owner, std::move(declared)) {}
  const std::string& operator()() const { return text(); }
  std::optional<std::string> parse(const std::string&, bool) override { return std::nullopt; }
  std::string meaning(const std::string& text) const override;
};

/// The programs; program.NAME (-P) are settings of the first one itself.
struct FirmwareSettings {
  explicit FirmwareSettings(Settings& settings);
  Settings& all;
  ProgramField elf;
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
  TextField further{all, of_recording("further",
                                      "sensors of channels 1, 2 and so on: files with commas "
                                      "between; the converter takes all in turn")};
  /// What they say of a recording. Error: a value that is no number.
  Result<sensor::RecordingOptions> recording() const;

 private:
  static Setting of_recording(const std::string& name, const char* help) {
    Setting declared = setting("sensor." + name, SettingKind::text, "", help);
    declared.optional = true;
    return declared;
  }
};

}  // namespace capsoc::run
