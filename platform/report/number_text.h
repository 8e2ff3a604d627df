// Numbers as a reader needs them: the digits that mean something.
#pragma once

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

/// Two different numbers with at least `digits` digits, and with enough to tell them apart.
std::pair<std::string, std::string> told_apart(double a, double b, int digits);

}  // namespace capsoc::report
