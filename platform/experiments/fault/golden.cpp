#include "fault/golden.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <systemc>

#include "base/input_file.h"
#include "fault/sample_results.h"
#include "host/files.h"
#include "kit/seconds.h"
#include "session/simulation.h"

namespace capsoc::fault {
namespace {

constexpr double between_starts_s = 1;
const InputLimits own{"it is capsoc's own", 1u << 30, false};

std::string state_file(const std::string& folder, std::size_t number) {
  return fmt::format("{}/state-{}", folder, number);
}

std::string golden_file(const std::string& folder) {
  return folder + "/golden";
}

sc_core::sc_time at(double seconds) {
  return sc_core::sc_time(seconds, sc_core::SC_SEC);
}

class Recorder {
 public:
  Recorder(run::Simulation& simulation, const Span& span, const std::string& folder)
      : simulation_(simulation), span_(span), folder_(folder) {}

  Result<Golden> record() {
    golden_.from_s = span_.from_s;
    golden_.places = simulation_.fault_places();
    if (auto error = advance(span_.from_s)) return *error;
    const SampleResults results(simulation_,
                                [this](const SampleResult& r) { golden_.results.push_back(r); });
    const UnreadWatch watch(simulation_, golden_.places);
    if (auto error = look_and_begin()) return *error;
    if (auto error = simulation_.advance_to_end()) return *error;
    golden_.unread = watch.unread();
    golden_.ended_s = kit::to_seconds(sc_core::sc_time_stamp());
    golden_.code = simulation_.finish().code;
    return std::move(golden_);
  }

 private:
  std::optional<Error> advance(double seconds) {
    const auto goes_on = simulation_.advance_to(at(seconds));
    if (!goes_on) return Error{goes_on.error()};
    if (goes_on.value()) return std::nullopt;
    return Error{fmt::format(
        "the run without a fault ends at {:.6g} s, before {:.6g} s; give earlier fault.from_s, "
        "fault.to_s and fault.until_s, or longer settings of the program",
        kit::to_seconds(sc_core::sc_time_stamp()), span_.until_s)};
  }

  std::optional<Error> look_and_begin() {
    double next_start = span_.from_s;
    const auto looks = std::llround((span_.until_s - span_.from_s) / step_s);
    for (long long look = 0; look <= looks; ++look) {
      const double now = span_.from_s + static_cast<double>(look) * step_s;
      if (auto error = advance(now)) return error;
      golden_.hashes.push_back(simulation_.state_hash());
      if (now < next_start - step_s / 2 || now > span_.to_s) continue;
      if (auto error = begin()) return error;
      next_start += between_starts_s;
    }
    return std::nullopt;
  }

  std::optional<Error> begin() {
    auto state = simulation_.packed_state();
    if (!state) return Error{state.error()};
    const std::string file = state_file(folder_, golden_.starts.size());
    golden_.starts.push_back(
        {sc_core::sc_time_stamp().value(), simulation_.observation().sample_number()});
    return host::write_whole(file, state.value());
  }

  run::Simulation& simulation_;
  const Span& span_;
  const std::string& folder_;
  Golden golden_;
};

}  // namespace

void Start::visit(Archive& archive) {
  archive("time_ps", time_ps);
  archive("sample", sample);
}

void Golden::visit(Archive& archive) {
  archive("starts", starts);
  archive("results", results);
  archive("hashes", hashes);
  archive("from_s", from_s);
  archive("ended_s", ended_s);
  archive("code", code);
  archive("places", places);
  archive("unread", unread);
}

Result<Golden> record_golden(const run::RunSettings& settings, const Span& span,
                             const std::string& folder) {
  auto simulation = run::Simulation::construct(settings);
  if (!simulation) return Error{simulation.error()};
  return Recorder(*simulation.value(), span, folder).record();
}

Result<std::string> read_state(const std::string& folder, std::size_t number) {
  return read_input(state_file(folder, number), own);
}

std::optional<Error> write_golden(Golden& golden, const std::string& folder) {
  StateWriter writer;
  golden.visit(writer);
  return host::write_whole(golden_file(folder), writer.take());
}

Result<Golden> read_golden(const std::string& folder) {
  const auto bytes = read_input(golden_file(folder), own);
  if (!bytes) return Error{bytes.error()};
  Golden golden;
  StateReader reader(bytes.value());
  golden.visit(reader);
  if (!reader.ok() || !reader.at_end())
    return Error{fmt::format("{}: is damaged; begin the campaign again", golden_file(folder))};
  return golden;
}

bool has_golden(const std::string& folder) {
  std::error_code none;
  return std::filesystem::exists(golden_file(folder), none);
}

}  // namespace capsoc::fault
