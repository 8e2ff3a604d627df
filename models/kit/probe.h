#pragma once

#include <functional>
#include <list>
#include <memory>
#include <utility>

namespace capsoc::kit {

/// Registration of a listener with a probe; its destruction ends it. It may outlive the probe.
class [[nodiscard]] Listening {
 public:
  Listening() = default;
  explicit Listening(std::function<void()> end) : end_(std::move(end)) {}
  Listening(Listening&& other) noexcept : end_(std::exchange(other.end_, {})) {}
  Listening& operator=(Listening&& other) noexcept {
    std::swap(end_, other.end_);
    return *this;
  }
  ~Listening() {
    if (end_) end_();
  }

 private:
  std::function<void()> end_;
};

/// Event source inside a part, a public member of the part. Notifies its listeners in the order of
/// their registration. Without a listener it costs one comparison. A listener may end its
/// registration in a call; it must not change the part.
template <typename... Values>
class Probe {
 public:
  using Listener = std::function<void(Values...)>;

  Probe() = default;
  Probe(const Probe&) = delete;
  Probe& operator=(const Probe&) = delete;

  Listening listen(Listener listener) {
    if (shared_ == nullptr) shared_ = std::make_shared<Shared>();
    const auto place = shared_->entries.insert(shared_->entries.end(), {std::move(listener)});
    return Listening([all = std::weak_ptr<Shared>(shared_), place] {
      const auto shared = all.lock();
      if (shared == nullptr) return;
      place->ended = true;
      shared->tidy();
    });
  }
  bool watched() const { return shared_ != nullptr && !shared_->entries.empty(); }

  void operator()(Values... values) const {
    if (!watched()) return;
    const std::shared_ptr<Shared> shared = shared_;
    ++shared->calls;
    for (const Entry& entry : shared->entries)
      if (!entry.ended) entry.listener(values...);
    --shared->calls;
    shared->tidy();
  }

 private:
  struct Entry {
    Listener listener;
    bool ended = false;
  };
  struct Shared {
    std::list<Entry> entries;
    unsigned calls = 0;  // under way

    /// A listener is not destroyed while it may be running.
    void tidy() {
      if (calls == 0) entries.remove_if([](const Entry& entry) { return entry.ended; });
    }
  };
  std::shared_ptr<Shared> shared_;
};

}  // namespace capsoc::kit
