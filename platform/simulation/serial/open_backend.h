// Backends by their names on the command line.
#pragma once

#include <memory>
#include <string>

#include "base/result.h"
#include "serial/character_backend.h"
#include "serial/kept_stream.h"

namespace capsoc::serial {

/// For messages and help: what open_backend() takes.
constexpr const char* backend_names =
    "stdout, stderr, stdio, null, file:PATH, pty[:LINK] or tcp[:PORT]";

/// What a setting of a UART takes in addition: a script (serial/uart_script.h).
constexpr const char* uart_backend_names =
    "stdout, stderr, stdio, null, file:PATH, pty[:LINK], tcp[:PORT] or script:FILE";

/// `spec` as backend_names says; `option` begins the sentence of an error ("--uart0"), `names` ends
/// it.
Result<std::unique_ptr<CharacterBackend>> open_backend(const std::string& spec,
                                                       const std::string& option,
                                                       const GiveUp& give_up,
                                                       const char* names = backend_names);

/// As open_backend(), but a standard stream is `kept` instead, unless that is null.
Result<std::unique_ptr<CharacterBackend>> open_or_keep(const std::string& spec,
                                                       const std::string& option, KeptStream* kept,
                                                       const GiveUp& give_up);

/// Two lines cannot have both: their bytes would mix.
bool are_the_same_place(const std::string& one, const std::string& other);

}  // namespace capsoc::serial
