#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "base/archive.h"

namespace capsoc::kit {

/// Messages of one source that reach the log; the others are counted.
constexpr uint64_t guest_error_limit = 10;

/// Reports what the program in the machine did wrong (a hole in the map, a write to a read-only
/// register, reserved bits). It is the guest's error, so it never ends the simulation: a warning in
/// the log, at most guest_error_limit of one source.
void guest_error(std::string_view source, std::string_view text);

/// As guest_error(), but only the first message of the source reaches the log. For what a program
/// repeats as long as it runs.
void guest_error_once(std::string_view source, std::string_view text);

/// Says at level info what is worth knowing of a program and no error. Not counted.
void guest_note(std::string_view source, std::string_view text);

/// Reports of `source` so far, logged or not.
uint64_t guest_error_count(std::string_view source);

/// Reports of all sources so far.
uint64_t guest_error_total();

/// Logs, for every source of which messages were left out, how many. For the end of
/// a run.
void summarise_guest_errors();

/// Forgets all counts (a new run in the same process).
void clear_guest_errors();

/// The counts, so that a run that continues tells what it would have told.
void visit_guest_errors(Archive& archive);

/// `context` says where the guest is, such as "pc 0x00000124"; its text follows every message.
/// Empty: none.
void set_guest_error_context(std::function<std::string()> context);

/// Calls back with source and text of every guest error from now on, logged or not. An empty
/// function removes the listener. It must not report a guest error itself.
void set_guest_error_listener(std::function<void(std::string_view, std::string_view)> listener);

}  // namespace capsoc::kit
