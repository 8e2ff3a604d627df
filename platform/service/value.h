// Values of C types as JSON, and back.
#pragma once

#include <string>

#include "base/result.h"
#include "service/message.h"
#include "source/variables.h"

namespace capsoc::service {

/// `bytes` has at least the type's size. In JSON
/// - a structure is an object, an array a list, a pointer a number, a bit-field its value
/// - an array of characters is a text up to its first 0
/// - an enumerator is its name, or a number where it has none
/// - a value of unknown type is a list of bytes
Json value_of(const source::Variable& variable, const std::string& bytes);

/// `old` with the value written over it: an object names the members that change, a list begins
/// with the first element. An Error says which part does not fit its type.
Result<std::string> bytes_of(const source::Variable& variable, const Json& value, std::string old);

}  // namespace capsoc::service
