// Conditions over the state of a simulation.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/result.h"

namespace capsoc::service {

/// `turns > 3 and COPROCESSOR.STATUS.LOCK == 1`: numbers (decimal, 0x..), names, + - * / %, & | ^ ~
/// << >>, comparisons, and, or, not, and parentheses, as in Python, but without chains of
/// comparisons; true is 1. Values
/// are double; the operators on bits take them as whole numbers.
class Expression {
 public:
  /// The value of a name: a variable, a register, $pc.
  using Lookup = std::function<Result<double>(const std::string& name)>;

  /// An Error says where the text is no expression.
  static Result<Expression> parse(const std::string& text);

  /// An Error of a name, or a division by 0.
  Result<double> value(const Lookup& lookup) const;

  struct Node;

 private:
  explicit Expression(std::shared_ptr<const Node> root) : root_(std::move(root)) {}
  std::shared_ptr<const Node> root_;
};

}  // namespace capsoc::service
