// Values of C types as JSON, and back.
#pragma once

#include <string>

#include "base/result.h"
#include "service/message.h"
#include "source/variables.h"

namespace capsoc::service {

/// `bytes` has at least the type's size. A structure is an object, an array a list, an array of
/// characters a text up to its first 0, an enumerator its name (a number where it has none), a
/// pointer a number, what is not known a list of bytes. Of a bit-field its value.
Json value_of(const source::Variable& variable, const std::string& bytes);

/// The bytes of a value that is laid over `old`: an object names those members that change, a list
/// begins with the first element. An Error says which part does not fit its type.
Result<std::string> bytes_of(const source::Variable& variable, const Json& value, std::string old);

}  // namespace capsoc::service
