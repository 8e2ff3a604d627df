// SHA-256 of what a run reads and prints.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace capsoc {
class Archive;
}

namespace capsoc::host {

/// SHA-256 of a stream.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&& other) noexcept;
  void update(const void* data, std::size_t size);
  /// Lower-case hexadecimal digest of everything so far; the stream may continue.
  std::string hex() const;

  /// Where the stream is; a loaded one continues there.
  void visit(Archive& archive);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

/// SHA-256 of some bytes.
std::string sha256_of(std::string_view bytes);

/// The same in base 64, as a browser's content security policy has it.
std::string base64_sha256_of(std::string_view bytes);

/// SHA-256 of a file's bytes, "" if it cannot be read.
std::string sha256_of_file(const std::string& path);

}  // namespace capsoc::host
