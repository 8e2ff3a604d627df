#include "source/debug_information.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "base/printable.h"
#include "loader/demangle.h"
#include "source/elf_copy.h"

namespace capsoc::source {
namespace {

constexpr std::size_t longest_name = 200, longest_mangled = 1000;
/// More of anything than a program of the board's 64 MiB has: damage.
constexpr std::size_t most_units = 1U << 16, most_rows = 1U << 23, most_files = 1U << 16;
constexpr std::size_t longest_path = 4096;  // PATH_MAX

std::string clean(const char* name) {
  return name == nullptr ? "" : printable(name, longest_name);
}

/// A longer one names no file.
std::string path_of(const char* name) {
  const std::string_view text = name == nullptr ? "" : name;
  return text.size() > longest_path ? "" : without_controls(text);
}

std::string for_reports(const std::string& file) {
  return file.rfind("./", 0) == 0 ? file.substr(2) : file;
}

/// Of a unit, or of the skeleton that split debug information leaves in the program.
bool has_code(Dwarf_Die& unit) {
  return dwarf_tag(&unit) == DW_TAG_compile_unit || dwarf_tag(&unit) == DW_TAG_skeleton_unit;
}

std::string why() {
  const char* text = dwarf_errmsg(-1);
  return text != nullptr ? text : "damaged";
}

std::string function_name(Dwarf_Die* die) {
  Dwarf_Attribute attribute;
  const auto text = [&](unsigned kind) {
    return dwarf_formstring(dwarf_attr_integrate(die, kind, &attribute));
  };
  // C++ and Rust: it has the namespaces and the parameters, too.
  if (const char* name = text(DW_AT_linkage_name); name != nullptr) {
    const std::string whole = loader::demangled(printable(name, longest_mangled));
    if (whole != name) return printable(whole, longest_name);
  }
  const char* name = text(DW_AT_name);
  return clean(name != nullptr ? name : text(DW_AT_linkage_name));
}

unsigned number_of(Dwarf_Die* die, unsigned kind) {
  Dwarf_Attribute attribute;
  Dwarf_Word value = 0;
  if (dwarf_formudata(dwarf_attr(die, kind, &attribute), &value) != 0) return 0;
  return static_cast<unsigned>(value);
}

/// Where an inlined function was called.
SourceLine call_of(Dwarf_Die* inlined, Dwarf_Die* unit) {
  SourceLine call;
  call.line = number_of(inlined, DW_AT_call_line);
  Dwarf_Files* files = nullptr;
  std::size_t count = 0;
  const unsigned file = number_of(inlined, DW_AT_call_file);
  if (dwarf_getsrcfiles(unit, &files, &count) == 0 && file < count)
    call.file = for_reports(path_of(dwarf_filesrc(files, file, nullptr, nullptr)));
  return call;
}

bool has_addresses(Dwarf_Die* entry) {
  return dwarf_hasattr(entry, DW_AT_low_pc) != 0 || dwarf_hasattr(entry, DW_AT_ranges) != 0;
}

/// Entries without their own addresses that functions may stand in.
bool is_container(Dwarf_Die* entry) {
  const int tag = dwarf_tag(entry);
  return tag == DW_TAG_namespace || tag == DW_TAG_structure_type || tag == DW_TAG_class_type;
}

/// The entries of a unit around an address, the innermost first, without the unit itself. Not by
/// libdw's dwarf_getscopes(), which recurses as deep as a damaged file nests its entries.
class Scopes {
 public:
  Scopes(Dwarf_Die* unit, uint32_t address) : address_(address) {
    Dwarf_Die entry;
    int status = dwarf_child(unit, &entry);
    unsigned count = 0;
    for (; count < most_entries && (status == 0 || !containers_.empty()); ++count) {
      if (status == 0) {
        status = enter(entry);
      } else {  // after the last one of a container
        entry = containers_.back();
        containers_.pop_back();
        status = dwarf_siblingof(&entry, &entry);
      }
      if (status < 0) damage_ = why();
    }
    if (count == most_entries) damage_ = "they do not end";
    std::reverse(around_.begin(), around_.end());
  }
  /// Why something may be missing; "" if nothing is.
  const std::string& damage() const { return damage_; }
  std::vector<Dwarf_Die>& entries() { return around_; }

 private:
  static constexpr unsigned most_entries = 1U << 20U;
  static constexpr std::size_t deepest = 256;  // far beyond what compilers nest

  /// Moves to the next entry: inside this one, or its sibling.
  int enter(Dwarf_Die& entry) {
    const int found = has_addresses(&entry) ? dwarf_haspc(&entry, address_) : 0;
    if (found < 0) damage_ = why();
    const bool inside = found > 0 && !is_left_out(entry);
    if (!inside && !is_container(&entry)) return dwarf_siblingof(&entry, &entry);
    if (around_.size() + containers_.size() == deepest) {
      damage_ = "they are nested too deep";
      return dwarf_siblingof(&entry, &entry);
    }
    if (inside) containers_.clear();
    (inside ? around_ : containers_).push_back(entry);
    return dwarf_child(&entry, &entry);
  }
  /// It only claims the address.
  static bool is_left_out(Dwarf_Die& entry) {
    Dwarf_Addr first = 0;
    return dwarf_tag(&entry) == DW_TAG_subprogram && dwarf_lowpc(&entry, &first) == 0 && first == 0;
  }

  uint32_t address_;
  std::vector<Dwarf_Die> around_, containers_;
  std::string damage_;
};

}  // namespace

DebugInformation::DebugInformation(std::string name, const std::string& bytes)
    : name_(std::move(name)), copy_(std::make_unique<ElfCopy>(bytes)) {
  if (copy_->dwarf() == nullptr) {
    if (copy_->has_section(".debug_info")) complain("its debug information: " + why());
    return;
  }
  read_units();
  if (copy_->has_section(".debug_frame")) {
    frames_ = dwarf_getcfi(copy_->dwarf());
    if (frames_ == nullptr) complain("its call frames (.debug_frame): " + why());
  }
}

DebugInformation::~DebugInformation() = default;

void DebugInformation::complain(const std::string& what) const {
  constexpr std::size_t most = 8;
  if (complaints_.size() < most) complaints_.insert(fmt::format("{}: cannot read {}", name_, what));
}

void DebugInformation::read_units() {
  Dwarf_Off at = 0, next = 0;
  std::size_t header = 0, count = 0;
  int status = 0;
  while (count++ < most_units && (status = dwarf_nextcu(copy_->dwarf(), at, &next, &header, nullptr,
                                                        nullptr, nullptr)) == 0) {
    Dwarf_Die unit;
    if (dwarf_offdie(copy_->dwarf(), at + header, &unit) == nullptr ||
        dwarf_tag(&unit) == DW_TAG_invalid)
      complain(fmt::format("the unit at {:#x} of .debug_info: {}", at, why()));
    else if (has_code(unit)) {
      read_ranges(unit);
      read_rows(unit);
    }
    if (next <= at) break;
    at = next;
  }
  if (status < 0) complain(fmt::format(".debug_info from {:#x} on: {}", at, why()));
  std::stable_sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) {
    return a.address != b.address ? a.address < b.address : a.end && !b.end;
  });
}

/// Code that the linker left out lies at 0, where a vector table is and no code.
void DebugInformation::read_ranges(Dwarf_Die& unit) {
  constexpr int most_ranges = 1 << 20;
  Dwarf_Addr base = 0, first = 0, behind = 0;
  std::ptrdiff_t at = 0;
  for (int count = 0; count < most_ranges; ++count) {
    at = dwarf_ranges(&unit, at, &base, &first, &behind);
    if (at <= 0) break;
    if (first != 0 && first < behind && behind <= UINT32_MAX)
      units_.push_back(
          {static_cast<uint32_t>(first), static_cast<uint32_t>(behind), dwarf_dieoffset(&unit)});
  }
  if (at < 0) complain(fmt::format("the addresses of {}: {}", function_name(&unit), why()));
}

unsigned DebugInformation::file_index(const char* name, const std::string& folder) {
  std::string text = files_.size() < most_files ? path_of(name) : "";
  const auto [found, added] =
      file_numbers_.try_emplace({folder, text}, static_cast<unsigned>(files_.size()));
  if (added) files_.push_back({std::move(text), folder});
  return found->second;
}

void DebugInformation::read_rows(Dwarf_Die& unit) {
  Dwarf_Lines* lines = nullptr;
  std::size_t count = 0;
  if (dwarf_getsrclines(&unit, &lines, &count) != 0)
    return complain(fmt::format("the lines of {}: {}", function_name(&unit), why()));
  Dwarf_Attribute attribute;
  const std::string folder =
      path_of(dwarf_formstring(dwarf_attr(&unit, DW_AT_comp_dir, &attribute)));
  const char* last_name = nullptr;
  unsigned last_file = 0;
  bool first = true;
  for (std::size_t i = 0; i < count && rows_.size() < most_rows; ++i) {
    Dwarf_Line* const line = dwarf_onesrcline(lines, i);
    Dwarf_Addr address = 0;
    int number = 0;
    bool end = false, statement = false;
    if (line == nullptr || dwarf_lineaddr(line, &address) != 0 ||
        dwarf_lineno(line, &number) != 0 || dwarf_lineendsequence(line, &end) != 0)
      continue;
    dwarf_linebeginstatement(line, &statement);
    if (address == 0 || address >= left_out) continue;
    const char* const name = dwarf_linesrc(line, nullptr, nullptr);
    if (name != last_name || first) last_file = file_index(name, folder);
    last_name = name;
    first = false;
    rows_.push_back({static_cast<uint32_t>(address), last_file,
                     static_cast<unsigned>(std::max(number, 0)), end, statement});
  }
}

const DebugInformation::Row* DebugInformation::row_at(uint32_t address) const {
  auto row = std::upper_bound(rows_.begin(), rows_.end(), address,
                              [](uint32_t a, const Row& r) { return a < r.address; });
  if (row == rows_.begin()) return nullptr;
  --row;
  // Line 0: the compiler names none; what stands before it is next to it.
  while (row != rows_.begin() && !row->end && row->line == 0) --row;
  return row->end || row->line == 0 ? nullptr : &*row;
}

std::optional<SourceLine> DebugInformation::line_at(uint32_t address) const {
  const Row* const row = row_at(address);
  if (row == nullptr) return std::nullopt;
  return SourceLine{for_reports(files_[row->file].name), row->line};
}

const std::vector<Place>& DebugInformation::places_at(uint32_t address) const {
  constexpr std::size_t most_kept = 4096;
  const auto found = places_.find(address);
  if (found != places_.end()) return found->second;
  if (places_.size() == most_kept) places_.clear();
  return places_[address] = search_places(address);
}

std::vector<Place> DebugInformation::search_places(uint32_t address) const {
  std::vector<Place> places;
  const auto unit = std::find_if(units_.begin(), units_.end(), [address](const Unit& u) {
    return address >= u.first && address < u.behind;
  });
  Dwarf_Die entry;
  if (unit == units_.end() || dwarf_offdie(copy_->dwarf(), unit->die, &entry) == nullptr)
    return places;
  Scopes scopes(&entry, address);
  if (!scopes.damage().empty())
    complain(fmt::format("the functions at {:#010x}: {}", address, scopes.damage()));
  std::optional<SourceLine> at = line_at(address);
  for (Dwarf_Die& scope : scopes.entries()) {
    const int tag = dwarf_tag(&scope);
    const bool inlined = tag == DW_TAG_inlined_subroutine;
    if (!inlined && tag != DW_TAG_subprogram) continue;
    places.push_back({function_name(&scope), at.value_or(SourceLine{}), inlined});
    if (!inlined) return places;
    at = call_of(&scope, &entry);
  }
  return {};
}

}  // namespace capsoc::source
