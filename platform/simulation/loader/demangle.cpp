#include "loader/demangle.h"

#define HAVE_DECL_BASENAME 1  // libiberty.h would declare it in another way than string.h
#include <libiberty/demangle.h>

#include <cstdlib>
#include <memory>

#include "base/printable.h"

namespace capsoc::loader {

std::string demangled(const std::string& name) {
  constexpr std::size_t longest = 990;
  const bool may_be = name.size() > 2 && name[0] == '_' && (name[1] == 'Z' || name[1] == 'R');
  if (!may_be) return name;
  struct Free {
    void operator()(char* text) const { std::free(text); }
  };
  const std::unique_ptr<char, Free> text(
      cplus_demangle(name.c_str(), DMGL_AUTO | DMGL_PARAMS | DMGL_ANSI));
  return text == nullptr ? name : printable(text.get(), longest);
}

}  // namespace capsoc::loader
