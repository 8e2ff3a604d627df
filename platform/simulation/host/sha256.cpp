#include "host/sha256.h"

#define OPENSSL_SUPPRESS_DEPRECATED
#include <fmt/format.h>
#include <openssl/evp.h>
#include <openssl/sha.h>

#include <fstream>

#include "base/archive.h"

namespace capsoc::host {

// The library's newer interface cannot save the state of a stream.
struct Sha256::Context {
  SHA256_CTX state{};
};

Sha256::Sha256() : context_(std::make_unique<Context>()) {
  SHA256_Init(&context_->state);
}

Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&& other) noexcept = default;

void Sha256::update(const void* data, std::size_t size) {
  SHA256_Update(&context_->state, data, size);
}

std::string Sha256::hex() const {
  SHA256_CTX copy = context_->state;
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256_Final(digest, &copy);
  std::string text;
  for (const unsigned char byte : digest) text += fmt::format("{:02x}", byte);
  return text;
}

void Sha256::visit(Archive& archive) {
  SHA256_CTX& state = context_->state;
  archive("h", state.h);
  archive("bits_low", state.Nl);
  archive("bits_high", state.Nh);
  archive("data", state.data);
  archive.at_most("filled", state.num, SHA_LBLOCK * 4u - 1);
}

std::string sha256_of(std::string_view bytes) {
  Sha256 digest;
  digest.update(bytes.data(), bytes.size());
  return digest.hex();
}

std::string base64_sha256_of(std::string_view bytes) {
  // Not SHA256(): at its first call it reads the library's configuration, a millisecond.
  SHA256_CTX state{};
  SHA256_Init(&state);
  SHA256_Update(&state, bytes.data(), bytes.size());
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256_Final(digest, &state);
  constexpr std::size_t characters = (SHA256_DIGEST_LENGTH + 2) / 3 * 4;
  unsigned char text[characters + 1];
  EVP_EncodeBlock(text, digest, SHA256_DIGEST_LENGTH);
  return {reinterpret_cast<const char*>(text), characters};
}

std::string sha256_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return "";
  Sha256 digest;
  char buffer[16384];  // few new pages of the stack
  while (file.read(buffer, sizeof buffer) || file.gcount() > 0)
    digest.update(buffer, static_cast<std::size_t>(file.gcount()));
  return digest.hex();
}

}  // namespace capsoc::host
