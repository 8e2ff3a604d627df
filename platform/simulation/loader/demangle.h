// Names of C++ and Rust as their sources have them.
#pragma once

#include <string>

namespace capsoc::loader {

/// "ns::f(int)" of "_ZN2ns1fEi" (Itanium C++ ABI; Rust's legacy and v0 forms, too), as c++filt
/// prints it; what is no such name stays as it is. A longer result than 990 bytes is cut.
std::string demangled(const std::string& name);

}  // namespace capsoc::loader
