// toml++ as all of capsoc uses it: errors as values, and no assertion that a damaged file could
// reach.
//
// toml++ 3.3 asserts inside its parser on some damaged input; with NDEBUG the assertion becomes an
// assumption of the optimiser, which is worse. Its functions are inline, so every source must see
// the same three definitions.
#pragma once

#define TOML_EXCEPTIONS 0
#undef NDEBUG
#define TOML_ASSERT(expression) static_cast<void>(0)
#include <toml++/toml.h>
