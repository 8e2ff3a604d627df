// Expressions over named values: criteria, metrics, settings that follow from others.
//
//   expression := conjunction { "or" conjunction }
//   conjunction := negation { "and" negation }
//   negation := "not" negation | comparison
//   comparison := sum [ ("<" | "<=" | ">" | ">=" | "==" | "!=") sum ]
//   sum := product { ("+" | "-") product }
//   product := factor { ("*" | "/") factor }
//   factor := "-" factor | number | 'text' | "true" | "false" | "null" | name
//           | function "(" expression { "," expression } ")" | "(" expression ")"
//   name := letters, digits and "_", parts separated by "."
//   function := abs | sqrt | log10 | min | max
//
// null is "not known", and spreads: arithmetic and order with null are null, `and` and `or` are
// null unless the other side decides. == and != compare with null. What has no meaning ('a' < 1,
// 1 / 0, sqrt(-1)) is null, too.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "base/result.h"

namespace capsoc::campaign {

/// null, true or false, a finite number, a text.
using Value = std::variant<std::monostate, bool, double, std::string>;

inline bool is_null(const Value& value) {
  return std::holds_alternative<std::monostate>(value);
}
/// "null" for it; numbers with all their digits.
std::string to_text(const Value& value);

using Lookup = std::function<Value(const std::string& name)>;

class Expression {
 public:
  /// Error: what is wrong and at which character, as the end of a sentence.
  static Result<Expression> parse(const std::string& text);

  Value evaluate(const Lookup& lookup) const;
  const std::string& text() const { return text_; }
  /// Those that it looks up, each once.
  const std::vector<std::string>& names() const { return names_; }

 private:
  friend class ExpressionParser;

  enum class Operation {
    constant,
    name,
    negate,
    logical_not,
    logical_and,
    logical_or,
    less,
    at_most,
    equal,
    unequal,
    add,
    subtract,
    multiply,
    divide,
    absolute,
    square_root,
    logarithm,
    minimum,
    maximum
  };
  /// In the order of execution on a stack of values.
  struct Step {
    Operation operation;
    std::size_t number = 0;  ///< in constants_ or names_
  };
  static Value apply(Operation operation, const Value& a, const Value& b);

  std::string text_;
  std::vector<Step> steps_;
  std::vector<Value> constants_;
  std::vector<std::string> names_;
};

}  // namespace capsoc::campaign
