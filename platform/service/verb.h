// How a method of the protocol is declared: once, next to what it does. From the declarations come
// the checks of every request, the schema and the reference page (docs/reference/protocol.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "service/message.h"

namespace capsoc::service {

/// What a parameter looks like in JSON.
enum class Type {
  integer,  ///< a whole number from 0 to 2^53
  number,   ///< any finite number
  text,
  boolean,
  object,
  list,     ///< of texts
  array,    ///< {"frame", "type", "shape"}, or a list of numbers
  bytes,    ///< an array of bytes, or a text: its UTF-8
  address,  ///< a number below 2^32, or the name of a symbol
  any,
};

/// Its name in the schema.
const char* name_of(Type type);

struct Parameter {
  std::string name;
  Type type;
  bool required;
  std::string text;  ///< for the reference: meaning and unit
};

inline Parameter need(std::string name, Type type, std::string text) {
  return {std::move(name), type, true, std::move(text)};
}
inline Parameter may(std::string name, Type type, std::string text) {
  return {std::move(name), type, false, std::move(text)};
}

/// A member of a result.
struct Member {
  std::string name, type, text;
};

struct Declaration {
  std::string method, text;
  std::vector<Parameter> parameters;  ///< without `simulation`
  std::vector<Member> result;
};

/// What a request comes to.
struct Answer {
  Json result = Json::object();
  Frames frames = {};
  Code code = {};
  std::string sentence = {};  ///< of an error; empty: there is none

  bool ok() const { return sentence.empty(); }
  /// Puts values next to the others as an array of 64-bit floating-point numbers.
  void add_array(const std::string& name, const std::vector<double>& values) {
    add_array(result, name, values);
  }
  void add_array(Json& object, const std::string& name, const std::vector<double>& values);
  void add_bytes(const std::string& name, std::string bytes) {
    add_bytes(result, name, std::move(bytes));
  }
  void add_bytes(Json& object, const std::string& name, std::string bytes);
};

/// An array that a message carries, as Type::array and Type::bytes have it.
std::vector<double> numbers_in(const Json& value, const Frames& frames);
std::string bytes_in(const Json& value, const Frames& frames);

Answer refuse(std::string sentence, Code code = Code::refused);

/// An answer as a message, in addition to what its `body` has.
std::string to_bytes(Json body, Answer answer);
/// As a client gets it.
std::string to_client(const Json& id, Answer answer);

/// The parameters of one request, checked against their declaration.
class Call {
 public:
  Call(const Declaration& declaration, const Json& parameters, const Frames& frames)
      : declaration_(declaration), parameters_(parameters), frames_(frames) {}

  /// Why the parameters are none of this method, "" if they are. Everything below may be asked only
  /// after it.
  std::string complaint() const;

  bool has(const char* name) const { return parameters_.contains(name); }
  uint64_t integer(const char* name) const { return parameters_.at(name).get<uint64_t>(); }
  double number(const char* name) const { return parameters_.at(name).get<double>(); }
  std::string text(const char* name) const { return parameters_.at(name).get<std::string>(); }
  bool boolean(const char* name) const { return parameters_.at(name).get<bool>(); }
  const Json& json(const char* name) const { return parameters_.at(name); }
  std::vector<std::string> texts(const char* name) const;
  std::vector<double> array(const char* name) const {
    return numbers_in(parameters_.at(name), frames_);
  }
  std::string bytes(const char* name) const { return bytes_in(parameters_.at(name), frames_); }

 private:
  std::string complaint_about(const Parameter& parameter) const;
  const Declaration& declaration_;
  const Json& parameters_;
  const Frames& frames_;
};

/// A declaration as the schema has it.
Json schema_of(const Declaration& declaration, bool of_simulation);

}  // namespace capsoc::service
