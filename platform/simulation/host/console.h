// Standard output and standard error of the program.
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string_view>

#include "base/result.h"

namespace capsoc::host {

/// The first call of the program: a standard stream that it was started without becomes one that
/// fails, so that no file opened later gets its number and what was meant for it.
void reserve_standard_streams();

/// To standard error. Nothing stops a program that is not listened to: a stream that is closed or
/// full, or whose reader has gone, takes nothing and that is all.
void say(std::string_view text);
template <typename... Values>
void say(fmt::format_string<Values...> format, Values&&... values) {
  say(std::string_view(fmt::format(format, std::forward<Values>(values)...)));
}

/// To standard output; finish_output() tells whether all of it has arrived.
void print(std::string_view text);
template <typename... Values>
void print(fmt::format_string<Values...> format, Values&&... values) {
  print(std::string_view(fmt::format(format, std::forward<Values>(values)...)));
}

/// At the end of the program: whether standard output, std::cout included, took everything.
std::optional<Error> finish_output();

}  // namespace capsoc::host
