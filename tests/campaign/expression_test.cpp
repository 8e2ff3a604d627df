#include "campaign/expression.h"

#include <gtest/gtest.h>

#include <map>

namespace {

using namespace capsoc::campaign;

Value evaluate(const std::string& text) {
  const std::map<std::string, Value> values = {
      {"a", 2.0}, {"b.c", -3.0}, {"word", std::string("good")}, {"yes", true}, {"nothing", {}}};
  const auto expression = Expression::parse(text);
  if (!expression) return "wrong: " + expression.error();
  return expression.value().evaluate([&](const std::string& name) {
    const auto known = values.find(name);
    return known != values.end() ? known->second : Value();
  });
}

TEST(Expression, ArithmeticBindsAsUsual) {
  EXPECT_EQ(evaluate("1 + 2 * 3 - 4 / 2"), Value(5.0));
  EXPECT_EQ(evaluate("(1 + 2) * 3"), Value(9.0));
  EXPECT_EQ(evaluate("8 / 4 / 2"), Value(1.0));
  EXPECT_EQ(evaluate("1 - 2 - 3"), Value(-4.0));
  EXPECT_EQ(evaluate("-a * -b.c"), Value(-6.0));
  EXPECT_EQ(evaluate("--a"), Value(2.0));
  EXPECT_EQ(evaluate("1e-3 * 1e3"), Value(1.0));
  EXPECT_EQ(evaluate("2e-3-1e-3 < 2e-3"), Value(true));
  EXPECT_EQ(evaluate("abs(b.c) + sqrt(4) + log10(100) + min(1, a, 3) + max(a, 7)"), Value(15.0));
}

TEST(Expression, OrderAndLogic) {
  EXPECT_EQ(evaluate("a < 3 and b.c > -4"), Value(true));
  EXPECT_EQ(evaluate("a <= 2 and a >= 2 and not a != 2"), Value(true));
  EXPECT_EQ(evaluate("false and false or true"), Value(true));
  EXPECT_EQ(evaluate("not yes or yes"), Value(true));
  EXPECT_EQ(evaluate("word == 'good'"), Value(true));
  EXPECT_EQ(evaluate("word < 'h'"), Value(true));
  EXPECT_EQ(evaluate("yes == true"), Value(true));
  EXPECT_EQ(evaluate("a > 2"), Value(false));
  EXPECT_EQ(evaluate("a >= 3"), Value(false));
}

TEST(Expression, WhatIsNotKnownStaysSo) {
  for (const char* text :
       {"nothing + 1", "nothing < 1", "1 > nothing", "1 / 0", "sqrt(-1)", "log10(0)", "word < 1",
        "word + 1", "-word", "not nothing", "yes < false", "nothing and yes", "nothing or false",
        "unknown", "1e308 * 10"})
    EXPECT_EQ(evaluate(text), Value()) << text;
  EXPECT_EQ(evaluate("nothing == null"), Value(true));
  EXPECT_EQ(evaluate("a != null"), Value(true));
  EXPECT_EQ(evaluate("nothing and false"), Value(false));
  EXPECT_EQ(evaluate("true or nothing"), Value(true));
  EXPECT_EQ(evaluate("word == 1"), Value(false));
}

TEST(Expression, WhatIsWrongHasItsPlace) {
  const std::pair<const char*, const char*> wrong[] = {
      {"", "a number, a name or '(' is missing at character 1"},
      {"1 +", "a number, a name or '(' is missing at character 4"},
      {"(1", "')' is missing at character 3"},
      {"1 2", "an operator or the end is missing at character 3"},
      {"a < b.c < 3", "an operator or the end is missing at character 9"},
      {".a", "a number, a name or '(' is missing at character 1"},
      {"1.2.3", "a number is missing at character 1"},
      {"'a", "the end of the text, ' is missing at character 1"},
      {"round(1)", "abs, sqrt, log10, min or max before '(' is missing at character 1"},
      {"abs(1, 2)", "')' is missing at character 6"}};
  for (const auto& [text, sentence] : wrong) {
    const auto parsed = Expression::parse(text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_NE(parsed.error().find(sentence), std::string::npos) << text << ": " << parsed.error();
  }
  EXPECT_FALSE(Expression::parse(std::string(500, '(')));
  EXPECT_FALSE(Expression::parse(std::string(5000, '1')));
  EXPECT_FALSE(Expression::parse(std::string(4000, '-')));
}

TEST(Expression, NamesAreThoseThatItLooksUp) {
  const auto parsed = Expression::parse("a + b.c > a and not order and nothing");
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed.value().names(), (std::vector<std::string>{"a", "b.c", "order", "nothing"}));
}

}  // namespace
