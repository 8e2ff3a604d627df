#include "rtl/rtl_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstring>
#include <filesystem>

#include "host/places.h"
#include "rtl_hash.h"
#include "support/input_file.h"

namespace capsoc::rtl {
namespace {

constexpr uint64_t largest_library = 1U << 30U;
constexpr const char* rebuild = "build it with `cmake --build BUILD --target capsoc_rtl`";

// For parameters that the paper's arithmetic does not have by itself.
constexpr const char* rebuild_with =
    "`cmake --build BUILD --target capsoc_rtl_table_8` builds the one of 16 bits, lead 2, shift 7 "
    "and a plain arctangent; for others add a line to platform/simulation/rtl/CMakeLists.txt";

std::string refuse(const std::string& file, const capsoc_rtl_api& api,
                   const coprocessor::Options& options) {
  if (api.abi_version != CAPSOC_RTL_ABI_VERSION || api.pins_size != sizeof(capsoc_rtl_pins) ||
      api.state_size != sizeof(capsoc_rtl_state))
    return fmt::format("{}: its interface has version {} and this program wants {}; {}", file,
                       api.abi_version, CAPSOC_RTL_ABI_VERSION, rebuild);
  if (std::strcmp(api.source_hash, source_hash()) != 0)
    return fmt::format("{}: was built from other RTL ({:.12}) than this program ({:.12}); {}", file,
                       api.source_hash, source_hash(), rebuild);
  const bool paper = options.arithmetic == coprocessor::Arithmetic::paper;
  const auto name = [](bool is_paper) { return is_paper ? "paper" : "precise"; };
  if ((api.paper != 0) != paper)
    return fmt::format("{}: its arithmetic is {} and the run's is {}; give the other library", file,
                       name(api.paper != 0), name(paper));
  if (paper && (api.operand_bits != options.paper_operand_bits ||
                api.reference_lead != options.paper_reference_lead ||
                api.step_shift != options.paper_step_shift ||
                (api.plain_arctangent != 0) != options.paper_plain_arctangent))
    return fmt::format(
        "{}: its parameters (operand bits {}, reference lead {}, step shift {}, plain arctangent "
        "{}) are not the model's ({}, {}, {}, {}); build a library with these",
        file, api.operand_bits, api.reference_lead, api.step_shift, api.plain_arctangent,
        options.paper_operand_bits, options.paper_reference_lead, options.paper_step_shift,
        options.paper_plain_arctangent ? 1 : 0);
  return {};
}

}  // namespace

Result<RtlLibrary::Handle> RtlLibrary::open(const std::string& file,
                                            const coprocessor::Options& options) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored))
    return Error{fmt::format("{}: there is no such RTL library; {}", file,
                             file == file_name(options.arithmetic) ? rebuild : rebuild_with)};
  if (auto error = check_input(file, {rebuild, largest_library})) return *error;
  // dlopen takes a name without a slash for one of the system's.
  const std::string path = std::filesystem::absolute(file, ignored).string();
  void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr)
    return Error{fmt::format("{}: is no shared library that can be loaded; {}", file, rebuild)};
  void* symbol = dlsym(handle, CAPSOC_RTL_ENTRY);
  if (symbol == nullptr) {
    dlclose(handle);
    return Error{fmt::format("{}: holds no coprocessor RTL; {}", file, rebuild)};
  }
  const auto entry = reinterpret_cast<capsoc_rtl_entry_function>(symbol);
  const Handle library(new RtlLibrary(handle, entry()));
  if (std::string reason = refuse(file, library->api(), options); !reason.empty())
    return Error{std::move(reason)};
  return library;
}

std::string RtlLibrary::file_name(const coprocessor::Options& options) {
  using coprocessor::Options;
  if (options.arithmetic != coprocessor::Arithmetic::paper ||
      (options.paper_operand_bits == Options().paper_operand_bits &&
       options.paper_reference_lead == 0 && options.paper_step_shift == 0 &&
       !options.paper_plain_arctangent))
    return file_name(options.arithmetic);
  return host::library_path(fmt::format("libcapsoc_rtl_paper_{}_{}_{}_{}.so",
                                        options.paper_operand_bits, options.paper_reference_lead,
                                        options.paper_step_shift,
                                        options.paper_plain_arctangent ? 1 : 0));
}

std::string RtlLibrary::file_name(coprocessor::Arithmetic arithmetic, bool coverage) {
  return host::library_path(fmt::format(
      "libcapsoc_rtl_{}{}.so", arithmetic == coprocessor::Arithmetic::paper ? "paper" : "precise",
      coverage ? "_coverage" : ""));
}

RtlLibrary::~RtlLibrary() {
  dlclose(handle_);
}

const char* source_hash() {
  return CAPSOC_RTL_SOURCE_HASH;
}

}  // namespace capsoc::rtl
