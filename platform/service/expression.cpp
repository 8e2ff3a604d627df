#include "service/expression.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "base/printable.h"

namespace capsoc::service {

/// A number, a name, or an operator with one or two operands.
struct Expression::Node {
  enum class Kind { number, name, unary, binary } kind;
  double number = 0;
  std::string name;  ///< or the operator
  std::shared_ptr<const Node> left, right;
};

namespace {

using Node = Expression::Node;
using NodePointer = std::shared_ptr<const Node>;

constexpr std::size_t longest = 4096, deepest = 200;

/// Binary operators by precedence, the loosest first; those of one line bind alike.
const std::vector<std::vector<std::string>>& levels() {
  static const std::vector<std::vector<std::string>> all = {
      {"or"},       {"and"},    {"==", "!=", "<=", ">=", "<", ">"},
      {"|"},        {"^"},      {"&"},
      {"<<", ">>"}, {"+", "-"}, {"*", "/", "%"}};
  return all;
}

class Parser {
 public:
  explicit Parser(const std::string& text) : text_(text) {}

  Result<NodePointer> parse() {
    NodePointer root = binary(0);
    skip_spaces();
    if (problem_.empty() && at_ < text_.size()) complain("an operator is missing");
    if (!problem_.empty())
      return Error{fmt::format("expression '{}': {} at character {}", printable(text_, 120),
                               problem_, at_ + 1)};
    return root;
  }

 private:
  void complain(const char* what) {
    if (problem_.empty()) problem_ = what;
  }
  void skip_spaces() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  static bool is_word(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  }

  bool take(const std::string& symbol) {
    skip_spaces();
    if (text_.compare(at_, symbol.size(), symbol) != 0) return false;
    const std::size_t end = at_ + symbol.size();
    const char behind = end < text_.size() ? text_[end] : ' ';
    if (is_word(symbol.back()) && is_word(behind)) return false;
    // < is not the beginning of << or <=.
    if ((symbol == "<" || symbol == ">") && (behind == symbol[0] || behind == '=')) return false;
    at_ = end;
    return true;
  }

  NodePointer binary(std::size_t level) {
    if (level == levels().size()) return unary();
    NodePointer left = binary(level + 1);
    for (;;) {
      const std::string* taken = nullptr;
      for (const std::string& symbol : levels()[level])
        if (taken == nullptr && take(symbol)) taken = &symbol;
      if (taken == nullptr || !problem_.empty()) return left;
      left = std::make_shared<Node>(Node{Node::Kind::binary, 0, *taken, left, binary(level + 1)});
    }
  }

  NodePointer unary() {
    if (++depth_ > deepest) complain("too many parts within one another");
    NodePointer node;
    for (const char* symbol : {"not", "-", "~"}) {
      if (!problem_.empty() || !take(symbol)) continue;
      // Python's `not` binds more loosely than comparisons.
      node = std::make_shared<Node>(
          Node{Node::Kind::unary, 0, symbol, *symbol == 'n' ? binary(2) : unary(), nullptr});
      --depth_;
      return node;
    }
    node = primary();
    --depth_;
    return node;
  }

  NodePointer primary() {
    if (!problem_.empty()) return nullptr;
    if (take("(")) {
      NodePointer inside = binary(0);
      if (!take(")")) complain("a ) is missing");
      return inside;
    }
    skip_spaces();
    if (at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])) != 0)
      return number();
    return name();
  }

  NodePointer number() {
    const char *begin = text_.data() + at_, *end = text_.data() + text_.size();
    Node node{Node::Kind::number, 0, "", nullptr, nullptr};
    const char* last = nullptr;
    if (text_.compare(at_, 2, "0x") == 0) {
      uint64_t whole = 0;
      last = std::from_chars(begin + 2, end, whole, 16).ptr;
      if (last == begin + 2) complain("a number is missing");
      node.number = static_cast<double>(whole);
    } else {
      last = std::from_chars(begin, end, node.number).ptr;
    }
    at_ += static_cast<std::size_t>(last - begin);
    if (at_ < text_.size() && is_word(text_[at_])) complain("this is no number");
    return std::make_shared<Node>(std::move(node));
  }

  /// With its members, elements and arrows.
  NodePointer name() {
    const std::size_t begin = at_;
    if (at_ < text_.size() && text_[at_] == '$') ++at_;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (text_.compare(at_, 2, "->") == 0 || text_.compare(at_, 2, "::") == 0)
        at_ += 2;
      else if (is_word(c) || c == '.' || c == '[' || c == ']')
        ++at_;
      else
        break;
    }
    if (at_ == begin) complain("a number or a name is missing");
    return std::make_shared<Node>(
        Node{Node::Kind::name, 0, text_.substr(begin, at_ - begin), nullptr, nullptr});
  }

  const std::string& text_;
  std::size_t at_ = 0;
  std::size_t depth_ = 0;
  std::string problem_;
};

/// A value as the operators on bits take it.
uint64_t bits(double value) {
  if (!(std::fabs(value) < 0x1p63)) return 0;
  return static_cast<uint64_t>(static_cast<int64_t>(value));
}

double of_bits(uint64_t word) {
  return static_cast<double>(static_cast<int64_t>(word));
}

double of(bool value) {
  return value ? 1 : 0;
}

Result<double> apply(const std::string& symbol, double a, double b) {
  if (symbol == "==") return of(a == b);
  if (symbol == "!=") return of(a != b);
  if (symbol == "<=") return of(a <= b);
  if (symbol == ">=") return of(a >= b);
  if (symbol == "<") return of(a < b);
  if (symbol == ">") return of(a > b);
  if (symbol == "|") return of_bits(bits(a) | bits(b));
  if (symbol == "^") return of_bits(bits(a) ^ bits(b));
  if (symbol == "&") return of_bits(bits(a) & bits(b));
  if (symbol == "<<") return of_bits(bits(b) > 63 ? 0 : bits(a) << bits(b));
  if (symbol == ">>") return of_bits(bits(b) > 63 ? 0 : bits(a) >> bits(b));
  if (symbol == "+") return a + b;
  if (symbol == "-") return a - b;
  if (symbol == "*") return a * b;
  if (b == 0) return Error{"an expression divides by 0"};
  return symbol == "/" ? a / b : std::fmod(a, b);
}

Result<double> evaluate(const Node& node, const Expression::Lookup& lookup) {
  if (node.kind == Node::Kind::number) return node.number;
  if (node.kind == Node::Kind::name) return lookup(node.name);
  auto left = evaluate(*node.left, lookup);
  if (!left) return left;
  if (node.kind == Node::Kind::unary) {
    if (node.name == "not") return of(left.value() == 0);
    return node.name == "-" ? -left.value() : of_bits(~bits(left.value()));
  }
  // What is decided already need not exist.
  if (node.name == "and" && left.value() == 0) return left;
  if (node.name == "or" && left.value() != 0) return left;
  auto right = evaluate(*node.right, lookup);
  if (!right || node.name == "and" || node.name == "or") return right;
  return apply(node.name, left.value(), right.value());
}

}  // namespace

Result<Expression> Expression::parse(const std::string& text) {
  if (text.size() > longest) return Error{"an expression has at most 4096 characters"};
  auto root = Parser(text).parse();
  if (!root) return Error{root.error()};
  return Expression(root.value());
}

Result<double> Expression::value(const Lookup& lookup) const {
  return evaluate(*root_, lookup);
}

}  // namespace capsoc::service
