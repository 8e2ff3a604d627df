// `capsoc fit`, on samples of a generated sensor, as a kind of work.
#include <fmt/format.h>

#include "base/setting_fields.h"
#include "base/shell.h"
#include "campaign/kinds.h"
#include "campaign/work_settings.h"
#include "fit/fit.h"
#include "fit/report.h"
#include "inputs/run_inputs.h"
#include "results/results.h"
#include "sensor/load.h"

namespace capsoc::campaign {
namespace {

/// The sensor as `capsoc run` has it, and the options of `capsoc fit`.
class FitSettings : public Settings {
 public:
  run::SensorSettings sensor{*this};
  ChoiceField<identification::Method> method{
      *this,
      {{"ml", identification::Method::distances},
       {"adam", identification::Method::adam},
       {"lm", identification::Method::levenberg_marquardt},
       {"heydemann", identification::Method::heydemann},
       {"taubin", identification::Method::taubin},
       {"direct", identification::Method::direct}},
      setting("fit.method", SettingKind::choice, "ml", "how: ml, or as the papers name it")};
  IntegerField samples{*this, setting("fit.samples", SettingKind::integer, "0",
                                      "at most N; 0: all, of a trace without an end 100,000")
                                  .in(0, 1e9)};
  IntegerField harmonics{*this, setting("fit.harmonics", SettingKind::integer, "0",
                                        "highest harmonic to identify; 0 and 1: none")
                                    .in(0, 3)};

  fit::FitOptions options() const {
    fit::FitOptions options;
    options.record.adc_bits = static_cast<unsigned>(sensor.adc_bits());
    options.record.samples = static_cast<uint64_t>(samples());
    options.record.keys = sensor.keys();
    if (const auto recording = sensor.recording()) options.record.recording = recording.value();
    options.identify.method = method();
    options.identify.harmonics.highest = static_cast<int>(harmonics());
    return options;
  }

  /// `capsoc fit` with the same options.
  std::string command() const {
    std::string text = "capsoc fit " + shell_word(sensor.file());
    const auto option = [&text](const char* name, const SettingField& field) {
      if (!field.is_built_in()) text += fmt::format(" {} {}", name, shell_word(field.text()));
    };
    option("--method", method);
    if (harmonics() != 0) option("--harmonics", harmonics);
    if (samples() != 0) option("--samples", samples);
    if (sensor.adc_bits() != 0) option("--adc-bits", sensor.adc_bits);
    option("--columns", sensor.columns);
    option("--full-scale", sensor.full_scale);
    option("--zero", sensor.zero);
    option("--scale", sensor.scale);
    for (const sensor::KeyValue& key : sensor.keys())
      text += " -C " + shell_word(fmt::format("sensor.{}={}", key.name, key.value));
    return text;
  }
};

void add_exit(int code, const std::string& reason, nlohmann::ordered_json& result) {
  result["exit"] = {{"code", code}, {"reason", reason}};
}

class FitWork final : public Work {
 public:
  Result<Job> prepare(const std::vector<Assignment>& assignments) override {
    FitSettings settings;
    if (auto error = set_all(assignments, settings)) return *error;
    const auto recording = settings.sensor.recording();
    if (!recording) return Error{recording.error()};
    std::string identity = settings_identity(settings);
    for (const std::string& file : sensor::files_of(settings.sensor.file()))
      identity += input_identity(file);
    return Job{std::move(identity), settings.command()};
  }

  std::optional<Error> check(const std::vector<Assignment>& assignments, const Keep&) override {
    FitSettings settings;
    if (auto error = set_all(assignments, settings)) return error;
    const auto recording = settings.sensor.recording();
    if (!recording) return Error{recording.error()};
    const auto source =
        sensor::load(settings.sensor.file(), settings.sensor.keys(), recording.value());
    return source ? std::nullopt : std::make_optional(Error{source.error()});
  }

  Result<nlohmann::ordered_json> perform(const std::vector<Assignment>& assignments,
                                         const Keep&) override {
    FitSettings settings;
    if (auto error = set_all(assignments, settings)) return *error;
    const auto fitted = fit::fit(settings.sensor.file(), settings.options());
    if (!fitted) return Error{fitted.error()};
    nlohmann::ordered_json result;
    if (const std::string& rejection = fitted.value().rejection; !rejection.empty()) {
      add_exit(run::exit_code::rejected, rejection, result);
      return result;
    }
    result = fit::to_json(fitted.value(), run::versions(), settings.command());
    add_exit(run::exit_code::pass, "identified", result);
    return result;
  }

  nlohmann::ordered_json example() const override {
    constexpr uint64_t enough = 500;
    fit::FitOptions options;
    options.record.samples = enough;
    options.identify.harmonics.highest = 3;
    nlohmann::ordered_json example;
    if (const auto fitted = fit::fit(sensor::built_in_default, options))
      example = fit::to_json(fitted.value(), run::versions(), "");
    add_exit(run::exit_code::pass, "", example);
    return example;
  }

  const std::vector<std::string>& host_keys() const override {
    static const std::vector<std::string> none;
    return none;
  }
};

}  // namespace

std::unique_ptr<Work> make_fit_work() {
  return std::make_unique<FitWork>();
}

}  // namespace capsoc::campaign
