#include "report/drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "report/html.h"

namespace capsoc::report {
namespace {

// In units of the picture, which are pixels where nothing scales it. page.js reads them there.
constexpr double picture_width = 480, left = 66, right = 14, top = 30, bottom = 44,
                 area_height = 210;
constexpr double area = picture_width - left - right;
constexpr double title_strip = 20, legend_row = 18;
constexpr double grain = 10;  // curves are in tenths
constexpr std::size_t longest_label = 18;
constexpr std::array<const char*, 6> colours = {"#0550ae", "#bc4c00", "#116329",
                                                "#8250df", "#a40e26", "#4d6a00"};
constexpr const char* mark_colour = "#6e7781";

/// What tells lines of one colour apart, in units of the picture times `scale`.
std::string dashes(const Series& series, int scale) {
  switch (series.variant % 3) {
    case 1:
      return fmt::format(" stroke-dasharray=\"{} {}\"", 7 * scale, 4 * scale);
    case 2:
      return fmt::format(" stroke-dasharray=\"{} {}\"", 2 * scale, 4 * scale);
    default:
      return "";
  }
}

std::string text(double x, double y, const std::string& words, const std::string& more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", x, y, more, escaped(words));
}

std::string line(double x1, double y1, double x2, double y2, const char* more) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"{}/>\n", x1, y1,
                     x2, y2, more);
}

bool begins_letter(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
}

std::size_t letters(const std::string& words) {
  return static_cast<std::size_t>(std::count_if(words.begin(), words.end(), begins_letter));
}

/// The first letters of a label, whole ones.
std::string shortened_label(const std::string& words) {
  std::size_t seen = 0;
  for (std::size_t i = 0; i < words.size(); ++i)
    if (begins_letter(words[i]) && ++seen > longest_label) return words.substr(0, i);
  return words;
}

/// A long name in smaller letters, so that it stays in its place.
std::string font_for(const std::string& words, double room) {
  constexpr double letter = 0.58, normal = 12, least = 7;
  const double fit = room / (letter * static_cast<double>(letters(words) + 1));
  return fit >= normal ? ""
                       : fmt::format(" font-size=\"{:.1f}\"", std::max(least, std::floor(fit)));
}

/// The next point of a path: two numbers, with a separator only where it needs one.
std::string pair(const char* command, long x, long y) {
  return fmt::format("{}{}{}{}", command, x, y < 0 ? "" : " ", y);
}

/// "error, deg" as the logarithm's axis has it: "|error|, deg".
std::string magnitude(const std::string& name) {
  const std::size_t unit = std::min(name.rfind(", "), name.size());
  return "|" + name.substr(0, unit) + "|" + name.substr(unit);
}

}  // namespace

bool spans_decades(const Column& column) {
  constexpr double decades = 20;
  double least = std::numeric_limits<double>::infinity(), greatest = 0;
  for (const double value : column.values) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  return column.labels.empty() && std::isfinite(least) && least > 0 && greatest >= decades * least;
}

Drawing::Drawing(const Figure& figure, const Data& data)
    : figure_(figure), data_(data), y_(figure.log), height_(area_height) {
  if (!data.columns.all.empty()) {
    x_ = Scale(spans_decades(data.columns.all[data.columns.across]));
    y_ = Scale(spans_decades(data.columns.all[data.columns.up]));
  }
  const bool bars = figure.kind == Kind::bars, points = figure.kind == Kind::points;
  if (points) height_ = area;
  for (std::size_t i = 0; i < data.series.size(); ++i) {
    const Series& series = data.series[i];
    for (const double value : series.curve.x) x_.take(value);
    for (const double value : series.curve.y) y_.take(level(i, value));
    for (const auto* values : {&series.low, &series.high})
      for (const double value : *values) y_.take(value);
  }
  for (const Mark& mark : data.marks) y_.take(mark.at);
  if (bars) {
    x_.take(-0.5);
    x_.take(static_cast<double>(data.labels.size()) - 0.5);
    y_.take(0);
  }
  x_.close(points ? 0.05 : 0);
  y_.close(0.05, bars && !figure.log);
}

double Drawing::level(std::size_t number, double value) const {
  return figure_.kind == Kind::lanes ? static_cast<double>(number) + 0.8 * value : value;
}

long Drawing::across(double value) const {
  return static_cast<long>(std::floor(x_.part(value) * (area * grain) + 0.5));
}

long Drawing::up(double value) const {
  return static_cast<long>(std::floor((1 - y_.part(value)) * (height_ * grain) + 0.5));
}

std::string Drawing::bar_labels() const {
  constexpr double letter = 6;
  std::size_t longest = 0;
  for (const std::string& label : data_.labels)
    longest = std::max(longest, std::min(letters(label), longest_label));
  // No label touches the next one.
  const double fit = area / (letter * static_cast<double>(longest + 2));
  const auto step =
      static_cast<std::size_t>(std::floor(static_cast<double>(data_.labels.size()) / fit)) + 1;
  std::string out;
  for (std::size_t i = 0; i < data_.labels.size(); i += step)
    out += text(left + x_.part(static_cast<double>(i)) * area, top + height_ + 16,
                shortened_label(data_.labels[i]), " text-anchor=\"middle\" font-size=\"10\"");
  return out;
}

std::string Drawing::ticks() const {
  constexpr const char* grid = " class=\"grid\" stroke=\"#d0d7de\"";
  const double floor = top + height_;
  std::string out;
  if (figure_.kind == Kind::lanes) {
    for (std::size_t i = 0; i < data_.series.size(); ++i)
      out += text(left - 6, floor - y_.part(static_cast<double>(i) + 0.4) * height_ + 4,
                  data_.series[i].name,
                  " text-anchor=\"end\"" + font_for(data_.series[i].name, left - 10));
  } else {
    for (const auto& [part, label] : y_.ticks())
      out +=
          line(left, floor - part * height_, picture_width - right, floor - part * height_, grid) +
          text(left - 6, floor - part * height_ + 4, label, " text-anchor=\"end\"");
  }
  if (figure_.kind == Kind::bars) return out + bar_labels();
  for (const auto& [part, label] : x_.ticks())
    out += line(left + part * area, top, left + part * area, floor, grid) +
           text(left + part * area, floor + 16, label, " text-anchor=\"middle\"");
  return out;
}

std::string Drawing::names() const {
  const Columns& columns = data_.columns;
  const bool chosen = !columns.all.empty();
  const std::string& x = chosen ? columns.all[columns.across].name : figure_.x;
  std::string y = chosen ? columns.all[columns.up].name : figure_.y;
  if (figure_.log && figure_.kind != Kind::bars && !chosen) y = magnitude(y);
  return text(left + area / 2, top + height_ + 34, x,
              " class=\"x-name\" text-anchor=\"middle\"" + font_for(x, area)) +
         fmt::format(
             "<text class=\"y-name\" transform=\"translate(13 {}) rotate(-90)\" "
             "text-anchor=\"middle\"{}>{}</text>\n",
             top + height_ / 2, font_for(y, height_), escaped(y));
}

std::string Drawing::axes() const {
  return "<g class=\"ticks\">\n" + ticks() + "</g>\n" + names();
}

std::string Drawing::path(std::size_t number) const {
  const Curve& curve = data_.series[number].curve;
  const bool steps = figure_.kind == Kind::steps || figure_.kind == Kind::lanes;
  std::string out;
  bool down = false;
  long x = 0, y = 0;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const double value = level(number, curve.y[i]);
    if (!y_.holds(value) || !x_.holds(curve.x[i])) {
      down = down && figure_.log && curve.y[i] == 0;  // a gap, or nothing to be drawn of 0
      continue;
    }
    const long next_x = across(curve.x[i]), next_y = up(value);
    if (figure_.kind == Kind::points)
      out += pair("M", next_x, next_y) + "h0";
    else if (down && steps)
      out += fmt::format("h{}v{}", next_x - x, next_y - y);
    else if (down)
      out += pair("l", next_x - x, next_y - y);
    else
      out += pair("M", next_x, next_y);
    x = next_x, y = next_y;
    down = true;
  }
  if (curve.x.size() == 1 && down && figure_.kind != Kind::points) out += "h0";  // a point alone
  return out;
}

std::string Drawing::bars(std::size_t number) const {
  const Series& one = data_.series[number];
  const double room = (x_.part(1) - x_.part(0)) * (area * grain);
  const double each = 0.8 * room / static_cast<double>(data_.series.size());
  const long floor = std::lround(height_ * grain);
  const long zero = figure_.log ? floor : std::clamp(up(0), 0L, floor);
  const auto thick = std::max(static_cast<long>(std::floor(each - grain + 0.5)), 5L);
  std::string out;
  for (std::size_t i = 0; i < one.curve.x.size(); ++i) {
    if (!y_.holds(one.curve.y[i]) || !std::isfinite(one.curve.x[i])) continue;
    const double at = x_.part(one.curve.x[i]) * (area * grain) - 0.4 * room;
    out += fmt::format("M{} {}V{}h{}V{}z",
                       static_cast<long>(std::floor(at + static_cast<double>(number) * each + 0.5)),
                       zero, up(one.curve.y[i]), thick, zero);
  }
  return out;
}

std::string Drawing::spread(std::size_t number) const {
  const Series& one = data_.series[number];
  const double room = (x_.part(1) - x_.part(0)) * (area * grain);
  const double each = 0.8 * room / static_cast<double>(data_.series.size());
  std::string out;
  for (std::size_t i = 0; i < std::min({one.curve.x.size(), one.low.size(), one.high.size()});
       ++i) {
    if (!y_.holds(one.low[i]) || !y_.holds(one.high[i]) || !std::isfinite(one.curve.x[i])) continue;
    const double at = x_.part(one.curve.x[i]) * (area * grain) - 0.4 * room;
    out += fmt::format(
        "M{} {}V{}",
        static_cast<long>(std::floor(at + (static_cast<double>(number) + 0.5) * each + 0.5)),
        up(one.low[i]), up(one.high[i]));
  }
  return out;
}

std::string Drawing::curve(std::size_t number) const {
  const Series& one = data_.series[number];
  const std::size_t colour = colour_of(data_, number);
  const std::string kind = fmt::format("line-{}", colour + 1);
  if (figure_.kind == Kind::bars) {
    std::string out = fmt::format(
        "<path class=\"curve bar {}\" d=\"{}\" fill=\"{}\"{}/>\n", kind, bars(number),
        colours.at(colour), one.low.empty() && one.variant == 0 ? "" : " fill-opacity=\"0.5\"");
    if (!one.low.empty())
      out += fmt::format("<path class=\"spread {}\" d=\"{}\" stroke=\"{}\" stroke-width=\"20\"/>\n",
                         kind, spread(number), colours.at(colour));
    return out;
  }
  const bool points = figure_.kind == Kind::points || one.curve.x.size() == 1;
  return fmt::format(
      "<path class=\"curve {}\" d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
      "stroke-linecap=\"round\" stroke-linejoin=\"round\"{}/>\n",
      kind, path(number), colours.at(colour), points ? "26" : "13",
      points ? "" : dashes(one, static_cast<int>(grain)));
}

std::string Drawing::curves() const {
  std::string out = fmt::format(
      "<svg class=\"area\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {} {}\">\n",
      left, top, area, height_, area * grain, height_ * grain);
  for (std::size_t i = 0; i < data_.series.size(); ++i) out += curve(i);
  for (const Mark& mark : data_.marks)
    out += fmt::format(
        "<path class=\"mark\" d=\"M0 {}H{}\" stroke=\"{}\" stroke-dasharray=\"60 40\" "
        "stroke-width=\"15\"/>\n",
        up(mark.at), area * grain, mark_colour);
  return out + "</svg>\n" +
         fmt::format(
             "<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" "
             "stroke=\"#8c959f\"/>\n",
             left, top, area, height_);
}

/// One entry after the other, in the rows that they need.
std::string Drawing::legend(int& rows) const {
  rows = 0;
  if (data_.series.size() + data_.marks.size() < 2 || figure_.kind == Kind::lanes) return "";
  rows = 1;
  std::string out;
  double x = left, y = top + height_ + bottom + 6;
  const auto entry = [&](const std::string& name, const char* colour, const std::string& more) {
    const double room = 34 + 6.4 * static_cast<double>(letters(name));
    if (x > left && x + room > picture_width) {
      x = left;
      y += legend_row;
      ++rows;
    }
    out += line(x, y, x + 16, y, fmt::format(" stroke=\"{}\"{}", colour, more).c_str()) +
           text(x + 20, y + 4, name, " font-size=\"11\"");
    x += room;
  };
  for (std::size_t i = 0; i < data_.series.size(); ++i)
    entry(data_.series[i].name, colours.at(colour_of(data_, i)),
          " stroke-width=\"3\"" + dashes(data_.series[i], 1));
  for (const Mark& mark : data_.marks)
    entry(mark.label, mark_colour, " stroke-width=\"2\" stroke-dasharray=\"6 4\"");
  return out;
}

std::string Drawing::picture() const {
  constexpr double shown_larger = 1.5;
  int rows = 0;
  const std::string names = legend(rows);
  const double height = top + height_ + bottom + legend_row * rows;
  const std::string& title = title_of(figure_, data_);
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" "
             "width=\"{2:g}\" height=\"{3:g}\" font-family=\"DejaVu Sans, sans-serif\" "
             "font-size=\"12\" role=\"img\">\n",
             picture_width, height, picture_width * shown_larger, height * shown_larger) +
         "<title>" + escaped(title) + "</title>\n<desc>" + escaped(whole_caption(figure_)) +
         "</desc>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
         text(left, 18, title, " font-weight=\"bold\"" + font_for(title, area * 0.9)) + axes() +
         curves() + names + "</svg>\n";
}

std::string Drawing::plot() const {
  return fmt::format(
             "<svg viewBox=\"0 {0:g} {1:g} {2:g}\" font-size=\"12\" aria-hidden=\"true\">\n",
             title_strip, picture_width, top + height_ + bottom - title_strip) +
         axes() + curves() + "</svg>\n";
}

}  // namespace capsoc::report
