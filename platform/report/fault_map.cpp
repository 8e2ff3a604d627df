#include "report/fault_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "report/html.h"

namespace capsoc::report {
namespace {

/// The worst first; the style sheet has a colour for each.
constexpr std::array<const char*, 8> fault_verdicts = {"silent",   "crashed", "hung",   "wrong",
                                                       "detected", "latent",  "masked", "others"};
constexpr double map_width = 1000, map_height = 420;
/// Room for a name.
constexpr double of_character = 6.4, of_line = 14;
/// Beyond it the smallest ones are one rectangle.
constexpr std::size_t most_places = 300;

struct Place {
  std::string name;
  double faults = 0;
  std::array<double, fault_verdicts.size()> by_verdict{};

  void add(const Place& other) {
    faults += other.faults;
    for (std::size_t i = 0; i < fault_verdicts.size(); ++i) by_verdict[i] += other.by_verdict[i];
  }
};

struct Rectangle {
  double x, y, width, height;
};

/// "0: masked" is an exit code and the verdict.
std::size_t verdict_of(const std::string& exit) {
  const std::size_t colon = exit.find(": ");
  const std::string word = colon == std::string::npos ? exit : exit.substr(colon + 2);
  const auto found = std::find(fault_verdicts.begin(), fault_verdicts.end() - 1, word);
  return static_cast<std::size_t>(found - fault_verdicts.begin());
}

/// The largest first; at the end what is too small to be seen, together.
std::vector<Place> places_of(const Json& by) {
  std::vector<Place> places;
  for (const Json* row : elements_at(by, {"values"})) {
    Place place{text_at(*row, {"value"})};
    for (const Json* exit : elements_at(*row, {"exits"})) {
      const double runs = number_at(*exit, {"runs"}).value_or(0);
      place.by_verdict[verdict_of(text_at(*exit, {"exit"}))] += runs;
      place.faults += runs;
    }
    if (place.faults > 0) places.push_back(std::move(place));
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& one, const Place& other) { return one.faults > other.faults; });
  if (places.size() > most_places) {
    Place rest{fmt::format("{} more", places.size() - most_places)};
    for (std::size_t i = most_places; i < places.size(); ++i) rest.add(places[i]);
    places.resize(most_places);
    places.push_back(std::move(rest));
  }
  return places;
}

/// Squarified: a row along the shorter side takes places as long as its worst shape gets better.
class Layout {
 public:
  explicit Layout(const std::vector<Place>& places) : places_(places) {
    const double all = std::accumulate(places.begin(), places.end(), 0.0,
                                       [](double sum, const Place& p) { return sum + p.faults; });
    scale_ = map_width * map_height / all;
    for (std::size_t first = 0; first < places.size();) first = take_row(first);
  }

  const std::vector<Rectangle>& rectangles() const { return rectangles_; }

 private:
  double area(std::size_t i) const { return places_[i].faults * scale_; }

  /// The greatest ratio of sides in a row of places of these areas.
  static double shape(double side, double sum, double least, double greatest) {
    const double depth = sum / side;
    return std::max(greatest / (depth * depth), depth * depth / least);
  }

  std::size_t take_row(std::size_t first) {
    const bool is_wide = free_.width >= free_.height;
    const double side = is_wide ? free_.height : free_.width;
    double sum = area(first);
    std::size_t end = first + 1;
    // Areas fall, so the first one is the greatest.
    while (end < places_.size() && shape(side, sum + area(end), area(end), area(first)) <=
                                       shape(side, sum, area(end - 1), area(first)))
      sum += area(end++);
    const double depth = sum / side;
    double at = is_wide ? free_.y : free_.x;
    for (std::size_t i = first; i < end; ++i) {
      const double length = area(i) / depth;
      rectangles_.push_back(is_wide ? Rectangle{free_.x, at, depth, length}
                                    : Rectangle{at, free_.y, length, depth});
      at += length;
    }
    (is_wide ? free_.x : free_.y) += depth;
    (is_wide ? free_.width : free_.height) -= depth;
    return end;
  }

  const std::vector<Place>& places_;
  double scale_ = 1;
  Rectangle free_{0, 0, map_width, map_height};
  std::vector<Rectangle> rectangles_;
};

std::string sentence_of(const Place& place) {
  std::string text = fmt::format("{}: {:.0f} faults", place.name, place.faults);
  for (std::size_t i = 0; i < fault_verdicts.size(); ++i)
    if (place.by_verdict[i] > 0)
      text += fmt::format(", {} {:.0f}", fault_verdicts[i], place.by_verdict[i]);
  return text;
}

/// The last part, with the one in front of it if it is a number: "corrections.45".
std::string short_name(const std::string& place) {
  std::size_t dot = place.rfind('.');
  const bool is_number = dot != std::string::npos &&
                         place.find_first_not_of("0123456789", dot + 1) == std::string::npos;
  if (is_number && dot > 0) dot = place.rfind('.', dot - 1);
  return dot == std::string::npos ? place : place.substr(dot + 1);
}

/// Verdicts side by side, the worst at the left; a name where there is room for it.
std::string drawing_of(const Place& place, const Rectangle& r) {
  std::string out = fmt::format("<g><title>{}</title>", escaped(sentence_of(place)));
  double x = r.x;
  for (std::size_t i = 0; i < fault_verdicts.size(); ++i) {
    const double part = r.width * place.by_verdict[i] / place.faults;
    if (part > 0)
      out +=
          fmt::format(R"(<rect class="{}" x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}"/>)",
                      fault_verdicts[i], x, r.y, part, r.height);
    x += part;
  }
  out += fmt::format(R"(<rect class="edge" x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}"/>)",
                     r.x, r.y, r.width, r.height);
  const std::string name = short_name(place.name);
  if (r.height > of_line && r.width > of_character * static_cast<double>(name.size() + 1))
    out += fmt::format(R"(<text x="{:.2f}" y="{:.2f}">{}</text>)", r.x + 4, r.y + of_line - 2,
                       escaped(name));
  return out + "</g>\n";
}

std::string map_of(const Json& by) {
  const std::vector<Place> places = places_of(by);
  if (places.empty()) return "";
  Place all{"All"};
  for (const Place& place : places) all.add(place);
  const std::string name = text_at(by, {"name"});
  std::string legend;
  for (std::size_t i = 0; i < fault_verdicts.size(); ++i)
    if (all.by_verdict[i] > 0)
      legend += fmt::format("<li class=\"{}\">{}: {:.0f}</li>", fault_verdicts[i],
                            fault_verdicts[i], all.by_verdict[i]);
  const Layout layout(places);
  std::string drawing;
  for (std::size_t i = 0; i < places.size(); ++i)
    drawing += drawing_of(places[i], layout.rectangles()[i]);
  return fmt::format(
      "<figure class=\"faults\"><svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" "
      "aria-label=\"{}\">\n{}</svg>\n<ul class=\"legend\">{}</ul>"
      "<figcaption>Injected faults by {}. An area counts faults, which are drawn in proportion to "
      "bits, and is divided by their verdicts; point at it for its numbers. The table has "
      "them, "
      "too.</figcaption></figure>\n",
      map_width, map_height, escaped(sentence_of(all)), drawing, legend, escaped(name));
}

}  // namespace

std::string fault_maps_of(const Json& result) {
  if (text_at(result, {"kind"}) != "fault") return "";
  std::string maps;
  for (const Json* by : elements_at(result, {"by"})) {
    const std::string expression = text_at(*by, {"expression"});
    if (expression == "fault.unit" || expression == "fault.place") maps += map_of(*by);
  }
  return maps;
}

}  // namespace capsoc::report
