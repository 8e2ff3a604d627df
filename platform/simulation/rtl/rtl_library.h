// A shared library with the Verilated coprocessor, opened and checked.
#pragma once

#include <memory>
#include <string>

#include "coprocessor/types.h"
#include "rtl/rtl_abi.h"
#include "support/result.h"

namespace capsoc::rtl {

/// Keeps the library loaded for as long as someone holds it.
class RtlLibrary {
 public:
  using Handle = std::shared_ptr<const RtlLibrary>;

  /// Opens `file` and checks that it is one of ours (ABI), that it holds the RTL that this program
  /// was built with (hash of rtl/), and that its parameters are those of `options`. The Error says
  /// what to do.
  static Result<Handle> open(const std::string& file, const coprocessor::Options& options);

  /// Where the library of such a coprocessor is: beside the program, or in its install tree.
  static std::string file_name(const coprocessor::Options& options);
  /// The same for an arithmetic with the parameters that it has by itself.
  static std::string file_name(coprocessor::Arithmetic arithmetic, bool coverage = false);

  ~RtlLibrary();
  RtlLibrary(const RtlLibrary&) = delete;
  RtlLibrary& operator=(const RtlLibrary&) = delete;

  const capsoc_rtl_api& api() const { return *api_; }

 private:
  RtlLibrary(void* handle, const capsoc_rtl_api* api) : handle_(handle), api_(api) {}

  void* handle_;
  const capsoc_rtl_api* api_;
};

/// Hash of the RTL sources that this program was built with.
const char* source_hash();

}  // namespace capsoc::rtl
