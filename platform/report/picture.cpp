#include "report/picture.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "host/files.h"
#include "report/html.h"

extern char** environ;

namespace capsoc::report {
namespace {

constexpr double width = 720, height = 432, left = 82, right = 16, top = 40, bottom = 62;
constexpr std::array<const char*, 6> colours = {"#0550ae", "#bc4c00", "#116329",
                                                "#8250df", "#a40e26", "#4d6a00"};
constexpr double legend_row = 18;
constexpr std::size_t longest_label = 18;
constexpr const char* mark_colour = "#6e7781";

/// What tells lines of one colour apart.
const char* dashes(const Series& series) {
  static constexpr std::array<const char*, 3> all = {"", " stroke-dasharray=\"7 4\"",
                                                     " stroke-dasharray=\"2 4\""};
  return all.at(series.variant % all.size());
}

/// Values to places on the paper. Whatever the values, the places are finite.
class Scale {
 public:
  Scale(double from, double to, bool log) : from_(from), to_(to), log_(log) {}

  /// Whether it can be drawn.
  bool holds(double value) const { return std::isfinite(value) && (!log_ || value != 0); }
  void take(double value) {
    if (!holds(value)) return;
    least_ = std::min(least_, shown(value));
    greatest_ = std::max(greatest_, shown(value));
  }
  void close(double margin) {
    if (!(least_ <= greatest_)) least_ = 0, greatest_ = 1;
    // Halved before they are subtracted: the range of any two doubles is finite then.
    double half = greatest_ / 2 - least_ / 2;
    if (half == 0) half = std::max(std::abs(least_) / 10, 1e-300);
    const double middle = greatest_ / 2 + least_ / 2;
    half = std::min(half * (1 + margin), std::numeric_limits<double>::max() / 4);
    least_ = middle - half;
    greatest_ = middle + half;
  }
  double place(double value) const {
    const double part = (shown(value) / 2 - least_ / 2) / (greatest_ / 2 - least_ / 2);
    return from_ + std::clamp(std::isfinite(part) ? part : 0.0, -1.0, 2.0) * (to_ - from_);
  }

  /// Round numbers, or decades, in the scale's own unit.
  std::vector<std::pair<double, std::string>> ticks() const {
    std::vector<std::pair<double, std::string>> all;
    const double range = greatest_ - least_;
    if (!(range > 0) || !std::isfinite(range)) return all;
    double step = std::pow(10, std::floor(std::log10(range / 5)));
    for (const double factor : {2.0, 2.5, 2.0})
      if (range / step > 8) step *= factor;
    if (log_) step = std::max(1.0, std::ceil(range / 8));
    if (!(step > 0)) return all;
    const double first = std::ceil(least_ / step);
    for (int i = 0; i < 12; ++i) {
      const double at = (first + i) * step;
      if (!(at <= greatest_)) break;
      all.emplace_back(from_ + (at - least_) / range * (to_ - from_),
                       log_ ? fmt::format("1e{:g}", at)
                            : fmt::format("{:.6g}", std::abs(at) < step * 1e-6 ? 0.0 : at));
    }
    return all;
  }

 private:
  double shown(double value) const { return log_ ? std::log10(std::abs(value)) : value; }

  double from_, to_;
  bool log_;
  double least_ = std::numeric_limits<double>::infinity(), greatest_ = -least_;
};

std::string text(double x, double y, const std::string& words, const char* more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", x, y, more, escaped(words));
}

std::string line(double x1, double y1, double x2, double y2, const char* colour,
                 const std::string& more = "") {
  return fmt::format(
      "<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" stroke=\"{}\"{}/>\n", x1, y1,
      x2, y2, colour, more);
}

class Drawing {
 public:
  Drawing(const Figure& figure, const Data& data) : figure_(figure), data_(data) {
    for (std::size_t i = 0; i < data.series.size(); ++i) {
      for (const double value : data.series[i].curve.x) x_.take(value);
      for (const double value : data.series[i].curve.y) y_.take(level(i, value));
      for (const double value : data.series[i].low) y_.take(value);
    }
    for (const Mark& mark : data.marks) y_.take(mark.at);
    if (figure.kind == Kind::bars) {
      x_.take(-0.5);
      x_.take(static_cast<double>(data.labels.size()) - 0.5);
      if (!figure.log) y_.take(0);
    }
    x_.close(0);
    y_.close(0.05);
  }

  std::string svg() const {
    int more_rows = 0;
    const std::string names = legend(more_rows);
    std::string out = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
        "height=\"{1:g}\" font-family=\"DejaVu Sans, sans-serif\" font-size=\"12\" role=\"img\">\n",
        width, height + legend_row * more_rows);
    out += "<title>" + escaped(title_of(figure_, data_)) + "</title>\n<desc>" +
           escaped(whole_caption(figure_)) +
           "</desc>\n<rect width=\"100%\" height=\"100%\" "
           "fill=\"#fff\"/>\n";
    out += axes();
    for (std::size_t i = 0; i < data_.series.size(); ++i) out += series(i);
    for (const Mark& mark : data_.marks)
      out += line(left, y_.place(mark.at), width - right, y_.place(mark.at), mark_colour,
                  " stroke-dasharray=\"6 4\" stroke-width=\"1.5\"");
    return out + names + "</svg>\n";
  }

 private:
  double level(std::size_t number, double value) const {
    return figure_.kind == Kind::lanes ? static_cast<double>(number) + 0.8 * value : value;
  }

  std::string axes() const {
    constexpr const char* grid = "#d0d7de";
    std::string out;
    for (const auto& [at, label] : y_.ticks()) {
      if (figure_.kind == Kind::lanes) break;
      out += line(left, at, width - right, at, grid) +
             text(left - 6, at + 4, label, " text-anchor=\"end\"");
    }
    if (figure_.kind == Kind::lanes)
      for (std::size_t i = 0; i < data_.series.size(); ++i)
        out += text(left - 6, y_.place(static_cast<double>(i) + 0.4) + 4, data_.series[i].name,
                    " text-anchor=\"end\" font-size=\"9\"");
    if (figure_.kind == Kind::bars) {
      const std::size_t step = label_step();
      for (std::size_t i = 0; i < data_.labels.size(); i += step)
        out += text(x_.place(static_cast<double>(i)), height - bottom + 18,
                    data_.labels[i].substr(0, longest_label),
                    " text-anchor=\"middle\" font-size=\"10\"");
    } else {
      for (const auto& [at, label] : x_.ticks())
        out += line(at, top, at, height - bottom, grid) +
               text(at, height - bottom + 18, label, " text-anchor=\"middle\"");
    }
    out += fmt::format(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" "
        "stroke=\"#57606a\"/>\n",
        left, top, width - left - right, height - top - bottom);
    out += text((left + width - right) / 2, height - bottom + 36, figure_.x,
                " text-anchor=\"middle\"");
    out += fmt::format(
        "<text transform=\"translate(16 {}) rotate(-90)\" "
        "text-anchor=\"middle\">{}</text>\n",
        (top + height - bottom) / 2, escaped(figure_.y));
    return out + text(left, 18, title_of(figure_, data_), " font-size=\"14\" font-weight=\"bold\"");
  }

  /// The distance of the labelled bars: no label touches the next one.
  std::size_t label_step() const {
    constexpr double letter = 6;
    std::size_t longest = 0;
    for (const std::string& label : data_.labels)
      longest = std::max(longest, std::min(label.size(), longest_label));
    const double fit = (width - left - right) / (letter * static_cast<double>(longest + 2));
    return static_cast<std::size_t>(static_cast<double>(data_.labels.size()) / fit) + 1;
  }

  std::string series(std::size_t number) const {
    const Series& one = data_.series[number];
    const char* colour = colours.at(colour_of(data_, number));
    if (figure_.kind == Kind::bars) return bars(number, colour);
    const bool steps = figure_.kind == Kind::steps || figure_.kind == Kind::lanes;
    std::string path;
    bool down = false;
    for (std::size_t i = 0; i < one.curve.x.size(); ++i) {
      const double value = level(number, one.curve.y[i]);
      if (!y_.holds(value)) {
        down = down && figure_.log && one.curve.y[i] == 0;  // a gap, or nothing to be drawn of 0
        continue;
      }
      const double x = x_.place(one.curve.x[i]), y = y_.place(value);
      if (figure_.kind == Kind::points)
        path += fmt::format("M{:.2f} {:.2f}h0", x, y);
      else if (down && steps)
        path += fmt::format("H{:.2f}V{:.2f}", x, y);
      else
        path += fmt::format("{}{:.2f} {:.2f}", down ? 'L' : 'M', x, y);
      down = true;
    }
    if (one.curve.x.size() == 1 && down) path += "h0.1";  // a point alone
    const bool points = figure_.kind == Kind::points || one.curve.x.size() == 1;
    return fmt::format(
        "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
        "stroke-linecap=\"round\" stroke-linejoin=\"round\"{}/>\n",
        path, colour, points ? "2.2" : "1.2", points ? "" : dashes(one));
  }

  std::string bars(std::size_t number, const char* colour) const {
    const Series& one = data_.series[number];
    const double room = x_.place(1) - x_.place(0);
    const double wide = 0.8 * room / static_cast<double>(data_.series.size());
    const double floor = height - bottom;
    const double zero = figure_.log ? floor : std::clamp(y_.place(0), top, floor);
    std::string out;
    for (std::size_t i = 0; i < one.curve.x.size(); ++i) {
      if (!y_.holds(one.curve.y[i])) continue;
      const double at = x_.place(one.curve.x[i]) - 0.4 * room + static_cast<double>(number) * wide;
      const double y = y_.place(one.curve.y[i]);
      out += fmt::format(
          "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" "
          "fill=\"{}\" fill-opacity=\"{}\"/>\n",
          at, std::min(y, zero), std::max(wide - 1, 0.5), std::abs(zero - y), colour,
          one.low.empty() && one.variant == 0 ? "1" : "0.5");
      if (i < one.low.size() && i < one.high.size())
        out += line(at + wide / 2, y_.place(one.low[i]), at + wide / 2, y_.place(one.high[i]),
                    colour, " stroke-width=\"2\"");
    }
    return out;
  }

  /// One entry after the other, in as many rows as they need; `rows` counts those.
  std::string legend(int& rows) const {
    rows = 0;
    if (data_.series.size() + data_.marks.size() < 2 || figure_.kind == Kind::lanes) return "";
    std::string out;
    double x = left, y = height - 12;
    const auto entry = [&](const std::string& name, const char* colour, const std::string& more) {
      const double wide = 34 + 6.8 * static_cast<double>(name.size());
      if (x > left && x + wide > width) {
        x = left;
        y += legend_row;
        ++rows;
      }
      out += line(x, y, x + 16, y, colour, more) + text(x + 20, y + 4, name, " font-size=\"11\"");
      x += wide;
    };
    for (std::size_t i = 0; i < data_.series.size(); ++i)
      entry(data_.series[i].name, colours.at(colour_of(data_, i)),
            std::string(" stroke-width=\"3\"") + dashes(data_.series[i]));
    for (const Mark& mark : data_.marks)
      entry(mark.label, mark_colour, " stroke-width=\"2\" stroke-dasharray=\"6 4\"");
    return out;
  }

  const Figure& figure_;
  const Data& data_;
  Scale x_{left, width - right, false};
  Scale y_{height - bottom, top, figure_.log};
};

/// Runs rsvg-convert with the picture on its standard input.
bool convert(const std::string& svg, const std::string& place) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> input(std::tmpfile(), std::fclose);
  if (input == nullptr) return false;
  if (std::fwrite(svg.data(), 1, svg.size(), input.get()) != svg.size()) return false;
  std::rewind(input.get());
  std::array<std::string, 5> words = {"rsvg-convert", "--format=png", "--zoom=2", "--output",
                                      place};
  std::array<char*, words.size() + 1> arguments{};
  for (std::size_t i = 0; i < words.size(); ++i) arguments.at(i) = words.at(i).data();
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, fileno(input.get()), 0);
  pid_t child = 0;
  const bool started =
      posix_spawnp(&child, arguments[0], &files, nullptr, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&files);
  int status = 0;
  return started && waitpid(child, &status, 0) == child && WIFEXITED(status) &&
         WEXITSTATUS(status) == 0;
}

}  // namespace

std::string svg_of(const Figure& figure, const Data& data) {
  return Drawing(figure, data).svg();
}

std::optional<Error> write_picture(const std::string& path, const std::string& svg) {
  constexpr std::string_view png = ".png";
  if (path.size() < png.size() || path.compare(path.size() - png.size(), png.size(), png) != 0)
    return host::write_whole(path, svg);
  host::GrowingFile file(path);
  if (!convert(svg, file.growing()))
    return Error{fmt::format(
        "{}: rsvg-convert makes PNG and could not; install librsvg2-bin, or take a .svg", path)};
  return file.name();
}

}  // namespace capsoc::report
