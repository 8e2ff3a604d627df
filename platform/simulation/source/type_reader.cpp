#include "source/type_reader.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "base/printable.h"

namespace capsoc::source {
namespace {

constexpr unsigned deepest = 64;             // of types within types: damage
constexpr std::size_t most_members = 65536;  // of anything
constexpr std::size_t longest_type_name = 200;
constexpr uint32_t pointer_size = 4;

std::optional<uint64_t> number(Dwarf_Die* entry, unsigned attribute) {
  Dwarf_Attribute found;
  Dwarf_Word value = 0;
  if (dwarf_attr_integrate(entry, attribute, &found) == nullptr) return std::nullopt;
  if (dwarf_formudata(&found, &value) != 0) return std::nullopt;
  return value;
}

uint32_t size_of(Dwarf_Die* entry) {
  return static_cast<uint32_t>(number(entry, DW_AT_byte_size).value_or(0));
}

/// How many elements one dimension has; 0: not known.
uint32_t extent(Dwarf_Die* dimension) {
  if (const auto count = number(dimension, DW_AT_count)) return static_cast<uint32_t>(*count);
  if (const auto last = number(dimension, DW_AT_upper_bound))
    return static_cast<uint32_t>(*last + 1);
  return 0;
}

/// Calls for each child of a kind.
template <typename Call>
void each_child(Dwarf_Die* entry, int tag, const Call& call) {
  Dwarf_Die child;
  if (dwarf_child(entry, &child) != 0) return;
  std::size_t count = 0;
  do {
    if (dwarf_tag(&child) == tag) call(&child);
  } while (++count < most_members && dwarf_siblingof(&child, &child) == 0);
}

}  // namespace

std::string name_of(Dwarf_Die* entry) {
  Dwarf_Attribute found;
  const char* name = dwarf_formstring(dwarf_attr_integrate(entry, DW_AT_name, &found));
  return name == nullptr ? "" : printable(name, longest_type_name);
}

const Type* TypeReader::type_of(Dwarf_Die* entry) {
  Dwarf_Attribute found;
  Dwarf_Die type;
  if (dwarf_formref_die(dwarf_attr_integrate(entry, DW_AT_type, &found), &type) == nullptr)
    return nullptr;
  const auto known = types_.find(dwarf_dieoffset(&type));
  if (known != types_.end()) return known->second.get();
  if (depth_ == deepest) return nullptr;
  ++depth_;
  const Type* const read_type = read(&type);
  --depth_;
  return read_type;
}

/// A type that has another's make-up under its own name.
const Type* TypeReader::named_anew(Dwarf_Die* entry, Type& type, const char* qualifier) {
  if (const Type* const meant = type_of(entry)) type = *meant;
  if (const std::string name = name_of(entry); !name.empty()) type.name = name;
  const std::string prefix = qualifier;
  if (!prefix.empty() && type.name.compare(0, prefix.size(), prefix) != 0)
    type.name = fmt::format("{} {}", qualifier, type.name);
  return &type;
}

const Type* TypeReader::read(Dwarf_Die* entry) {
  Type& type = *(types_[dwarf_dieoffset(entry)] = std::make_unique<Type>());
  type.name = name_of(entry);
  type.size = size_of(entry);
  switch (dwarf_tag(entry)) {
    case DW_TAG_typedef:
      return named_anew(entry, type, "");
    case DW_TAG_const_type:
      return named_anew(entry, type, "const");
    case DW_TAG_volatile_type:
      return named_anew(entry, type, "volatile");
    case DW_TAG_restrict_type:
    case DW_TAG_atomic_type:
      return named_anew(entry, type, "");
    case DW_TAG_base_type:
      read_base(entry, type);
      break;
    case DW_TAG_pointer_type:
    case DW_TAG_reference_type:
      type.kind = Type::Kind::pointer;
      type.size = pointer_size;
      type.target = type_of(entry);
      type.name = (type.target == nullptr ? "void" : type.target->name) + " *";
      break;
    case DW_TAG_enumeration_type:
      read_enumeration(entry, type);
      break;
    case DW_TAG_structure_type:
    case DW_TAG_class_type:
    case DW_TAG_union_type:
      read_structure(entry, type);
      break;
    case DW_TAG_array_type:
      read_array(entry, type);
      break;
    default:
      break;
  }
  return &type;
}

void TypeReader::read_base(Dwarf_Die* entry, Type& type) const {
  const uint64_t encoding = number(entry, DW_AT_encoding).value_or(0);
  type.is_signed = encoding == DW_ATE_signed || encoding == DW_ATE_signed_char;
  if (encoding == DW_ATE_float)
    type.kind = Type::Kind::floating;
  else if (encoding == DW_ATE_boolean)
    type.kind = Type::Kind::boolean;
  else if ((encoding == DW_ATE_signed_char || encoding == DW_ATE_unsigned_char) &&
           type.name == "char")
    type.kind = Type::Kind::character;
  else
    type.kind = Type::Kind::integer;
}

void TypeReader::read_enumeration(Dwarf_Die* entry, Type& type) const {
  type.kind = Type::Kind::enumeration;
  type.name = "enum " + type.name;
  each_child(entry, DW_TAG_enumerator, [&](Dwarf_Die* child) {
    Dwarf_Attribute found;
    Dwarf_Sword value = 0;
    if (dwarf_formsdata(dwarf_attr(child, DW_AT_const_value, &found), &value) != 0) return;
    type.is_signed = type.is_signed || value < 0;
    type.enumerators.emplace_back(name_of(child), value);
  });
}

void TypeReader::read_structure(Dwarf_Die* entry, Type& type) {
  type.kind = Type::Kind::structure;
  const char* kind = dwarf_tag(entry) == DW_TAG_union_type ? "union" : "struct";
  type.name = fmt::format("{} {}", kind, type.name.empty() ? "{...}" : type.name);
  each_child(entry, DW_TAG_member, [&](Dwarf_Die* child) {
    Type::Member member;
    member.name = name_of(child);
    member.type = type_of(child);
    if (member.type == nullptr) return;
    member.offset = static_cast<uint32_t>(number(child, DW_AT_data_member_location).value_or(0));
    member.bits = static_cast<unsigned>(number(child, DW_AT_bit_size).value_or(0));
    if (member.bits > 0) {
      // DWARF 5 counts from the structure's beginning (5.7.6).
      const uint64_t bit = number(child, DW_AT_data_bit_offset).value_or(0) + member.offset * 8ULL;
      member.offset = static_cast<uint32_t>(bit / 8);
      member.bit = static_cast<unsigned>(bit % 8);
    }
    type.members.push_back(std::move(member));
  });
}

void TypeReader::read_array(Dwarf_Die* entry, Type& type) {
  std::vector<uint32_t> extents;
  each_child(entry, DW_TAG_subrange_type,
             [&](Dwarf_Die* child) { extents.push_back(extent(child)); });
  const Type* element = type_of(entry);
  if (element == nullptr || extents.empty()) return;
  std::string dimensions;
  for (std::size_t i = extents.size(); i-- > 0;) {
    dimensions.insert(0, fmt::format("[{}]", extents[i]));
    Type row;
    row.kind = Type::Kind::array;
    row.target = element;
    row.count = extents[i];
    row.size = row.count * element->size;
    row.name = fmt::format("{} {}", type_of(entry)->name, dimensions);
    if (i == 0) {
      type = std::move(row);
      return;
    }
    rows_.push_back(std::make_unique<Type>(std::move(row)));
    element = rows_.back().get();
  }
}

}  // namespace capsoc::source
