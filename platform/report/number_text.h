// Numbers as a reader needs them: the digits that mean something.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

namespace capsoc::report {

/// Whether a table aligns it as a number: one, or "-" for none.
bool is_number(const std::string& text);

/// A number's text with five digits if its fraction has more than six; whole numbers unchanged.
std::string shortened(const std::string& text);

/// Three digits: "25.4", "3338", "4.73 million".
std::string three_digits(double value);

/// "92.50 %" of 0.925.
std::string percent(double share);

/// "1 setting", "2 settings".
std::string counted(std::size_t count, const char* what);

/// Two different numbers with at least `digits` digits, and with enough for the difference of the
/// texts to be theirs, give or take a half of it.
std::pair<std::string, std::string> told_apart(double a, double b, int digits);

}  // namespace capsoc::report
