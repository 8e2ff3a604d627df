#include "report/html.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "report/drawing.h"
#include "report/number_text.h"

namespace capsoc::report {
namespace {

void append_numbers(std::string& out, const std::vector<double>& values) {
  out += '[';
  for (const double value : values) {
    if (out.back() != '[') out += ',';
    if (!std::isfinite(value)) {
      out += "null";
      continue;
    }
    std::array<char, 32> text;
    out.append(text.data(), fmt::format_to(text.data(), FMT_COMPILE("{}"), value));
  }
  out += ']';
}

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::lines:
      return "lines";
    case Kind::steps:
      return "steps";
    case Kind::points:
      return "points";
    case Kind::bars:
      return "bars";
    case Kind::lanes:
      break;
  }
  return "lanes";
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '<' || c == '>' || c == '&' || c == '"' || c == '\'')
      fmt::format_to(std::back_inserter(out), "&#{};", byte);
    else if ((byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7F)
      out += c == '\r' ? "" : "\xEF\xBF\xBD";
    else
      out += c;
  }
  return out;
}

std::string json_text(std::string_view text) {
  const std::string json = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  for (const char c : json) {
    // Nothing inside of a script element ends it.
    if (c == '<' || c == '>' || c == '&')
      fmt::format_to(std::back_inserter(out), "\\u{:04x}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out;
}

std::string html_of(const Table& table) {
  if (table.rows.empty()) return "";
  std::string out = "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" +
                    escaped(table.caption) + "\"><table class=\"sortable\"><caption>" +
                    escaped(table.caption) + "</caption>\n<thead><tr>";
  const auto numeric = [&](std::size_t column) {
    bool any = false;
    for (const auto& row : table.rows) {
      if (column >= row.size()) continue;
      if (!is_number(row[column].text)) return false;
      any = any || row[column].text != "-";
    }
    return any;
  };
  std::vector<bool> numbers;
  for (std::size_t column = 0; column < table.head.size(); ++column) {
    numbers.push_back(numeric(column));
    out += fmt::format("<th scope=\"col\"{}>{}</th>", numbers.back() ? " class=\"n\"" : "",
                       escaped(table.head[column]));
  }
  out += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (std::size_t column = 0; column < row.size(); ++column) {
      std::string style = row[column].style;
      if (column < numbers.size() && numbers[column]) style += style.empty() ? "n" : " n";
      const std::string& text = row[column].text;
      const std::string shown = table.is_exact || !is_number(text) ? text : shortened(text);
      out += "<td";
      if (!style.empty()) out += " class=\"" + style + "\"";
      const std::string& exact = row[column].exact.empty() ? text : row[column].exact;
      if (shown != exact) out += " title=\"" + escaped(exact) + "\"";
      out += ">" + escaped(shown) + "</td>";
    }
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string section(const std::string& id, const std::string& title, const std::string& body) {
  return fmt::format("<section aria-labelledby=\"{0}\">\n<h2 id=\"{0}\">{1}</h2>\n{2}</section>\n",
                     id, escaped(title), body);
}

std::string paragraph(const std::string& text) {
  return "<p>" + escaped(text) + "</p>\n";
}

std::string preformatted(const std::string& name, const std::string& text) {
  return fmt::format("<pre tabindex=\"0\" role=\"region\" aria-label=\"{}\">{}</pre>\n",
                     escaped(name), escaped(text));
}

std::string columns(const std::string& items) {
  return "<div class=\"columns\">\n" + items + "</div>\n";
}

std::string html_of(const Figure& figure, const Data& data) {
  std::string legend;
  if (data.series.size() + data.marks.size() > 1 && figure.kind != Kind::lanes) {
    legend = "<ul class=\"legend\">";
    for (std::size_t i = 0; i < data.series.size(); ++i)
      legend += fmt::format("<li class=\"line-{} variant-{}\">{}</li>", colour_of(data, i) + 1,
                            data.series[i].variant % 3, escaped(data.series[i].name));
    for (const Mark& mark : data.marks)
      legend += "<li class=\"mark\">" + escaped(mark.label) + "</li>";
    legend += "</ul>\n";
  }
  return fmt::format(
      "<figure id=\"figure-{0}\" data-figure=\"{0}\"{1}>\n<h3>{2}</h3>\n"
      "<div class=\"plot\" tabindex=\"0\" role=\"slider\" aria-valuemin=\"0\" aria-valuemax=\"0\" "
      "aria-valuenow=\"0\" aria-valuetext=\"no point chosen\" aria-label=\"Plot: {2}; arrow keys "
      "read its points, + and - zoom, 0 shows all\" aria-describedby=\"caption-{0}\">\n{5}</div>\n"
      "<p class=\"readout\" aria-hidden=\"true\"></p>\n{3}"
      "<figcaption id=\"caption-{0}\">{4}</figcaption>\n<div class=\"tools\"></div>\n</figure>\n",
      figure.name, figure.kind == Kind::points ? " class=\"square\"" : "",
      escaped(title_of(figure, data)), legend, escaped(whole_caption(figure)),
      Drawing(figure, data).plot());
}

namespace {

std::string json_of(const Columns& columns) {
  if (columns.all.empty()) return "";
  std::string out = fmt::format(",\"choice\":[{},{}],\"axes\":[{},{}],\"passed\":[", columns.across,
                                columns.up, columns.first_axis, columns.first_axis + columns.axes);
  for (const bool passed : columns.passed)
    out += fmt::format("{}{:d}", out.back() == '[' ? "" : ",", passed);
  out += "],\"columns\":[";
  for (const Column& column : columns.all) {
    if (out.back() != '[') out += ',';
    out += "{\"name\":" + json_text(column.name) + ",\"values\":";
    append_numbers(out, column.values);
    out += ",\"labels\":[";
    for (const std::string& label : column.labels)
      out += (out.back() == '[' ? "" : ",") + json_text(label);
    out += "]}";
  }
  return out + "]";
}

}  // namespace

std::string json_of(const Figure& figure, const Data& data) {
  std::string out =
      fmt::format("{{\"title\":{},\"kind\":\"{}\",\"log\":{},\"x\":{},\"y\":{},\"series\":[",
                  json_text(title_of(figure, data)), name_of(figure.kind), figure.log,
                  json_text(figure.x), json_text(figure.y));
  for (const Series& series : data.series) {
    if (out.back() != '[') out += ',';
    out += "{\"name\":" + json_text(series.name) + ",\"x\":";
    append_numbers(out, series.curve.x);
    out += ",\"y\":";
    append_numbers(out, series.curve.y);
    if (!series.low.empty()) {
      out += ",\"low\":";
      append_numbers(out, series.low);
      out += ",\"high\":";
      append_numbers(out, series.high);
    }
    if (series.colour > 0)
      out += fmt::format(",\"colour\":{},\"variant\":{}", series.colour, series.variant);
    out += '}';
  }
  out += "],\"marks\":[";
  for (const Mark& mark : data.marks) {
    if (out.back() != '[') out += ',';
    out += fmt::format("{{\"label\":{},\"at\":{}}}", json_text(mark.label), mark.at);
  }
  out += "],\"labels\":[";
  for (const std::string& label : data.labels) {
    if (out.back() != '[') out += ',';
    out += json_text(label);
  }
  return out + "]" + json_of(data.columns) + "}";
}

}  // namespace capsoc::report
