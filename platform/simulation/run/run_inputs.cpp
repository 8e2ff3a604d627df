#include "run/run_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "golden/trace.h"
#include "host/places.h"
#include "host/sha256.h"
#include "loader/place.h"
#include "loader/program_file.h"
#include "loader/vector_table.h"
#include "metrics/parameter_file.h"
#include "metrics/sensor_match.h"
#include "run/chosen_program.h"
#include "run/program_values.h"
#include "run/run_settings.h"
#include "sensor/description_keys.h"
#include "sensor/load.h"
#include "support/number.h"
#include "support/printable.h"

namespace capsoc::run {
namespace {

std::optional<metrics::Parameters> truth_of(const sensor::Description& d) {
  if (!d.a1 || !d.a2 || !d.b1 || !d.b2 || !d.beta || !d.phi) return std::nullopt;
  return metrics::Parameters{*d.a1, *d.a2, *d.b1, *d.b2, *d.beta, *d.phi};
}

/// Standard input has one reader.
std::optional<Error> taken_standard_input(const RunSettings& settings) {
  if (settings.sensor.file() != golden::standard_input) return std::nullopt;
  std::vector<const TextField*> readers = {&settings.semihosting.console};
  for (const UartSettings::Line& line : settings.uarts.lines) readers.push_back(&line.backend);
  for (const TextField* reader : readers)
    if (reader->text() == "stdio")
      return Error{
          fmt::format("--sensor -: {} reads standard input already (stdio); give the "
                      "sensor as a file, or the text to another backend",
                      reader->about().path)};
  return std::nullopt;
}

}  // namespace

std::vector<std::string> places_to_load(const RunSettings& settings) {
  std::vector<std::string> places;
  std::istringstream list(settings.firmware.load());
  for (std::string place; std::getline(list, place, ',');)
    if (!place.empty()) places.push_back(place);
  return places;
}

Result<RunInputs> read_inputs(const RunSettings& settings) {
  RunInputs inputs;
  auto program = read_program(settings);
  if (!program) return Error{program.error()};
  inputs.program = std::move(program.value());
  inputs.program_file = inputs.program.path;

  inputs.parameter_file = settings.firmware.parameters();
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
  auto program_settings = change_program(settings, inputs.program);
  if (!program_settings) return Error{program_settings.error()};
  inputs.program_settings = std::move(program_settings.value());

  inputs.sensor_file = settings.sensor.file();
  if (auto error = taken_standard_input(settings)) return *error;
  const auto recording = settings.sensor.recording();
  if (!recording) return Error{recording.error()};
  auto trace = golden::open_trace(inputs.sensor_file, settings.sensor.keys(), recording.value());
  if (!trace) return Error{trace.error()};
  inputs.sensor_warnings = golden::warnings_of(trace.value());
  inputs.source = std::move(trace.value().source);
  inputs.sensor_sha256 = trace.value().sha256;
  inputs.recorded_speed = metrics::recorded_speed(*inputs.source);
  inputs.alignment = metrics::recorded_alignment(*inputs.source);
  const long long adc_bits = settings.sensor.adc_bits() != 0
                                 ? settings.sensor.adc_bits()
                                 : inputs.source->description().adc_bits.value_or(32);
  if (adc_bits < 12)
    return Error{fmt::format("sensor.adc_bits = {} is out of range; give 12 to 32", adc_bits)};
  inputs.adc_bits = static_cast<unsigned>(adc_bits);

  for (const std::string& place : places_to_load(settings)) {
    auto further = loader::load_at(place);
    if (!further) return Error{further.error()};
    inputs.further_images.push_back(std::move(further.value()));
  }
  return inputs;
}

std::optional<Error> RunInputs::load(const RunSettings& settings, soc::Soc& soc) const {
  std::vector<const loader::ElfImage*> images = {&program};
  for (const loader::ElfImage& image : further_images) images.push_back(&image);
  for (const loader::ElfImage* image : images)
    if (auto error = loader::place(*image, soc)) return error;
  const auto table = loader::find_vector_table(images, settings.firmware.vector_table());
  if (!table) return Error{table.error()};
  soc.cpu.core().set_vector_table(table.value());
  return std::nullopt;
}

metrics::Metrics RunInputs::make_metrics() const {
  const sensor::Description& description = source->description();
  double frequency = std::fabs(description.frequency_hz.value_or(0));
  if (recorded_speed)
    frequency = std::fabs(*recorded_speed) * description.sample_rate_hz.value_or(0);
  metrics::Metrics metrics(truth_of(description), frequency > 0 ? 1 / frequency : 20, alignment);
  if (preset) metrics.preset(*preset);
  return metrics;
}

std::vector<Input> RunInputs::files(const RunSettings& settings) const {
  std::vector<Input> files = {{"firmware", program_file, host::sha256_of_file(program_file)},
                              {"sensor", sensor_file, sensor_sha256}};
  for (const std::string& place : places_to_load(settings))
    files.push_back({"image", place, host::sha256_of_file(place.substr(0, place.rfind('@')))});
  for (unsigned n = 0; n < soc::Soc::uart_count; ++n)
    if (const std::string& input = settings.uarts.lines[n].input(); !input.empty())
      files.push_back({fmt::format("uart{}", n), input, host::sha256_of_file(input)});
  if (preset) files.push_back({"parameters", parameter_file, host::sha256_of_file(parameter_file)});
  return files;
}

}  // namespace capsoc::run
