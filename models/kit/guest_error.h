#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "base/archive.h"

namespace capsoc::kit {

/// Messages of one source that reach the log; the others are counted.
constexpr uint64_t guest_error_limit = 10;

/// Reports an error of the guest program: a hole in the map, a write to a read-only register,
/// reserved bits. It never ends the simulation. The log gets a warning, at most guest_error_limit
/// from one source.
void guest_error(std::string_view source, std::string_view text);

/// As guest_error(), but only the first message of the source reaches the log. For errors that a
/// program repeats all the time.
void guest_error_once(std::string_view source, std::string_view text);

/// Logs a note on the program at level info. It is no error and is not counted.
void guest_note(std::string_view source, std::string_view text);

/// Reports of `source` so far, logged or not.
uint64_t guest_error_count(std::string_view source);

/// Reports of all sources so far.
uint64_t guest_error_total();

/// Logs the number of suppressed messages of each source that has any. Call at the end of a run.
void summarise_guest_errors();

/// Forgets all counts (a new run in the same process).
void clear_guest_errors();

/// Saves or loads the counts, so that a continued run logs the same messages as an uninterrupted
/// one.
void visit_guest_errors(Archive& archive);

/// `context` returns where the guest is, such as "pc 0x00000124"; the text is appended to every
/// message. Empty: none.
void set_guest_error_context(std::function<std::string()> context);

/// Calls back with source and text of every guest error from now on, logged or not. An empty
/// function removes the listener. It must not report a guest error itself.
void set_guest_error_listener(std::function<void(std::string_view, std::string_view)> listener);

}  // namespace capsoc::kit
