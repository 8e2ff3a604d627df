#include "run/uart_backend.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

namespace capsoc::run {

Sha256::Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
  EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr);
}

void Sha256::update(const void* data, std::size_t size) {
  EVP_DigestUpdate(context_.get(), data, size);
}

std::string Sha256::hex() const {
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> copy(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  EVP_MD_CTX_copy_ex(copy.get(), context_.get());
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  EVP_DigestFinal_ex(copy.get(), digest, &size);
  std::string text;
  for (unsigned i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

std::string sha256_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return "";
  Sha256 digest;
  char buffer[65536];
  while (file.read(buffer, sizeof buffer) || file.gcount() > 0)
    digest.update(buffer, static_cast<std::size_t>(file.gcount()));
  return digest.hex();
}

Result<std::unique_ptr<UartBackend>> UartBackend::open(const std::string& spec) {
  if (spec == "stdio") return std::unique_ptr<UartBackend>(new UartBackend(stdout, false));
  if (spec == "null") return std::unique_ptr<UartBackend>(new UartBackend(nullptr, false));
  if (spec.rfind("file:", 0) != 0 || spec.size() == 5)
    return Error{fmt::format("--uart0 {}: choose stdio, null or file:PATH", spec)};
  std::FILE* stream = std::fopen(spec.c_str() + 5, "wb");
  if (stream == nullptr)
    return Error{fmt::format("{}: cannot be written ({}); name another file for --uart0",
                             spec.substr(5), std::strerror(errno))};
  return std::unique_ptr<UartBackend>(new UartBackend(stream, true));
}

UartBackend::~UartBackend() {
  if (owned_) std::fclose(stream_);
}

void UartBackend::put(uint8_t byte) {
  ++bytes_;
  digest_.update(&byte, 1);
  if (stream_ == nullptr || !healthy_) return;
  if (std::fputc(byte, stream_) == EOF) healthy_ = false;
  if (byte == '\n' && std::fflush(stream_) != 0) healthy_ = false;
}

void UartBackend::flush() {
  if (stream_ != nullptr && std::fflush(stream_) != 0) healthy_ = false;
}

}  // namespace capsoc::run
