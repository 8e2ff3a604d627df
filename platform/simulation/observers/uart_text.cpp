#include "observers/uart_text.h"

namespace capsoc::run {

void UartText::listen(cmsdk::Uart& uart) {
  listening_ = uart.transmitted.listen([this](uint8_t byte) {
    ++bytes_;
    const auto c = static_cast<char>(byte);
    if (begin_.size() < part) {
      begin_ += c;
    } else if (end_.size() < part) {
      end_ += c;
    } else {
      end_[next_] = c;
      next_ = (next_ + 1) % part;
    }
  });
}

void UartText::visit(Archive& archive) {
  archive("begin", begin_);
  archive("end", end_);
  archive("next", next_);
  archive("bytes", bytes_);
  if (archive.loading() && next_ > end_.size()) archive.refuse("has its oldest byte outside");
}

std::string UartText::text() const {
  return begin_ + end_.substr(next_) + end_.substr(0, next_);
}

uint64_t UartText::left_out() const {
  return bytes_ - begin_.size() - end_.size();
}

}  // namespace capsoc::run
