// Settings as typed fields. A setting is declared once, as a member of the part that uses it:
//
//   struct CpuSettings {
//     Settings& all;
//     NumberField quantum_ns{all, setting("cpu.quantum_ns", SettingKind::number, "1000000", "...")
//                                     .in(1, 1e9).by({"--quantum", "NS", "..."})};
//   };
//
// The path gives the key of the TOML file, the variable CAPSOC_CPU_QUANTUM_NS, -C and the line of
// --list-params; by() gives the option. A text is parsed where it is set, and refused there;
// quantum_ns() is the parsed value. A wrong name does not compile.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/settings.h"

namespace capsoc {

/// A declaration. `built_in` is a value as the command line would carry it.
inline Setting setting(std::string path, SettingKind kind, std::string built_in, std::string help,
                       std::vector<std::string> choices = {}) {
  return {std::move(path), kind, std::move(built_in), std::move(help), std::move(choices)};
}

/// What all fields have in common. It stays with the settings that it was declared in.
class SettingField : public SettingParser {
 public:
  SettingField(const SettingField&) = delete;
  SettingField& operator=(const SettingField&) = delete;

  const Setting& about() const { return owner_.all()[number_]; }
  /// As a sentence names it.
  const std::string& name() const { return about().name(); }
  bool is_built_in() const { return about().source == SettingSource::built_in; }
  const std::string& text() const { return about().value; }

 protected:
  SettingField(Settings& owner, Setting declared)
      : owner_(owner), number_(owner.add(std::move(declared), this)) {}
  ~SettingField() = default;

 private:
  const Settings& owner_;
  std::size_t number_;
};

/// Text, a file, a directory or a backend.
class TextField final : public SettingField {
 public:
  TextField(Settings& owner, Setting declared) : SettingField(owner, std::move(declared)) {}
  const std::string& operator()() const { return text(); }
  bool empty() const { return text().empty(); }
  std::optional<std::string> parse(const std::string&, bool) override { return std::nullopt; }
};

class NumberField final : public SettingField {
 public:
  NumberField(Settings& owner, Setting declared);
  double operator()() const { return value_; }
  std::optional<std::string> parse(const std::string& text, bool take) override;

 private:
  double value_ = 0;
};

class IntegerField final : public SettingField {
 public:
  IntegerField(Settings& owner, Setting declared);
  long long operator()() const { return value_; }
  std::optional<std::string> parse(const std::string& text, bool take) override;

 private:
  long long value_ = 0;
};

class FlagField final : public SettingField {
 public:
  FlagField(Settings& owner, Setting declared);
  bool operator()() const { return value_; }
  std::optional<std::string> parse(const std::string& text, bool take) override;

 private:
  bool value_ = false;
};

/// The end of a sentence for a word that is none of a choice's.
std::string no_such_choice(const std::string& text, const std::vector<std::string>& choices);

/// One of some words, each of which stands for a value of T.
template <typename T>
class ChoiceField final : public SettingField {
 public:
  struct Choice {
    const char* word;
    T value;
  };
  ChoiceField(Settings& owner, std::vector<Choice> choices, Setting declared)
      : SettingField(owner, with_words(choices, std::move(declared))),
        choices_(std::move(choices)),
        value_(choices_.front().value) {
    parse(text(), true);
  }

  T operator()() const { return value_; }

  std::optional<std::string> parse(const std::string& text, bool take) override {
    for (const Choice& choice : choices_) {
      if (text != choice.word) continue;
      if (take) value_ = choice.value;
      return std::nullopt;
    }
    return no_such_choice(text, about().choices);
  }

 private:
  static Setting with_words(const std::vector<Choice>& choices, Setting declared) {
    for (const Choice& choice : choices) declared.choices.emplace_back(choice.word);
    return declared;
  }
  std::vector<Choice> choices_;
  T value_;
};

}  // namespace capsoc
