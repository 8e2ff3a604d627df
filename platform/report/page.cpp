#include "report/page.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/sha256.h"
#include "report/headline.h"
#include "report/html.h"

namespace capsoc::report {

// Embedded at build time.
extern const std::string_view page_script, page_style;

namespace {

struct Command {
  const char* name;
  void (*add_sections)(Page& page);
};
constexpr Command commands[] = {{"run", add_run_sections},
                                {"fit", add_fit_sections},
                                {"reproduce", add_reproduce_sections},
                                {"accuracy", add_accuracy_sections},
                                {"bench", add_bench_sections},
                                {"regress", add_regress_sections},
                                {"mutation", add_mutation_sections},
                                {"campaign", add_campaign_sections}};

bool any_of(const std::vector<ResultFile>& results, const char* command) {
  return std::any_of(results.begin(), results.end(),
                     [&](const ResultFile& result) { return command_of(result.json) == command; });
}

/// How it ended, in a word for the style and a sentence.
std::pair<const char*, std::string> verdict_of(const Json& result) {
  const auto code = number_at(result, {"exit", "code"});
  if (!code) return {"", ""};
  return {*code == 0 ? "good" : "bad",
          fmt::format("exit {:g}: {}", *code, text_at(result, {"exit", "reason"}))};
}

std::string title_of(const std::vector<ResultFile>& results) {
  std::string title;
  for (const Command& command : commands)
    if (any_of(results, command.name))
      title += (title.empty() ? "capsoc " : ", ") + std::string(command.name);
  return title.empty() ? "capsoc" : title;
}

std::string html_of(const Headline& headline) {
  std::string out;
  if (!headline.sentence.empty())
    out += fmt::format("<p class=\"answer\"><span class=\"{}\">{}.</span></p>\n", headline.style,
                       escaped(headline.sentence));
  if (headline.figures.empty()) return out;
  out += "<dl class=\"key\">\n";
  for (const Headline::Figure& figure : headline.figures)
    out += fmt::format("<div><dt>{}</dt><dd title=\"{}\">{}</dd></div>\n", escaped(figure.label),
                       escaped(figure.exact), escaped(figure.value));
  return out + "</dl>\n";
}

std::string header_of(const std::vector<ResultFile>& results,
                      const std::optional<Comparison>& comparison) {
  std::string out = "<header>\n<h1>" + escaped(title_of(results)) +
                    (comparison ? ": two results" : "") + "</h1>\n";
  if (comparison) return out + html_of(*comparison) + "</header>\n";
  for (const ResultFile& result : results) {
    const auto [style, sentence] = verdict_of(result.json);
    if (results.size() == 1) out += html_of(headline_of(result.json));
    if (!result.label.empty() || !sentence.empty())
      out += fmt::format("<p>{} <span class=\"{}\">{}</span></p>\n", escaped(result.label), style,
                         escaped(sentence));
    if (results.size() > 1) out += html_of(headline_of(result.json));
  }
  return out + "</header>\n";
}

/// Many links are folded, so that the first screen has room for the answer.
std::string contents_of(const std::string& links, int sections) {
  constexpr int most = 12;
  std::string list = "<ul>\n" + links + "</ul>\n";
  if (sections <= most) return list;
  return fmt::format("<details><summary>Contents: {} sections</summary>\n{}</details>\n", sections,
                     list);
}

}  // namespace

Page::Page(const std::vector<ResultFile>& results)
    : results_(results), comparison_(compared(results)) {
  // Room for a run's figures; what is not filled is not there, and growing would copy it.
  constexpr std::size_t much = std::size_t{1} << 20U;
  data_.reserve(much);
}

std::string Page::place(const Figure& figure) {
  if (!done_.insert(figure.name).second) return "";
  const Data data = data_of(figure, results_);
  if (data.series.empty()) return "";
  data_.append(data_.empty() ? "" : ",\n").append(json_text(figure.name)).append(":");
  data_ += json_of(figure, data);
  return html_of(figure, data);
}

std::string Page::figure(const std::string& name) {
  return place(*figure_named(name));
}

void Page::leave_out(const std::vector<std::string>& figures) {
  done_.insert(figures.begin(), figures.end());
}

std::string Page::figures_of(const std::string& command, const std::string& section) {
  std::string out;
  for (const Figure& figure : figures())
    if (figure.command == command && figure.section == section) out += place(figure);
  return out.empty() ? "" : columns(out);
}

void Page::add(const std::string& title, const std::string& body) {
  if (body.empty()) return;
  const std::string id = fmt::format("section-{}", ++sections_);
  contents_ += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", id, escaped(title));
  body_ += section(id, title, body);
}

std::string Page::of_each(const std::string& command,
                          std::string (*piece)(const Json& result)) const {
  std::string out;
  for (const ResultFile& result : results_) {
    if (command_of(result.json) != command) continue;
    const std::string body = piece(result.json);
    if (body.empty()) continue;
    out += "<div>\n";
    if (results_.size() > 1) out.append("<h3>").append(escaped(result.label)).append("</h3>\n");
    out.append(body).append("</div>\n");
  }
  return out.empty() ? "" : columns(out);
}

std::string Page::text() const {
  const auto hash = [](std::string_view script) {
    return "'sha256-" + host::base64_sha256_of(script) + "'";
  };
  std::string out;
  constexpr std::size_t rest = 65536;
  out.reserve(body_.size() + data_.size() + page_script.size() + rest);
  out += "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  // In addition to the escaping: no other script would run, and nothing is loaded from anywhere.
  out += fmt::format(
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src {}; "
      "style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'\">\n",
      hash(page_script));
  out += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  out += "<link rel=\"icon\" href=\"data:,\">\n";
  out += "<title>" + escaped(title_of(results_)) + "</title>\n<style>\n";
  out.append(page_style).append("</style>\n</head>\n");
  out += "<body>\n<a class=\"skip\" href=\"#main\">To the results</a>\n" +
         header_of(results_, comparison_);
  out += "<nav aria-label=\"Contents\">\n" + contents_of(contents_, sections_) + "</nav>\n";
  out += "<main id=\"main\">\n";
  out +=
      "<noscript><p>To zoom plots and to read values in them needs a browser with JavaScript; "
      "plots, tables and texts do not.</p></noscript>\n";
  out.append(body_).append(
      "</main>\n<footer>\n<p>Made by capsoc. This page is one file and loads nothing.</p>\n");
  out += "</footer>\n<script type=\"application/json\" id=\"figures\">{";
  out.append(data_).append("}</script>\n<script>").append(page_script);
  out.append("</script>\n</body>\n</html>\n");
  return out;
}

std::string origin_of(const Json& result) {
  std::string out = paragraph("The command that gives this result again:") +
                    preformatted("Command", text_at(result, {"command"}));
  Table versions{"Versions", {"what", "version"}, {}, true};
  if (const Json* all = find(result, {"versions"}); all != nullptr && all->is_object())
    for (const auto& [name, version] : all->items())
      versions.rows.push_back({name, shown_at(version, {})});
  Table inputs{"Inputs", {"role", "file", "SHA-256"}, {}, true};
  for (const Json* input : elements_at(result, {"inputs"}))
    inputs.rows.push_back(
        {text_at(*input, {"role"}), text_at(*input, {"path"}), text_at(*input, {"sha256"})});
  return out + html_of(versions) + html_of(inputs);
}

std::string page_of(const std::vector<ResultFile>& results) {
  Page page(results);
  if (page.comparison()) add_comparison_sections(page, *page.comparison());
  for (const Command& command : commands)
    if (any_of(results, command.name)) command.add_sections(page);
  return page.text();
}

}  // namespace capsoc::report
