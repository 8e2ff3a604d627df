#include "inputs/run_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/nearest.h"
#include "base/number.h"
#include "base/printable.h"
#include "base/split.h"
#include "golden/trace.h"
#include "host/places.h"
#include "host/sha256.h"
#include "inputs/program_values.h"
#include "loader/place.h"
#include "loader/program_file.h"
#include "loader/vector_table.h"
#include "metrics/parameter_file.h"
#include "metrics/sensor_match.h"
#include "sensor/description_keys.h"
#include "sensor/load.h"

namespace capsoc::run {
namespace {

std::optional<metrics::Parameters> truth_of(const sensor::Description& d) {
  if (!d.a1 || !d.a2 || !d.b1 || !d.b2 || !d.beta || !d.phi) return std::nullopt;
  return metrics::Parameters{*d.a1, *d.a2, *d.b1, *d.b2, *d.beta, *d.phi};
}

metrics::Metrics metrics_of(const sensor::Description& description, std::optional<double> speed,
                            const std::optional<metrics::TruthAlignment>& alignment) {
  double frequency = std::fabs(description.frequency_hz.value_or(0));
  if (speed) frequency = std::fabs(*speed) * description.sample_rate_hz.value_or(0);
  return {truth_of(description), frequency > 0 ? 1 / frequency : 20, alignment};
}

/// The default program is missing: the binary was copied without its files.
std::optional<Error> missing_default(const FirmwareSettings& settings, const std::string& program) {
  std::error_code ignored;
  if (!settings.elf.is_built_in() || std::filesystem::exists(program, ignored)) return std::nullopt;
  return Error{
      fmt::format("{}: the default program is not there; name yours (capsoc run FILE.elf), or keep "
                  "the folder firmware/ next to capsoc",
                  program)};
}

/// Standard input has one reader.
std::optional<Error> taken_standard_input(const SensorSettings& settings,
                                          const std::vector<const TextField*>& readers) {
  if (settings.file() != golden::standard_input) return std::nullopt;
  for (const TextField* reader : readers)
    if (reader->text() == "stdio")
      return Error{
          fmt::format("--sensor -: {} reads standard input already (stdio); give the "
                      "sensor as a file, or the text to another backend",
                      reader->about().path)};
  return std::nullopt;
}

/// One converter takes all sensors: with one rate and one resolution.
std::optional<Error> other_converter(const RunInputs& inputs, bool any_bits,
                                     const std::string& file, const sensor::Description& further) {
  const sensor::Description& first = inputs.source->description();
  if (first.sample_rate_hz && further.sample_rate_hz &&
      *first.sample_rate_hz != *further.sample_rate_hz)
    return Error{
        fmt::format("{}: sampled at {} Hz, but {} at {} Hz, and one converter takes both; "
                    "give sensors of one rate",
                    file, *further.sample_rate_hz, inputs.sensor_file, *first.sample_rate_hz)};
  if (!any_bits && further.adc_bits && *further.adc_bits != static_cast<int>(inputs.adc_bits))
    return Error{
        fmt::format("{}: adc_bits = {}, but {} bits with {}, and one converter takes both; "
                    "say -C sensor.adc_bits=N for all",
                    file, *further.adc_bits, inputs.adc_bits, inputs.sensor_file)};
  return std::nullopt;
}

std::optional<Error> open_further_sensors(const SensorSettings& settings,
                                          const sensor::RecordingOptions& recording,
                                          RunInputs& inputs) {
  for (const std::string& file : split(settings.further(), ',')) {
    if (file.empty()) continue;
    auto further = golden::open_trace(file, {}, recording);
    if (!further) return Error{further.error()};
    golden::Trace& trace = further.value();
    const bool any_bits = settings.adc_bits() != 0;
    if (auto error = other_converter(inputs, any_bits, file, trace.source->description()))
      return error;
    for (std::string& warning : golden::warnings_of(trace))
      inputs.sensor_warnings.push_back(std::move(warning));
    inputs.further_sensors.push_back({std::move(trace.source), file, trace.sha256});
  }
  return std::nullopt;
}

/// The names nearest to a program that is not there: of the files in its folder; without a folder,
/// of the programs that come with capsoc and of those in the present one.
std::string names_near(const std::filesystem::path& program) {
  constexpr std::size_t enough = 1000;
  std::vector<std::string> known;
  if (program.has_parent_path()) {
    for (const auto& file : host::files_in(program.parent_path(), program.extension()))
      known.push_back(file.string());
  } else {
    for (const auto& file : host::files_in(host::data_path("firmware"), ".elf"))
      known.push_back(file.stem().string());
    for (const auto& file : host::files_in(".", ".elf")) known.push_back(file.filename().string());
  }
  known.resize(std::min(known.size(), enough));
  for (std::string& name : known) name = printable(name, 200);
  return nearest_names(program.string().substr(0, 200), std::move(known));
}

/// The program that the user named is not there.
std::optional<Error> missing(const FirmwareSettings& settings, const std::string& file) {
  std::error_code none;
  if (settings.elf.is_built_in() || (!file.empty() && std::filesystem::exists(file, none)))
    return std::nullopt;
  const char* const advice = "name an ELF file for the Cortex-M3";
  if (file.empty()) return Error{fmt::format("firmware.elf has no value; {}", advice)};
  const std::string near = names_near(file);
  if (near.empty()) return std::nullopt;  // the reader knows the reason
  return Error{
      fmt::format("{}: there is no such program; did you mean {}?", printable(file, 200), near)};
}

}  // namespace

std::string program_of(const FirmwareSettings& settings) {
  const bool chosen = !settings.elf.is_built_in();
  if (settings.parameters.empty() || chosen) return settings.elf();
  return host::data_path("firmware/calibrate.elf");
}

std::vector<std::string> places_to_load(const FirmwareSettings& settings) {
  std::vector<std::string> places = split(settings.load(), ',');
  places.erase(std::remove(places.begin(), places.end(), ""), places.end());
  return places;
}

Result<loader::ElfImage> read_program(const FirmwareSettings& settings) {
  const std::string file = program_of(settings);
  if (auto error = missing_default(settings, file)) return *error;
  if (auto error = missing(settings, file)) return *error;
  return loader::load_program(file);
}

Result<RunInputs> read_inputs(const FirmwareSettings& firmware, const SensorSettings& sensor,
                              const std::vector<const TextField*>& console_readers) {
  RunInputs inputs;
  auto program = read_program(firmware);
  if (!program) return Error{program.error()};
  inputs.program = std::move(program.value());
  inputs.program_file = inputs.program.path;

  inputs.parameter_file = firmware.parameters();
  if (!inputs.parameter_file.empty()) {
    const auto words = metrics::read_parameters(inputs.parameter_file);
    if (!words) return Error{words.error()};
    inputs.preset = words.value();
    if (auto error = metrics::write_in_program(inputs.program, *inputs.preset)) return *error;
    const auto table = metrics::read_error_table(inputs.parameter_file);
    if (!table) return Error{table.error()};
    if (table.value())
      if (auto error = metrics::write_in_program(inputs.program, *table.value())) return *error;
  }
  auto program_settings = change_program(firmware, inputs.program);
  if (!program_settings) return Error{program_settings.error()};
  inputs.program_settings = std::move(program_settings.value());

  inputs.sensor_file = sensor.file();
  if (auto error = taken_standard_input(sensor, console_readers)) return *error;
  const auto recording = sensor.recording();
  if (!recording) return Error{recording.error()};
  auto trace = golden::open_trace(inputs.sensor_file, sensor.keys(), recording.value());
  if (!trace) return Error{trace.error()};
  inputs.sensor_warnings = golden::warnings_of(trace.value());
  inputs.source = std::move(trace.value().source);
  inputs.sensor_sha256 = trace.value().sha256;
  inputs.recorded_speed = metrics::recorded_speed(*inputs.source);
  inputs.alignment = metrics::recorded_alignment(*inputs.source);
  const long long adc_bits = sensor.adc_bits() != 0
                                 ? sensor.adc_bits()
                                 : inputs.source->description().adc_bits.value_or(32);
  if (adc_bits < 12)
    return Error{fmt::format("sensor.adc_bits = {} is out of range; give 12 to 32", adc_bits)};
  inputs.adc_bits = static_cast<unsigned>(adc_bits);
  if (auto error = open_further_sensors(sensor, recording.value(), inputs)) return *error;

  for (const std::string& place : places_to_load(firmware)) {
    auto further = loader::load_at(place);
    if (!further) return Error{further.error()};
    inputs.further_images.push_back(std::move(further.value()));
  }
  return inputs;
}

std::optional<Error> RunInputs::load(const FirmwareSettings& settings, soc::Soc& soc) const {
  for (const loader::ElfImage* image : images())
    if (auto error = loader::place(*image, soc)) return error;
  const auto table = loader::find_vector_table(images(), settings.vector_table());
  if (!table) return Error{table.error()};
  soc.cpu.core().set_vector_table(table.value());
  return std::nullopt;
}

std::vector<const loader::ElfImage*> RunInputs::images() const {
  std::vector<const loader::ElfImage*> images = {&program};
  for (const loader::ElfImage& image : further_images) images.push_back(&image);
  return images;
}

metrics::Metrics RunInputs::make_metrics() const {
  metrics::Metrics metrics = metrics_of(source->description(), recorded_speed, alignment);
  if (preset) metrics.preset(*preset);
  return metrics;
}

std::vector<metrics::Metrics> RunInputs::metrics_of_each() const {
  std::vector<metrics::Metrics> each = {make_metrics()};
  for (const FurtherSensor& sensor : further_sensors)
    each.push_back(metrics_of(sensor.source->description(), metrics::recorded_speed(*sensor.source),
                              metrics::recorded_alignment(*sensor.source)));
  return each;
}

std::vector<Input> RunInputs::files(
    const FirmwareSettings& settings,
    const std::vector<std::pair<std::string, std::string>>& received) const {
  std::vector<Input> files = {{"firmware", program_file, host::sha256_of_file(program_file)},
                              {"sensor", sensor_file, sensor_sha256}};
  for (std::size_t i = 0; i < further_sensors.size(); ++i)
    files.push_back({fmt::format("sensor of channel {}", i + 1), further_sensors[i].file,
                     further_sensors[i].sha256});
  for (const std::string& place : places_to_load(settings))
    files.push_back({"image", place, host::sha256_of_file(place.substr(0, place.rfind('@')))});
  for (const auto& [role, file] : received)
    files.push_back({role, file, host::sha256_of_file(file)});
  if (preset) files.push_back({"parameters", parameter_file, host::sha256_of_file(parameter_file)});
  return files;
}

}  // namespace capsoc::run
