#pragma once

#include <string>

namespace capsoc::view {

/// The page, which is the same for every run: one HTML text with its style and its script.
std::string page();
/// The policy of its response: nothing but these two and the server's own answers.
std::string page_policy();

}  // namespace capsoc::view
