// A table of a TOML file whose keys are all known, read with sentences that name file and line.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "base/toml.h"

namespace capsoc::campaign {

/// The file that is read, and the first thing that is wrong with it.
struct TomlFile {
  std::string name;
  std::optional<Error> error;

  std::string place(const toml::node& node) const {
    return fmt::format("{}:{}", name, node.source().begin.line);
  }
  void fail(const toml::node& node, const std::string& sentence) {
    if (!error) error = Error{fmt::format("{}: {}", place(node), sentence)};
  }
};

/// Key and value.
struct Entry {
  std::string key;
  const toml::node* node;
};

/// Of a table, in the order of the file.
std::vector<Entry> entries_of(const toml::table& table);

/// A scalar as the command line would carry it, nothing for lists, tables, dates and numbers that
/// are not finite.
std::optional<std::string> scalar_text(const toml::node& node);

/// Wrong keys and values become the file's error; reading continues and changes nothing then.
class TomlTable {
 public:
  /// `where`: "[limits]", for sentences. Without `known`, any key is.
  TomlTable(TomlFile& file, const toml::table& table, std::string where,
            const std::vector<std::string_view>& known = {});

  const toml::node* find(std::string_view key) const { return table_.get(key); }
  void number(std::string_view key, double& target, double least, double greatest);
  void whole(std::string_view key, uint64_t& target, uint64_t least, uint64_t greatest);
  void flag(std::string_view key, bool& target);
  void text(std::string_view key, std::string& target);
  /// [a, b]; false without the key or after an error.
  bool pair(std::string_view key, double& a, double& b);
  /// Null without the key or after an error.
  const toml::table* table(std::string_view key);
  void fail(const toml::node& node, std::string_view key, const std::string& wrong);

 private:
  TomlFile& file_;
  const toml::table& table_;
  std::string where_;
};

}  // namespace capsoc::campaign
