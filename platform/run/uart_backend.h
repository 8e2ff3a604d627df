// Where the bytes of a UART go: standard output, a file, or nowhere. Counts and checksums them on
// the way.
#pragma once

#include <openssl/evp.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "support/result.h"

namespace capsoc::run {

/// SHA-256 of a stream.
class Sha256 {
 public:
  Sha256();
  void update(const void* data, std::size_t size);
  /// Lower-case hexadecimal digest of everything so far; the stream may go on.
  std::string hex() const;

 private:
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

/// SHA-256 of a file's bytes, "" if it cannot be read.
std::string sha256_of_file(const std::string& path);

/// The host's side of a transmitter.
class UartBackend {
 public:
  /// `spec`: stdio, null or file:PATH.
  static Result<std::unique_ptr<UartBackend>> open(const std::string& spec);
  ~UartBackend();

  void put(uint8_t byte);
  void flush();

  uint64_t bytes() const { return bytes_; }
  std::string sha256() const { return digest_.hex(); }
  /// False once the host refused bytes (disk full, pipe closed).
  bool healthy() const { return healthy_; }

 private:
  UartBackend(std::FILE* stream, bool owned) : stream_(stream), owned_(owned) {}

  std::FILE* stream_;
  bool owned_;
  bool healthy_ = true;
  uint64_t bytes_ = 0;
  Sha256 digest_;
};

}  // namespace capsoc::run
