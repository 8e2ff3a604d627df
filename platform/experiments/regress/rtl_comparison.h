// The C++ model against the Verilated RTL, or against any other device.
#pragma once

#include <memory>

#include "regress/campaign.h"
#include "rtl/rtl_library.h"

namespace capsoc::regress {

/// The model of `options` in lockstep with `other`.
std::unique_ptr<Comparison> compare_with(const coprocessor::Options& options,
                                         std::unique_ptr<coprocessor::Device> other);

/// The same with an instance of the library's coprocessor.
std::unique_ptr<Comparison> compare_with_rtl(const coprocessor::Options& options,
                                             const rtl::RtlLibrary::Handle& library);

/// What the reports say of it.
Subject subject_of(coprocessor::Arithmetic arithmetic, const rtl::RtlLibrary::Handle& library);

}  // namespace capsoc::regress
