#include "observers/guest_errors.h"

#include "kit/guest_error.h"

namespace capsoc::run {

GuestErrors::~GuestErrors() {
  kit::set_guest_error_context({});
}

std::optional<Error> GuestErrors::open() {
  kit::set_guest_error_context([this] { return view_.here(); });
  return std::nullopt;
}

void GuestErrors::close(RunResult&) {
  kit::summarise_guest_errors();
  kit::set_guest_error_context({});
}

}  // namespace capsoc::run
