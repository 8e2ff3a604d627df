// A value, or one sentence that says what is wrong and what to do.
#pragma once

#include <string>
#include <utility>
#include <variant>

namespace capsoc {

/// The reason why there is no value: one sentence for the user, with file and line where there is
/// one.
struct Error {
  std::string text;
};

/// Either a T or an Error; nothing is thrown for what a user, a file or a guest got wrong.
template <class T>
class Result {
 public:
  Result(T value) : content_(std::move(value)) {}
  Result(Error error) : content_(std::move(error)) {}

  explicit operator bool() const { return std::holds_alternative<T>(content_); }
  T& value() { return std::get<T>(content_); }
  const T& value() const { return std::get<T>(content_); }
  const std::string& error() const { return std::get<Error>(content_).text; }

 private:
  std::variant<T, Error> content_;
};

}  // namespace capsoc
