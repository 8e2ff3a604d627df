#include "golden/trace.h"

#include <cstddef>

#include "host/files.h"
#include "host/sha256.h"

namespace capsoc::golden {
namespace {

constexpr std::size_t largest_input = std::size_t{1} << 30;

}  // namespace

Result<Trace> open_trace(const std::string& path, const std::vector<sensor::KeyValue>& keys) {
  Trace trace;
  const bool piped = path == standard_input;
  trace.name = piped ? "standard input" : path;
  std::string text;
  if (piped) {
    auto read = host::read_standard_input(largest_input);
    if (!read) return Error{read.error()};
    text = std::move(read.value());
  }
  auto source = piped ? sensor::load_text(text, trace.name, keys) : sensor::load(path, keys);
  if (!source) return Error{source.error()};
  trace.source = std::move(source.value());
  const auto own = sensor::built_in(path);
  if (own)
    trace.sha256 = host::sha256_of(*own);
  else
    trace.sha256 = piped ? host::sha256_of(text) : host::sha256_of_file(path);
  return trace;
}

}  // namespace capsoc::golden
