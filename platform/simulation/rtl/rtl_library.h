// A shared library with the Verilated coprocessor, opened and checked.
#pragma once

#include <memory>
#include <string>

#include "base/result.h"
#include "coprocessor/types.h"
#include "rtl/rtl_abi.h"

namespace capsoc::rtl {

/// Keeps the library loaded for as long as a reference to it exists.
class RtlLibrary {
 public:
  using Handle = std::shared_ptr<const RtlLibrary>;

  /// What one is wanted for: a design of which only the pins are known can be compared at these
  /// alone; in the place of the model it has to show its inside.
  enum class Use { in_place_of_the_model, at_its_pins };

  /// Opens `file` and checks that it is one of ours (ABI), that its parameters are those of
  /// `options`, and that it shows what `use` needs: state and nodes as this program knows them.
  /// Which RTL is in it is its own matter (api().source_hash names it). The Error says what to do.
  static Result<Handle> open(const std::string& file, const coprocessor::Options& options,
                             Use use = Use::in_place_of_the_model);

  /// Where the library of such a coprocessor is: next to the program, or in its install tree.
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

}  // namespace capsoc::rtl
