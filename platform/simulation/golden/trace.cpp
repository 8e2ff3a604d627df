#include "golden/trace.h"

#include <cstddef>

#include "host/files.h"
#include "host/sha256.h"

namespace capsoc::golden {
namespace {

constexpr std::size_t largest_input = std::size_t{1} << 30;

/// Of one file its own; of several, that of their hashes in order.
std::string hash_of(const std::string& path) {
  const std::vector<std::string> files = sensor::files_of(path);
  if (files.size() == 1) return host::sha256_of_file(files.front());
  std::string all;
  for (const std::string& file : files) all += host::sha256_of_file(file) + "\n";
  return host::sha256_of(all);
}

}  // namespace

Result<Trace> open_trace(const std::string& path, const std::vector<sensor::KeyValue>& keys,
                         const sensor::RecordingOptions& options) {
  Trace trace;
  const bool piped = path == standard_input;
  trace.name = piped ? "standard input" : path;
  std::string text;
  if (piped) {
    auto read = host::read_standard_input(largest_input);
    if (!read) return Error{read.error()};
    text = std::move(read.value());
  }
  auto source = piped ? sensor::load_text(text, trace.name, keys, options)
                      : sensor::load(path, keys, options);
  if (!source) return Error{source.error()};
  trace.source = std::move(source.value());
  const auto own = sensor::built_in(path);
  if (own)
    trace.sha256 = host::sha256_of(*own);
  else
    trace.sha256 = piped ? host::sha256_of(text) : hash_of(path);
  return trace;
}

std::vector<std::string> warnings_of(const Trace& trace) {
  std::vector<std::string> warnings;
  for (const std::string& sentence : trace.source->description().remarks)
    warnings.push_back(trace.name + ": " + sentence);
  return warnings;
}

}  // namespace capsoc::golden
