#include "source/variables.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <tuple>

#include "base/nearest.h"
#include "base/printable.h"
#include "source/elf_copy.h"
#include "source/type_reader.h"

namespace capsoc::source {
namespace {

constexpr std::size_t most_searched_units = 1U << 16, most_entries = 1U << 22;
constexpr int deepest_scope = 32;

/// The fixed address of a variable (DW_OP_addr); nothing for one on a stack or in a register.
std::optional<uint32_t> fixed_address(Dwarf_Die* entry) {
  Dwarf_Attribute location;
  if (dwarf_attr(entry, DW_AT_location, &location) == nullptr) return std::nullopt;
  Dwarf_Op* operations = nullptr;
  std::size_t count = 0;
  if (dwarf_getlocation(&location, &operations, &count) != 0 || count != 1) return std::nullopt;
  if (operations[0].atom != DW_OP_addr) return std::nullopt;
  return static_cast<uint32_t>(operations[0].number);
}

std::string file_name(const std::string& path) {
  return path.substr(path.find_last_of('/') + 1);
}

bool is_part_of_name(char c) {
  return c == '_' || c == '$' || c == ':' || c == '.' || (c >= '0' && c <= '9') ||
         (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// The end of the variable's name at the beginning of a path. A dot belongs to it in front of "::"
/// (main.c::count).
std::size_t end_of_name(std::string_view path) {
  const std::size_t file = path.find("::");
  std::size_t end = file == std::string_view::npos ? 0 : file + 2;
  while (end < path.size() && path[end] != '.' && is_part_of_name(path[end])) ++end;
  return end;
}

}  // namespace

/// The variables of one image.
class Variables::Reader {
 public:
  explicit Reader(const loader::ElfImage& image) : image_(image), copy_(*image.file) {}

  void read(std::multimap<std::string, Known>& variables) {
    if (copy_.dwarf() == nullptr) return;
    Dwarf_CU* unit = nullptr;
    for (std::size_t units = 0; units < most_searched_units; ++units) {
      Dwarf_Die entry;
      if (dwarf_get_units(copy_.dwarf(), unit, &unit, nullptr, nullptr, &entry, nullptr) != 0)
        return;
      file_ = file_name(name_of(&entry));
      read_scope(&entry, "", 0, variables);
    }
  }

 private:
  /// What the linker left out is described as if it lay at 0.
  bool is_linked(Dwarf_Die* entry, uint32_t address) const {
    const loader::Symbol* const symbol = image_.symbol_at(address);
    if (symbol == nullptr || symbol->is_code) return false;
    // C: "turns", or "turns.3" of a function; C++: mangled, with the name in it.
    return symbol->name.find(name_of(entry)) != std::string::npos;
  }

  void read_scope(Dwarf_Die* scope, const std::string& prefix, int depth,
                  std::multimap<std::string, Known>& variables) {
    Dwarf_Die child;
    if (depth == deepest_scope || dwarf_child(scope, &child) != 0) return;
    do {
      if (++entries_ > most_entries) return;
      switch (dwarf_tag(&child)) {
        case DW_TAG_variable:
          if (const auto address = fixed_address(&child); address && is_linked(&child, *address))
            if (const Type* const type = types_.type_of(&child)) {
              const std::string name = prefix + name_of(&child);
              variables.emplace(name, Known{file_, {name, *address, type}});
            }
          break;
        case DW_TAG_namespace:
        case DW_TAG_subprogram:
          read_scope(&child, prefix + name_of(&child) + "::", depth + 1, variables);
          break;
        case DW_TAG_lexical_block:
          read_scope(&child, prefix, depth + 1, variables);
          break;
        default:
          break;
      }
    } while (dwarf_siblingof(&child, &child) == 0);
  }

  const loader::ElfImage& image_;
  ElfCopy copy_;
  TypeReader types_;
  std::string file_;
  std::size_t entries_ = 0;
};

Variables::Variables(std::vector<const loader::ElfImage*> images) : images_(std::move(images)) {}

Variables::~Variables() = default;

void Variables::read() const {
  if (is_read_) return;
  is_read_ = true;
  for (const loader::ElfImage* image : images_) {
    if (image->file == nullptr) continue;
    readers_.push_back(std::make_unique<Reader>(*image));
    readers_.back()->read(variables_);
  }
}

const Type* Variables::plain(uint32_t size) const {
  std::unique_ptr<Type>& type = plain_[size];
  if (type == nullptr) {
    type = std::make_unique<Type>();
    type->size = size;
    const bool is_word = size == 1 || size == 2 || size == 4 || size == 8;
    type->kind = is_word ? Type::Kind::integer : Type::Kind::opaque;
    type->name = is_word ? fmt::format("uint{}_t", size * 8) : fmt::format("{} bytes", size);
  }
  return type.get();
}

/// Where there is no debug information there are sizes.
std::optional<Variable> Variables::symbol(const std::string& name) const {
  for (const loader::ElfImage* image : images_)
    for (const loader::Symbol& symbol : image->symbols)
      if (symbol.name == name && !symbol.is_code && symbol.size > 0)
        return Variable{name, symbol.address, plain(symbol.size)};
  return std::nullopt;
}

Result<Variable> Variables::named(const std::string& name) const {
  read();
  const std::size_t scope = name.find("::");
  auto [first, last] = variables_.equal_range(name);
  std::string file;
  if (first == last && scope != std::string::npos) {
    file = name.substr(0, scope);
    std::tie(first, last) = variables_.equal_range(name.substr(scope + 2));
  }
  std::vector<const Known*> found;
  for (auto at = first; at != last; ++at) {
    const Known& known = at->second;
    if (!file.empty() && known.file != file) continue;
    const bool again = std::any_of(found.begin(), found.end(), [&](const Known* other) {
      return other->variable.address == known.variable.address;
    });
    if (!again) found.push_back(&known);
  }
  if (found.size() == 1) return found.front()->variable;
  if (found.empty()) {
    if (auto variable = symbol(name)) return *variable;
    std::vector<std::string> names;
    for (const auto& [known, variable] : variables_) names.push_back(known);
    if (names.empty())
      return Error{
          fmt::format("there is no variable '{}': the program has no debug information "
                      "(compile it with -g)",
                      printable(name, 80))};
    return Error{fmt::format("there is no variable '{}'; did you mean {}?", printable(name, 80),
                             nearest_names(printable(name, 80), names))};
  }
  std::string choices;
  for (const Known* known : found)
    choices +=
        fmt::format("{}{}::{}", choices.empty() ? "" : " or ", known->file, known->variable.name);
  return Error{fmt::format("there are {} variables '{}'; say {}", found.size(), name, choices)};
}

namespace {

/// Takes a path from a variable on, step by step.
class Walk {
 public:
  Walk(Variable start, const ReadPointer& read) : at_(std::move(start)), read_(read) {}

  std::optional<Error> follow(std::string_view path) {
    while (!path.empty()) {
      std::optional<Error> error;
      if (path.front() == '[')
        error = take_index(path);
      else if (path.front() == '.')
        error = take_member(path, 1);
      else if (path.substr(0, 2) == "->")
        error = take_arrow(path);
      else
        error =
            Error{fmt::format("'{}' cannot follow {}", printable(std::string(path), 80), at_.name)};
      if (error) return error;
    }
    return std::nullopt;
  }
  std::optional<Error> dereference() {
    const Type& type = *at_.type;
    if (type.kind != Type::Kind::pointer || type.target == nullptr)
      return Error{fmt::format("{} is no pointer to something, but {}", at_.name, type.name)};
    const auto address = read_(at_.address);
    if (!address) return Error{fmt::format("{} cannot be read", at_.name)};
    at_ = {"*" + at_.name, *address, type.target};
    return std::nullopt;
  }
  Variable&& take() { return std::move(at_); }

 private:
  std::optional<Error> take_arrow(std::string_view& path) {
    if (auto error = dereference()) return error;
    return take_member(path, 2);
  }

  std::optional<Error> take_member(std::string_view& path, std::size_t skip) {
    std::size_t end = skip;
    while (end < path.size() && path[end] != '.' && is_part_of_name(path[end])) ++end;
    const std::string name(path.substr(skip, end - skip));
    std::vector<std::string> names;
    for (const Type::Member& member : at_.type->members) {
      names.push_back(member.name);
      if (member.name != name) continue;
      at_ = {at_.name + "." + name, at_.address + member.offset, member.type, member.bits,
             member.bit};
      path.remove_prefix(end);
      return std::nullopt;
    }
    if (names.empty())
      return Error{fmt::format("{} has no members; it is {}", at_.name, at_.type->name)};
    return Error{fmt::format("{} has no member '{}'; did you mean {}?", at_.name,
                             printable(name, 80), nearest_names(printable(name, 80), names))};
  }

  std::optional<Error> take_index(std::string_view& path) {
    uint32_t index = 0;
    const char* const end = path.data() + path.size();
    const auto [last, error] = std::from_chars(path.data() + 1, end, index);
    if (error != std::errc() || last == end || *last != ']')
      return Error{fmt::format("'{}': write an index as [3]", printable(std::string(path), 80))};
    if (at_.type->kind == Type::Kind::pointer) {
      if (auto wrong = dereference()) return wrong;
      at_.address += index * at_.type->size;
    } else if (at_.type->kind != Type::Kind::array) {
      return Error{fmt::format("{} is no array, but {}", at_.name, at_.type->name)};
    } else if (index >= at_.type->count) {
      return Error{fmt::format("{} has {} elements; the first is [0]", at_.name, at_.type->count)};
    } else {
      at_ = {at_.name, at_.address + index * at_.type->target->size, at_.type->target};
    }
    at_.name += fmt::format("[{}]", index);
    path.remove_prefix(static_cast<std::size_t>(last + 1 - path.data()));
    return std::nullopt;
  }

  Variable at_;
  const ReadPointer& read_;
};

}  // namespace

Result<Variable> Variables::find(const std::string& path, const ReadPointer& read) const {
  std::string_view rest = path;
  unsigned stars = 0;
  for (; !rest.empty() && rest.front() == '*'; ++stars) rest.remove_prefix(1);
  const std::size_t end = end_of_name(rest);
  if (end == 0)
    return Error{
        fmt::format("'{}' does not begin with the name of a variable; write state.turns, "
                    "table[3] or *pointer",
                    printable(path, 80))};
  auto start = named(std::string(rest.substr(0, end)));
  if (!start) return start;
  Walk walk(std::move(start.value()), read);
  if (auto error = walk.follow(rest.substr(end))) return *error;
  for (; stars > 0; --stars)
    if (auto error = walk.dereference()) return *error;
  return walk.take();
}

std::vector<Variable> Variables::all() const {
  read();
  std::vector<Variable> variables;
  for (const auto& [name, known] : variables_) variables.push_back(known.variable);
  return variables;
}

}  // namespace capsoc::source
