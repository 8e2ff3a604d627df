#include "run/trace_settings.h"

namespace capsoc::run {
namespace {

trace::TraceOptions trace_options(const Settings& settings) {
  trace::TraceOptions options;
  options.instructions = settings.text("trace.instructions");
  options.bus = settings.text("trace.bus");
  options.profile = settings.text("trace.profile");
  options.waves = settings.text("trace.waves");
  if (options.waves.empty() && settings.text("coprocessor.backend") == "tlm")
    options.waves = settings.text("results.waves");
  options.start = settings.text("trace.start");
  options.stop = settings.text("trace.stop");
  options.depth = static_cast<std::size_t>(settings.integer("trace.depth"));
  options.fetches = settings.text("trace.fetches") == "true";
  return options;
}

}  // namespace

void add_trace_settings(Settings& settings) {
  const auto place = [&settings](const char* path, const char* help) {
    settings.add({path, SettingKind::output, "", help, {}});
  };
  place("trace.instructions", "where the instruction trace goes; empty: nowhere");
  place("trace.bus", "where the bus trace goes; empty: nowhere");
  place("trace.profile", "where the function profile goes (callgrind, or .folded); empty: nowhere");
  place("trace.waves", "where the waves of the SoC go (FST); empty: nowhere");
  settings.add({"trace.start",
                SettingKind::text,
                "",
                "traces begin at a function, an address (0x...) or a time in s",
                {}});
  settings.add({"trace.stop",
                SettingKind::text,
                "",
                "traces end at a function, an address (0x...) or a time in s",
                {}});
  settings.add({"trace.depth",
                SettingKind::integer,
                "0",
                "lines of instruction and bus trace that are kept, the last ones; 0: all",
                {},
                0,
                1e7});
  settings.add({"trace.fetches", SettingKind::flag, "false", "fetches in the bus trace, too", {}});
}

Result<std::unique_ptr<trace::Tracer>> attach_tracer(
    const Settings& settings, soc::Soc& soc, const loader::ElfImage& program,
    const std::vector<loader::ElfImage>& further_images) {
  const trace::TraceOptions options = trace_options(settings);
  if (settings.text("coprocessor.backend") == "tlm" && !settings.text("trace.waves").empty() &&
      !settings.text("results.waves").empty())
    return Error{
        "--waves and --trace-waves are the same waves with --coprocessor tlm; give one of them"};
  if (!options.any()) return std::unique_ptr<trace::Tracer>();
  std::vector<const loader::ElfImage*> images = {&program};
  for (const loader::ElfImage& further : further_images) images.push_back(&further);
  return trace::Tracer::attach(soc, options, images);
}

}  // namespace capsoc::run
