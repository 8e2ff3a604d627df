// Reports without a browser: thinning, texts that end up in a page, results that are none.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <regex>
#include <set>

#include "../fuzz/damage.h"
#include "report/html.h"
#include "report/page.h"
#include "report/picture.h"

namespace capsoc::report {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

Curve ramp(std::size_t points) {
  Curve curve;
  for (std::size_t i = 0; i < points; ++i)
    curve.add(static_cast<double>(i), std::sin(static_cast<double>(i) / 1000));
  return curve;
}

TEST(Thinning, KeepsEverySpikeAndBothEnds) {
  for (const std::size_t spike : {1U, 777U, 50000U, 99998U}) {
    Curve curve = ramp(100000);
    curve.y[spike] = 17;
    curve.y[spike / 2 + 10] = -23;
    const Curve few = thinned(curve, 500);
    EXPECT_LE(few.x.size(), 1000U);
    EXPECT_EQ(few.x.front(), 0);
    EXPECT_EQ(few.x.back(), 99999);
    const auto least = std::min_element(few.y.begin(), few.y.end());
    const auto greatest = std::max_element(few.y.begin(), few.y.end());
    EXPECT_EQ(*least, -23);
    EXPECT_EQ(few.x[static_cast<std::size_t>(greatest - few.y.begin())],
              static_cast<double>(spike));
    EXPECT_EQ(*greatest, 17);
  }
}

TEST(Thinning, PointsStayInOrderAndWhatIsShortStays) {
  const Curve few = thinned(ramp(12345), 100);
  EXPECT_TRUE(std::is_sorted(few.x.begin(), few.x.end()));
  const Curve same = thinned(ramp(200), 100);
  EXPECT_EQ(same.x.size(), 200U);
  EXPECT_TRUE(thinned({}, 100).x.empty());
}

TEST(Thinning, GapsAreNoLeastAndNoGreatest) {
  Curve curve = ramp(10000);
  for (std::size_t i = 3000; i < 4000; ++i) curve.y[i] = none;
  const Curve few = thinned(curve, 50);
  EXPECT_TRUE(std::any_of(few.y.begin(), few.y.end(), [](double y) { return std::isnan(y); }));
  EXPECT_GT(std::count_if(few.y.begin(), few.y.end(), [](double y) { return !std::isnan(y); }), 80);
}

TEST(Thinning, ASpikeStaysWhereverItStands) {
  constexpr std::size_t points = 1371;
  for (std::size_t spike = 0; spike < points; ++spike) {
    Thinner thinner(7);
    for (std::size_t i = 0; i < points; ++i)
      thinner.add(static_cast<double>(i), i == spike ? 1 : i == points - 1 - spike ? -1 : 0);
    const Curve few = thinner.curve();
    ASSERT_LE(few.x.size(), 14U);
    for (const std::size_t place : {spike, points - 1 - spike}) {
      const auto there = std::find(few.x.begin(), few.x.end(), static_cast<double>(place));
      ASSERT_NE(there, few.x.end()) << place;
      ASSERT_NE(few.y[static_cast<std::size_t>(there - few.x.begin())], 0);
    }
  }
}

/// Least and greatest number of the points that lie in [from, to].
std::pair<double, double> range(const Curve& curve, double from, double to) {
  std::pair<double, double> both = {std::numeric_limits<double>::infinity(),
                                    -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < curve.x.size(); ++i)
    if (curve.x[i] >= from && curve.x[i] <= to && !std::isnan(curve.y[i]))
      both = {std::min(both.first, curve.y[i]), std::max(both.second, curve.y[i])};
  return both;
}

TEST(Thinning, EveryPartHasItsLeastAndGreatestAtAnyLength) {
  std::mt19937_64 random(20);
  for (int turn = 0; turn < 400; ++turn) {
    const std::size_t buckets = 3 + random() % 40, points = 1 + random() % 5000;
    const double gaps = turn % 3 == 0 ? 0.7 : 0;
    std::uniform_real_distribution<double> value(-1, 1), chance(0, 1);
    std::array<Curve, 2> whole;
    Thinner two(buckets, 2);
    for (std::size_t i = 0; i < points; ++i) {
      const auto x = static_cast<double>(i);
      const std::array<double, 2> y = {chance(random) < gaps ? none : value(random), value(random)};
      for (std::size_t c = 0; c < 2; ++c) whole[c].add(x, y[c]);
      two.add(x, y.data());
    }
    for (std::size_t c = 0; c < 2; ++c) {
      const Curve few = two.curve(c);
      ASSERT_EQ(few.x, thinned(whole[c], buckets).x);
      ASSERT_EQ(few.x.front(), 0);
      ASSERT_EQ(few.x.back(), static_cast<double>(points - 1));
      ASSERT_TRUE(std::is_sorted(few.x.begin(), few.x.end()));
      for (std::size_t i = 0; i < few.x.size(); ++i) {
        const double is = whole[c].y[static_cast<std::size_t>(few.x[i])];
        ASSERT_TRUE(few.y[i] == is || (std::isnan(few.y[i]) && std::isnan(is)));
      }
      const bool has_gaps = gaps > 0 && c == 0;
      if (points <= 2 * buckets) {
        ASSERT_EQ(few.x.size(), points);
      } else {
        ASSERT_LE(few.x.size(), (has_gaps ? 3 : 2) * buckets);
      }
      // No part is longer than this, and whatever lies in a window shows in or next to it.
      const double part = 4.0 * static_cast<double>(points) / static_cast<double>(buckets - 1) + 4;
      const double from = std::floor(chance(random) * static_cast<double>(points));
      const double to = from + chance(random) * part;
      const auto [least, greatest] = range(whole[c], from, to);
      const auto [shown_least, shown_greatest] = range(few, from - part, to + part);
      ASSERT_LE(shown_least, least);
      ASSERT_GE(shown_greatest, greatest);
    }
  }
}

TEST(Thinning, RoundsToDigits) {
  EXPECT_EQ(rounded(0.12345678912, 7), 0.1234568);
  EXPECT_EQ(rounded(-1.0 / 3 * 1e-9, 4), -3.333e-10);
  EXPECT_TRUE(std::isnan(rounded(none, 7)));
}

TEST(Thinning, ARoundedNumberIsItsShortDecimal) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-25, 20), part(-1, 1);
  for (int i = 0; i < 100000; ++i) {
    const double value = part(random) * std::pow(10, exponent(random));
    const int digits = 1 + i % 17;
    // printf rounds the value's decimals; the product with a power of ten may be a half apart.
    const std::string text = fmt::format("{:.{}g}", rounded(value, digits), digits);
    EXPECT_EQ(rounded(value, digits), std::strtod(text.c_str(), nullptr)) << value;
    const double step = std::pow(10, std::floor(std::log10(std::abs(value))) - digits + 1);
    EXPECT_LE(std::abs(rounded(value, digits) - value), step * 0.5001 + 1e-15 * std::abs(value));
  }
}

TEST(Texts, NothingLeavesItsPlace) {
  EXPECT_EQ(escaped("a<b>&\"'"), "a&#60;b&#62;&#38;&#34;&#39;");
  EXPECT_EQ(escaped(std::string_view("\0\x1b[31m\n", 7)), "\xEF\xBF\xBD\xEF\xBF\xBD[31m\n");
  EXPECT_EQ(json_text("</script><!--&"), "\"\\u003c/script\\u003e\\u003c!--\\u0026\"");
  EXPECT_EQ(json_text("\xff"), "\"\xEF\xBF\xBD\"");
}

TEST(Figures, EachHasANameOfItsOwnAndSaysWhatItIs) {
  std::set<std::string> names;
  for (const Figure& figure : figures()) {
    EXPECT_TRUE(std::regex_match(figure.name, std::regex("[a-z0-9-]+"))) << figure.name;
    EXPECT_TRUE(names.insert(figure.name).second) << figure.name;
    EXPECT_FALSE(figure.title.empty()) << figure.name;
    EXPECT_GT(figure.caption.size(), 20U) << figure.name;
    EXPECT_FALSE(figure.x.empty() || figure.y.empty()) << figure.name;
    ASSERT_NE(figure.data, nullptr) << figure.name;
    // A result that has nothing for it.
    EXPECT_TRUE(figure.data(figure, Json::object()).series.empty()) << figure.name;
  }
}

Json small_result() {
  Json j = {{"command", "capsoc run"}, {"exit", {{"code", 0}, {"reason", "well"}}}};
  j["curves"]["a1"] = {{"x", {0, 1, 2}}, {"y", {0.5, 0.6, nullptr}}};
  j["curves"]["status.LOCK"] = {{"x", {0, 1}}, {"y", {0, 1}}};
  j["parameters"]["a1"] = {{"word", 1}, {"value", 0.5}, {"true", 0.6}, {"relative_error", 0.1}};
  j["uart0"] = {{"bytes", 3}, {"sha256", "ab"}, {"text", "hi\n"}, {"left_out", 0}};
  j["profile"] = {{{"function", "main"}, {"cycles", 12}, {"instructions", 7}}};
  return j;
}

TEST(Pages, TheSameResultGivesTheSameBytes) {
  const std::vector<ResultFile> results = {{"", small_result()}};
  EXPECT_EQ(page_of(results), page_of(results));
  EXPECT_NE(page_of(results).find("data-figure=\"a1\""), std::string::npos);
}

TEST(Pages, SeveralResultsShareTheirFigures) {
  const std::vector<ResultFile> results = {{"one.json", small_result()},
                                           {"two.json", small_result()}};
  const Data data = data_of(*figure_named("a1"), results);
  ASSERT_EQ(data.series.size(), 2U);
  EXPECT_EQ(data.series[0].name, "a1, one.json");
  EXPECT_EQ(data.series[1].name, "a1, two.json");
  EXPECT_EQ(data.marks.size(), 1U);
}

TEST(Pages, AnyJsonMakesOne) {
  // Nothing is of the kind that it should be.
  const Json wrong[] = {
      Json::parse(R"({"command": "capsoc run", "curves": 3, "uart0": [], "exit": 1,
    "parameters": {"a1": [1]}, "profile": {"a": 1}, "configuration": {"x": {"y": [{}]}}})"),
      Json::parse(R"({"command": "capsoc run", "curves": {"a1": {"x": "no", "y": {}},
    "flags.x": {"x": [1, "2", null, 1e308, -1e308], "y": [true, 1, 2, 3, 4]}}, "uart0": {"text": 7}})")};
  for (const Json& json : wrong) EXPECT_GT(page_of({{"", json}}).size(), 1000U);
}

TEST(Pictures, HoldEveryLineAndMark) {
  const Figure& figure = *figure_named("a1");
  const std::string svg = svg_of(figure, figure.data(figure, small_result()));
  EXPECT_NE(svg.find(" d=\"M"), std::string::npos);
  EXPECT_NE(svg.find(">true</text>"), std::string::npos);
  EXPECT_NE(svg.find("<title>a1: amplitude of U</title>"), std::string::npos);
}

TEST(Pictures, AnyNumbersMakeFinitePlaces) {
  const double odd[] = {0, -0.0, none, 1e308, -1e308, 5e-324, 1, 1};
  for (const Figure& figure : figures())
    for (const double a : odd)
      for (const double b : odd) {
        Data data{
            {{"<a>", {{0, 1, 2}, {a, b, a}}, {a, a, a}, {b, b, b}}}, {{"m", 3}}, {"x", "y", "z"}};
        const std::string svg = svg_of(figure, data);
        EXPECT_EQ(svg.find("nan"), std::string::npos) << figure.name << " " << a << " " << b;
        EXPECT_EQ(svg.find("\"inf"), std::string::npos) << figure.name << " " << a << " " << b;
        EXPECT_EQ(svg.find("<a>"), std::string::npos);
      }
}

TEST(Pages, DamagedFilesAreRefusedOrDrawn) {
  const std::string whole = small_result().dump(2);
  uint64_t drawn = 0;
  const uint64_t count = test::file_count(2000);
  for (uint64_t number = 0; number < count; ++number) {
    test::Damage damage(number);
    const Json json = Json::parse(damage.text(whole), nullptr, false);
    if (json.is_discarded() || command_of(json).empty()) continue;
    ++drawn;
    EXPECT_GT(page_of({{"", json}}).size(), 1000U) << number;
  }
  EXPECT_GT(drawn, count / 50);
}

}  // namespace
}  // namespace capsoc::report
