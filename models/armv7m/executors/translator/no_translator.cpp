#include "armv7m/executors/translator/translator.h"

namespace capsoc::armv7m {

std::unique_ptr<Translator> Translator::make(Machine&, Blocks&, const TranslatorLimits&,
                                             std::string& reason) {
  reason = "it was built without asmjit or for another host than x86-64";
  return nullptr;
}

}  // namespace capsoc::armv7m
