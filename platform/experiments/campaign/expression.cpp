#include "campaign/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "base/number.h"
#include "base/printable.h"

namespace capsoc::campaign {
namespace {

constexpr std::size_t longest_text = 4096;
constexpr int deepest =
    64;  // parentheses and signs inside each other: each is a call of the parser

/// Numbers only that are some: 0 / 0 is not known.
Value finite(double value) {
  return std::isfinite(value) ? Value(value) : Value();
}

std::optional<bool> truth_of(const Value& value) {
  const bool* truth = std::get_if<bool>(&value);
  return truth != nullptr ? std::optional<bool>(*truth) : std::nullopt;
}

/// `deciding` is the value that decides the operation whatever the other one is.
Value connect(const Value& a, const Value& b, bool deciding) {
  const auto left = truth_of(a), right = truth_of(b);
  if ((left && *left == deciding) || (right && *right == deciding)) return deciding;
  if (!left || !right) return {};
  return !deciding;
}

/// -1, 0, 1; nothing for what has no order.
std::optional<int> order(const Value& a, const Value& b) {
  if (a.index() != b.index() || is_null(a) || std::holds_alternative<bool>(a)) return std::nullopt;
  return a < b ? -1 : b < a ? 1 : 0;
}

bool is_part_of_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

}  // namespace

std::string to_text(const Value& value) {
  if (const auto* truth = std::get_if<bool>(&value)) return *truth ? "true" : "false";
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return "null";
}

/// Recursive descent; each rule of the grammar is a function of its name.
class ExpressionParser {
 public:
  explicit ExpressionParser(const std::string& text) : text_(text) { result_.text_ = text; }

  Result<Expression> parse() {
    if (text_.size() > longest_text)
      return Error{fmt::format("is longer than {} characters; shorten it", longest_text)};
    expression();
    skip_space();
    if (at_ < text_.size()) fail("an operator or the end");
    if (!wrong_.empty()) return Error{wrong_};
    return std::move(result_);
  }

 private:
  using Operation = Expression::Operation;

  void expression() {
    const Depth depth(*this);
    if (!depth.fits()) return;
    conjunction();
    while (word("or")) {
      conjunction();
      add(Operation::logical_or);
    }
  }

  void conjunction() {
    negation();
    while (word("and")) {
      negation();
      add(Operation::logical_and);
    }
  }

  void negation() {
    bool negated = false;
    while (word("not")) negated = !negated;
    comparison();
    if (negated) add(Operation::logical_not);
  }

  void comparison() {
    sum();
    const auto compare = [this](Operation operation) {
      sum();
      add(operation);
    };
    if (symbol("<=")) return compare(Operation::at_most);
    if (symbol("<")) return compare(Operation::less);
    if (symbol("==")) return compare(Operation::equal);
    if (symbol("!=")) return compare(Operation::unequal);
    // a > b is not (a <= b), and null stays null.
    if (symbol(">=")) {
      compare(Operation::less);
      return add(Operation::logical_not);
    }
    if (symbol(">")) {
      compare(Operation::at_most);
      return add(Operation::logical_not);
    }
  }

  void sum() {
    product();
    for (;;) {
      if (symbol("+")) {
        product();
        add(Operation::add);
      } else if (symbol("-")) {
        product();
        add(Operation::subtract);
      } else {
        return;
      }
    }
  }

  void product() {
    factor();
    for (;;) {
      if (symbol("*")) {
        factor();
        add(Operation::multiply);
      } else if (symbol("/")) {
        factor();
        add(Operation::divide);
      } else {
        return;
      }
    }
  }

  void factor() {
    bool negative = false;
    while (symbol("-")) negative = !negative;
    if (symbol("(")) {
      expression();
      if (!symbol(")")) fail("')'");
    } else if (at_ < text_.size() && text_[at_] == '\'') {
      text_constant();
    } else if (at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9') {
      number();
    } else {
      named();
    }
    if (negative) add(Operation::negate);
  }

  void text_constant() {
    const std::size_t end = text_.find('\'', at_ + 1);
    if (end == std::string::npos) return fail("the end of the text, '");
    constant(text_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
  }

  void number() {
    std::size_t end = at_;
    while (end < text_.size() && (is_part_of_name(text_[end]) || text_[end] == '.' ||
                                  ((text_[end] == '-' || text_[end] == '+') &&
                                   (text_[end - 1] == 'e' || text_[end - 1] == 'E'))))
      ++end;
    const auto value = finite_number(std::string_view(text_).substr(at_, end - at_));
    if (!value) return fail("a number");
    constant(*value);
    at_ = end;
  }

  void named() {
    std::size_t end = at_;
    while (end < text_.size() && (is_part_of_name(text_[end]) || text_[end] == '.')) ++end;
    const std::string name = text_.substr(at_, end - at_);
    if (name.empty() || name.front() == '.' || name.back() == '.')
      return fail("a number, a name or '('");
    const std::size_t begin = at_;
    at_ = end;
    if (name == "true" || name == "false") return constant(name == "true");
    if (name == "null") return constant({});
    if (symbol("(")) return function(name, begin);
    auto& names = result_.names_;
    const auto known = std::find(names.begin(), names.end(), name);
    const auto number = static_cast<std::size_t>(known - names.begin());
    if (known == names.end()) names.push_back(name);
    result_.steps_.push_back({Operation::name, number});
  }

  void function(const std::string& name, std::size_t begin) {
    struct Function {
      const char* name;
      Operation operation;
      bool many;
    };
    static constexpr Function functions[] = {{"abs", Operation::absolute, false},
                                             {"sqrt", Operation::square_root, false},
                                             {"log10", Operation::logarithm, false},
                                             {"min", Operation::minimum, true},
                                             {"max", Operation::maximum, true}};
    for (const Function& known : functions) {
      if (name != known.name) continue;
      expression();
      if (!known.many) add(known.operation);
      while (known.many && symbol(",")) {
        expression();
        add(known.operation);
      }
      if (!symbol(")")) fail("')'");
      return;
    }
    at_ = begin;
    fail("abs, sqrt, log10, min or max before '('");
  }

  // The text's pieces.

  void skip_space() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n'))
      ++at_;
  }

  bool symbol(std::string_view wanted) {
    skip_space();
    if (text_.compare(at_, wanted.size(), wanted) != 0 || !wrong_.empty()) return false;
    at_ += wanted.size();
    skip_space();
    return true;
  }

  bool word(std::string_view wanted) {
    skip_space();
    const std::size_t end = at_ + wanted.size();
    if (end < text_.size() && (is_part_of_name(text_[end]) || text_[end] == '.')) return false;
    return symbol(wanted);
  }

  void constant(Value value) {
    result_.steps_.push_back({Operation::constant, result_.constants_.size()});
    result_.constants_.push_back(std::move(value));
  }
  void add(Operation operation) { result_.steps_.push_back({operation, 0}); }

  void fail(const std::string& expected) {
    if (!wrong_.empty()) return;
    wrong_ = fmt::format("'{}' is no expression: {} is missing at character {}",
                         printable(text_, 80), expected, at_ + 1);
  }

  /// How deep the parser has called itself.
  class Depth {
   public:
    explicit Depth(ExpressionParser& parser) : parser_(parser) {
      if (++parser_.depth_ > deepest)
        parser_.fail("a simpler form (parentheses are too deep), which");
    }
    ~Depth() { --parser_.depth_; }
    Depth(const Depth&) = delete;
    Depth& operator=(const Depth&) = delete;
    bool fits() const { return parser_.wrong_.empty(); }

   private:
    ExpressionParser& parser_;
  };

  const std::string& text_;
  std::size_t at_ = 0;
  int depth_ = 0;
  std::string wrong_;
  Expression result_;
};

Result<Expression> Expression::parse(const std::string& text) {
  return ExpressionParser(text).parse();
}

Value Expression::apply(Operation operation, const Value& a, const Value& b) {
  switch (operation) {
    case Operation::logical_and:
      return connect(a, b, false);
    case Operation::logical_or:
      return connect(a, b, true);
    case Operation::equal:
      return a == b;
    case Operation::unequal:
      return a != b;
    case Operation::less:
    case Operation::at_most: {
      const auto sign = order(a, b);
      if (!sign) return {};
      return *sign < (operation == Operation::less ? 0 : 1);
    }
    default:
      break;
  }
  const double *left = std::get_if<double>(&a), *right = std::get_if<double>(&b);
  if (left == nullptr || right == nullptr) return {};
  switch (operation) {
    case Operation::add:
      return finite(*left + *right);
    case Operation::subtract:
      return finite(*left - *right);
    case Operation::multiply:
      return finite(*left * *right);
    case Operation::divide:
      return *right == 0 ? Value() : finite(*left / *right);
    case Operation::minimum:
      return std::min(*left, *right);
    case Operation::maximum:
      return std::max(*left, *right);
    default:
      return {};
  }
}

Value Expression::evaluate(const Lookup& lookup) const {
  std::vector<Value> stack;
  const auto unary = [&stack](auto function) {
    Value& value = stack.back();
    const double* number = std::get_if<double>(&value);
    value = number != nullptr ? function(*number) : Value();
  };
  for (const Step& step : steps_) {
    switch (step.operation) {
      case Operation::constant:
        stack.push_back(constants_[step.number]);
        break;
      case Operation::name:
        stack.push_back(lookup(names_[step.number]));
        break;
      case Operation::logical_not: {
        const auto truth = truth_of(stack.back());
        stack.back() = truth ? Value(!*truth) : Value();
        break;
      }
      case Operation::negate:
        unary([](double x) { return Value(-x); });
        break;
      case Operation::absolute:
        unary([](double x) { return Value(std::fabs(x)); });
        break;
      case Operation::square_root:
        unary([](double x) { return x < 0 ? Value() : Value(std::sqrt(x)); });
        break;
      case Operation::logarithm:
        unary([](double x) { return x <= 0 ? Value() : Value(std::log10(x)); });
        break;
      default: {
        const Value right = std::move(stack.back());
        stack.pop_back();
        stack.back() = apply(step.operation, stack.back(), right);
      }
    }
  }
  return stack.back();
}

}  // namespace capsoc::campaign
