#include "rtl/rtl_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "base/input_file.h"
#include "coprocessor/nodes.h"
#include "host/places.h"

namespace capsoc::rtl {
namespace {

constexpr uint64_t largest_library = 1U << 30U;
constexpr const char* rebuild = "build it with `cmake --build BUILD --target capsoc_rtl`";

// For parameters that the paper's arithmetic does not have by itself.
constexpr const char* rebuild_with =
    "`cmake --build BUILD --target capsoc_rtl_table_8` builds the one of 16 bits, lead 2, shift 7 "
    "and a plain arctangent, `--target capsoc_rtl_two_clocks` the one of two clocks an iteration; "
    "for others add a line to platform/simulation/rtl/CMakeLists.txt";

/// Why its nodes and state are not those that this program knows; "" if they are.
std::string refuse_inside(const std::string& file, const capsoc_rtl_inside& inside) {
  const auto& names = coprocessor::node_names();
  const bool same_nodes = std::equal(
      names.begin(), names.end(), inside.node_names, inside.node_names + inside.node_count,
      [](const auto& ours, const char* theirs) { return std::strcmp(ours.name, theirs) == 0; });
  if (same_nodes && std::strcmp(inside.state_layout, capsoc_rtl_state_layout) == 0) return {};
  return fmt::format(
      "{}: its {} are not those of this program; build both of one tree: `cmake --build BUILD "
      "--target capsoc capsoc_rtl`",
      file, same_nodes ? "registers" : "nodes");
}

std::string refuse(const std::string& file, const capsoc_rtl_api& api,
                   const coprocessor::Options& options, RtlLibrary::Use use) {
  if (api.abi_version != CAPSOC_RTL_ABI_VERSION || api.pins_size != sizeof(capsoc_rtl_pins))
    return fmt::format("{}: its interface has version {} and this program wants {}; {}", file,
                       api.abi_version, CAPSOC_RTL_ABI_VERSION, rebuild);
  const bool paper = options.arithmetic == coprocessor::Arithmetic::paper;
  const auto name = [](bool is_paper) { return is_paper ? "paper" : "precise"; };
  if ((api.paper != 0) != paper)
    return fmt::format("{}: its arithmetic is {} and the run's is {}; give the other library", file,
                       name(api.paper != 0), name(paper));
  if (api.channels != options.channels)
    return fmt::format("{}: it has channels for {} sensors and the run's coprocessor for {}; {}",
                       file, api.channels, options.channels, rebuild_with);
  if (paper && (api.operand_bits != options.paper_operand_bits ||
                api.reference_lead != options.paper_reference_lead ||
                api.step_shift != options.paper_step_shift ||
                (api.plain_arctangent != 0) != options.paper_plain_arctangent ||
                api.iteration_clocks != options.paper_iteration_clocks))
    return fmt::format(
        "{}: its parameters (operand bits {}, reference lead {}, step shift {}, plain arctangent "
        "{}, iteration clocks {}) are not the model's ({}, {}, {}, {}, {}); build a library with "
        "these",
        file, api.operand_bits, api.reference_lead, api.step_shift, api.plain_arctangent,
        api.iteration_clocks, options.paper_operand_bits, options.paper_reference_lead,
        options.paper_step_shift, options.paper_plain_arctangent ? 1 : 0,
        options.paper_iteration_clocks);
  if (api.inside != nullptr) return refuse_inside(file, *api.inside);
  if (use == RtlLibrary::Use::at_its_pins) return {};
  return fmt::format(
      "{}: shows its pins and nothing of its inside, which a run needs; `capsoc regress "
      "--rtl-library {}` compares it at its pins",
      file, file);
}

}  // namespace

Result<RtlLibrary::Handle> RtlLibrary::open(const std::string& file,
                                            const coprocessor::Options& options, Use use) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    // Names that the build gives: of an arithmetic, or of parameters that have no library yet.
    const bool of_arithmetic = file == file_name(options.arithmetic);
    const bool of_ours =
        std::filesystem::path(file).filename().string().rfind("libcapsoc_rtl", 0) == 0;
    return Error{fmt::format("{}: there is no such RTL library; {}", file,
                             of_arithmetic ? rebuild
                             : of_ours     ? rebuild_with
                                           : "name the file that your build made")};
  }
  if (auto error = check_input(file, {rebuild, largest_library})) return *error;
  // dlopen takes a name without a slash for one of the system's.
  const std::string path = std::filesystem::absolute(file, ignored).string();
  void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* reason = dlerror();
    return Error{fmt::format("{}: is no shared library that can be loaded ({}); {}", file,
                             reason != nullptr ? reason : "no reason is known", rebuild)};
  }
  void* symbol = dlsym(handle, CAPSOC_RTL_ENTRY);
  if (symbol == nullptr) {
    dlclose(handle);
    return Error{fmt::format("{}: holds no coprocessor RTL; {}", file, rebuild)};
  }
  const auto entry = reinterpret_cast<capsoc_rtl_entry_function>(symbol);
  const Handle library(new RtlLibrary(handle, entry()));
  if (std::string reason = refuse(file, library->api(), options, use); !reason.empty())
    return Error{std::move(reason)};
  return library;
}

std::string RtlLibrary::file_name(const coprocessor::Options& options) {
  using coprocessor::Options;
  if (options.channels > 1)
    return host::library_path(
        fmt::format("libcapsoc_rtl_{}_{}_channels.so",
                    options.arithmetic == coprocessor::Arithmetic::paper ? "paper" : "precise",
                    options.channels));
  if (options.arithmetic != coprocessor::Arithmetic::paper ||
      (options.paper_operand_bits == Options().paper_operand_bits &&
       options.paper_reference_lead == 0 && options.paper_step_shift == 0 &&
       !options.paper_plain_arctangent && options.paper_iteration_clocks == 1))
    return file_name(options.arithmetic);
  const std::string clocks =
      options.paper_iteration_clocks == 1 ? "" : fmt::format("_{}", options.paper_iteration_clocks);
  return host::library_path(fmt::format("libcapsoc_rtl_paper_{}_{}_{}_{}{}.so",
                                        options.paper_operand_bits, options.paper_reference_lead,
                                        options.paper_step_shift,
                                        options.paper_plain_arctangent ? 1 : 0, clocks));
}

std::string RtlLibrary::file_name(coprocessor::Arithmetic arithmetic, bool coverage) {
  return host::library_path(fmt::format(
      "libcapsoc_rtl_{}{}.so", arithmetic == coprocessor::Arithmetic::paper ? "paper" : "precise",
      coverage ? "_coverage" : ""));
}

RtlLibrary::~RtlLibrary() {
  dlclose(handle_);
}

}  // namespace capsoc::rtl
