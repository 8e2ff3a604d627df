#include "serial/serial_line.h"

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "base/input_file.h"
#include "serial/file_backend.h"
#include "serial/open_backend.h"

namespace capsoc::serial {
namespace {

constexpr std::chrono::milliseconds look_for_listener{10};

}  // namespace

Result<std::unique_ptr<SerialLine>> SerialLine::open(LineConfig config, const GiveUp& give_up) {
  auto backend = open_backend(config.backend, "--" + config.name, give_up, uart_backend_names);
  if (!backend) return Error{backend.error()};
  std::unique_ptr<SerialLine> line(
      new SerialLine(std::move(config), std::move(backend.value()), give_up));
  if (auto error = line->open_files()) return *error;
  return line;
}

SerialLine::SerialLine(LineConfig config, std::unique_ptr<CharacterBackend> backend, GiveUp give_up)
    : config_(std::move(config)),
      backend_(std::move(backend)),
      give_up_(std::move(give_up)),
      watch_(config_.patterns) {}

std::optional<Error> SerialLine::open_files() {
  if (!config_.input.empty()) {
    const InputLimits any{fmt::format("name a file for {}.input", config_.name), UINT64_MAX, true};
    if (auto error = check_input(config_.input, any)) return error;
    input_.open(config_.input, std::ios::binary);
  }
  if (!config_.log.empty()) {
    auto log = FileBackend::to_file(config_.log, give_up_);
    if (!log) return Error{log.error()};
    log_ = std::move(log.value());
  }
  return std::nullopt;
}

void SerialLine::wait_for_listener() {
  config_.wait = false;
  while (!backend_->has_listener() && !give_up_()) std::this_thread::sleep_for(look_for_listener);
}

void SerialLine::transmitted(uint8_t byte, bool dry) {
  if (config_.wait) wait_for_listener();
  ++bytes_;
  digest_.update(&byte, 1);
  pending_ += static_cast<char>(byte);
  if (byte == '\n' || pending_.size() >= piece) flush();
  if (!config_.patterns.any() || match_) return;
  match_ = watch_.feed(byte, dry);
  if (match_ && on_match_) on_match_();
}

void SerialLine::flush() {
  if (pending_.empty()) return;
  backend_->write(pending_);
  if (log_ != nullptr) log_->write(pending_);
  pending_.clear();
}

bool SerialLine::refill() {
  taken_ = 0;
  if (config_.input.empty()) {
    incoming_ = backend_->read();
  } else {
    incoming_.resize(piece);
    input_.read(incoming_.data(), static_cast<std::streamsize>(incoming_.size()));
    incoming_.resize(static_cast<std::size_t>(input_.gcount()));
  }
  return !incoming_.empty();
}

std::optional<uint8_t> SerialLine::next_input() {
  if (taken_ == incoming_.size() && !refill()) return std::nullopt;
  ++received_;
  return static_cast<uint8_t>(incoming_[taken_++]);
}

void SerialLine::visit(Archive& archive) {
  flush();
  archive("bytes", bytes_);
  archive("digest", digest_);
  archive("watch", watch_);
  archive("received", received_);
  if (!archive.loading() || config_.input.empty()) return;
  incoming_.clear();
  taken_ = 0;
  input_.clear();
  input_.seekg(static_cast<std::streamoff>(received_));
}

void SerialLine::finish() {
  flush();
  if (log_ != nullptr) log_->finish();
  backend_->finish();
}

std::vector<std::string> SerialLine::failures() const {
  std::vector<std::string> sentences;
  for (const CharacterBackend* place : {backend_.get(), log_.get()})
    if (place != nullptr && !place->failure().empty()) sentences.push_back(place->failure());
  return sentences;
}

}  // namespace capsoc::serial
