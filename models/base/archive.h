// State that can be taken out of a component and put back. A component describes its state once,
// in visit(Archive&); four archives do something with it: StateWriter saves, StateReader loads,
// StateHash hashes, StateComparison names the first difference.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <deque>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace capsoc {

__extension__ typedef __int128 Int128;

/// What visit() talks to. Each value has a name; names, widths and order are the layout, which is
/// saved as a hash with the values: state of another layout is refused, not misread.
///
/// Loading never trusts: what does not fit is refused with a sentence that names the value, and
/// from then on nothing is changed.
class Archive {
 public:
  virtual ~Archive() = default;
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  /// True: values come from outside. Then caches are to be dropped and what is derived made again.
  virtual bool loading() const { return false; }

  /// Whole numbers, bool, enumerations, double, std::string; arrays, vectors, deques and optionals
  /// of what can be visited; structures with visit(Archive&).
  template <typename T>
  void operator()(const char* name, T& value) {
    const Scope scope(*this, name);
    visit_value(value);
  }

  /// As above for a whole number or enumeration that is at most `greatest`; a greater one is
  /// refused.
  template <typename T>
  void at_most(const char* name, T& value, T greatest) {
    const Scope scope(*this, name);
    T loaded = value;
    visit_value(loaded);
    if (!loading()) return;
    if (loaded > greatest) return refuse("has a value that does not exist");
    if (ok()) value = loaded;
  }

  /// As above for a sequence of at most `most` elements.
  template <typename T>
  void sequence(const char* name, T& values, std::size_t most) {
    const Scope scope(*this, name);
    visit_sequence(values, most);
  }

  /// `size` bytes at `bytes`, mostly zero. Pages without anything in them take no room.
  void memory(const char* name, uint8_t* bytes, std::size_t size);

  /// Refuses the archive: a component finds a fault in its values. `sentence` continues where the
  /// value's name ends ("is not known").
  void refuse(const std::string& sentence);
  /// Nothing was refused.
  bool ok() const { return problem_.empty(); }
  /// "status of timer0 is missing": the first refusal, empty without.
  const std::string& problem() const { return problem_; }

  /// The simulated time of the state, in units of the kernel's resolution.
  uint64_t time() const { return time_; }
  void set_time(uint64_t time) { time_ = time; }

  /// Of all names and widths visited so far.
  uint64_t layout() const { return layout_; }

  static constexpr std::size_t longest_sequence = 1u << 20;

 protected:
  Archive() = default;

  /// `size` bytes, little-endian.
  virtual void raw(void* bytes, std::size_t size) = 0;
  /// Where the visit is: "stack.3.address".
  std::string path() const;

 private:
  struct Step {
    const char* name;
    std::size_t index;
  };
  class Scope {
   public:
    Scope(Archive& archive, const char* name, std::size_t index = 0) : archive_(archive) {
      archive_.path_.push_back({name, index});
      if (name != nullptr) archive_.note(name);
    }
    ~Scope() { archive_.path_.pop_back(); }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Archive& archive_;
  };

  void note(const char* name);
  void note_width(std::size_t size);

  template <typename T>
  void visit_number(T& value);
  template <typename T>
  void visit_value(T& value);
  template <typename T>
  void visit_sequence(T& values, std::size_t most);
  void visit_text(std::string& text);

  template <typename T, std::size_t N>
  void visit_value(std::array<T, N>& values) {
    visit_elements(values);
  }
  template <typename T, std::size_t N>
  void visit_value(T (&values)[N]) {
    visit_elements(values);
  }
  template <typename T>
  void visit_value(std::vector<T>& values) {
    visit_sequence(values, longest_sequence);
  }
  template <typename T>
  void visit_value(std::deque<T>& values) {
    visit_sequence(values, longest_sequence);
  }
  template <typename T>
  void visit_value(std::optional<T>& value) {
    bool there = value.has_value();
    visit_number(there);
    if (!ok()) return;
    if (there != value.has_value()) {
      if (there)
        value.emplace(T{});
      else
        value.reset();
    }
    if (there) visit_value(*value);
  }
  template <typename Elements>
  void visit_elements(Elements& values) {
    std::size_t index = 0;
    for (auto& value : values) {
      const Scope scope(*this, nullptr, index++);
      visit_value(value);
    }
  }

  std::vector<Step> path_;
  std::string problem_;
  uint64_t time_ = 0;
  uint64_t layout_ = 0xcbf29ce484222325;  // FNV-1a
};

/// Saves.
class StateWriter final : public Archive {
 public:
  std::string take() { return std::move(bytes_); }

 private:
  void raw(void* bytes, std::size_t size) override {
    bytes_.append(static_cast<const char*>(bytes), size);
  }
  std::string bytes_;
};

/// Loads.
class StateReader final : public Archive {
 public:
  /// `bytes` are read in place.
  explicit StateReader(const std::string& bytes) : bytes_(bytes) {}
  bool loading() const override { return true; }
  /// To be asked after the last value: something is left over.
  bool at_end() const { return next_ == bytes_.size(); }

 private:
  void raw(void* bytes, std::size_t size) override;
  const std::string& bytes_;
  std::size_t next_ = 0;
};

/// Hashes (FNV-1a of 64 bits): for a comparison of two runs, not against an adversary.
class StateHash final : public Archive {
 public:
  uint64_t value() const { return hash_; }

 private:
  void raw(void* bytes, std::size_t size) override;
  uint64_t hash_ = 0xcbf29ce484222325;
};

/// Names the first value that is not as it was saved.
class StateComparison final : public Archive {
 public:
  /// `bytes`, of a StateWriter, are read in place.
  explicit StateComparison(const std::string& bytes) : bytes_(bytes) {}
  /// "pc: 00000104 is 00000108"; empty: all is the same.
  const std::string& difference() const { return difference_; }

 private:
  void raw(void* bytes, std::size_t size) override;
  const std::string& bytes_;
  std::size_t next_ = 0;
  std::string difference_;
};

template <typename T>
void Archive::visit_number(T& value) {
  if constexpr (std::is_enum_v<T>) {
    auto number = static_cast<std::underlying_type_t<T>>(value);
    visit_number(number);
    value = static_cast<T>(number);
  } else if constexpr (std::is_same_v<T, bool>) {
    uint8_t byte = value ? 1 : 0;
    note_width(1);
    raw(&byte, 1);
    if (byte > 1) return refuse("is neither true nor false");
    value = byte != 0;
  } else {
    static_assert(std::is_arithmetic_v<T> || std::is_same_v<T, Int128>);
    note_width(sizeof value);
    raw(&value, sizeof value);
  }
}

template <typename T>
void Archive::visit_value(T& value) {
  if constexpr (std::is_same_v<T, std::string>) {
    visit_text(value);
  } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, Int128>) {
    visit_number(value);
  } else {
    value.visit(*this);
  }
}

template <typename T>
void Archive::visit_sequence(T& values, std::size_t most) {
  uint64_t count = values.size();
  visit_number(count);
  if (!ok()) return;
  if (count > most) return refuse("has more elements than it can have");
  if (count != values.size()) values.resize(count);
  visit_elements(values);
}

}  // namespace capsoc
