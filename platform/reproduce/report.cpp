#include "reproduce/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace capsoc::reproduce {

double Spread::least() const {
  return *std::min_element(values_.begin(), values_.end());
}
double Spread::greatest() const {
  return *std::max_element(values_.begin(), values_.end());
}

bool Spread::admits(double printed, int decimals) const {
  const double margin = 0.5 * (greatest() - least()) + 0.5 * std::pow(10.0, -decimals);
  return printed >= least() - margin && printed <= greatest() + margin;
}

std::string Spread::text(int decimals) const {
  const std::string low = fmt::format("{:.{}f}", least(), decimals);
  const std::string high = fmt::format("{:.{}f}", greatest(), decimals);
  return low == high ? low : low + " .. " + high;
}

void Report::heading(const std::string& title) {
  out_ << "\n" << title << "\n";
  line("", "paper", "here", "");
}

void Report::sentence(const std::string& text) {
  out_ << "  " << text << "\n";
}

void Report::row(const std::string& label, const std::string& paper, const std::string& here,
                 bool agrees) {
  if (!agrees) ++unexpected_;
  line(label, paper, here, agrees ? "agrees" : "DIFFERS, and should not");
}

void Report::known(const std::string& label, const std::string& paper, const std::string& here,
                   const std::string& why) {
  line(label, paper, here, "differs: " + why);
}

void Report::line(const std::string& label, const std::string& paper, const std::string& here,
                  const std::string& verdict) {
  std::string text = fmt::format("  {:<34} {:>10}  {:>18}  {}", label, paper, here, verdict);
  text.erase(text.find_last_not_of(' ') + 1);
  out_ << text << "\n";
}

bool agrees(double here, double printed, int decimals, double relative) {
  // The tiny addend lets a figure that lies exactly on half a unit round either way.
  const double unit = 0.5 * std::pow(10.0, -decimals) * (1.0 + 1e-9);
  return std::abs(here - printed) <= std::max(unit, relative * std::abs(printed));
}

}  // namespace capsoc::reproduce
