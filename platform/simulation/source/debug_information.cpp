#include "source/debug_information.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "source/elf_copy.h"
#include "support/printable.h"

namespace capsoc::source {
namespace {

constexpr std::size_t longest_name = 200;
/// More of anything than a program of the board's 64 MiB has: damage.
constexpr std::size_t most_units = 1U << 16, most_rows = 1U << 23;

std::string clean(const char* name) {
  if (name == nullptr) return "";
  std::string text = printable(name, longest_name);
  return text.rfind("./", 0) == 0 ? text.substr(2) : text;
}

std::string why() {
  const char* text = dwarf_errmsg(-1);
  return text != nullptr ? text : "damaged";
}

std::string function_name(Dwarf_Die* die) {
  Dwarf_Attribute attribute;
  for (const unsigned kind : {DW_AT_name, DW_AT_linkage_name})
    if (const char* name = dwarf_formstring(dwarf_attr_integrate(die, kind, &attribute));
        name != nullptr)
      return clean(name);
  return "";
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
    call.file = clean(dwarf_filesrc(files, file, nullptr, nullptr));
  return call;
}

/// The entries around an address, the innermost first. Behind an inlined function dwarf_getscopes()
/// goes on where that was defined; what it was inlined into are its parents.
class Scopes {
 public:
  Scopes(Dwarf_Die* unit, uint32_t address) {
    Dwarf_Die* around = nullptr;
    count_ = dwarf_getscopes(unit, address, &around);
    if (count_ > 0) count_ = dwarf_getscopes_die(&around[0], &dies_);
    std::free(around);
  }
  ~Scopes() { std::free(dies_); }
  Scopes(const Scopes&) = delete;
  Scopes& operator=(const Scopes&) = delete;
  bool damaged() const { return count_ < 0; }
  int count() const { return count_; }
  Dwarf_Die* operator[](int index) { return &dies_[index]; }

 private:
  Dwarf_Die* dies_ = nullptr;
  int count_ = 0;
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
    else if (dwarf_tag(&unit) == DW_TAG_compile_unit) {
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

unsigned DebugInformation::file_index(const char* name) {
  const std::string text = clean(name);
  const auto found = std::find(files_.rbegin(), files_.rend(), text);
  if (found != files_.rend()) return static_cast<unsigned>(files_.rend() - found - 1);
  files_.push_back(text);
  return static_cast<unsigned>(files_.size() - 1);
}

void DebugInformation::read_rows(Dwarf_Die& unit) {
  Dwarf_Lines* lines = nullptr;
  std::size_t count = 0;
  if (dwarf_getsrclines(&unit, &lines, &count) != 0)
    return complain(fmt::format("the lines of {}: {}", function_name(&unit), why()));
  const char* last_name = nullptr;
  unsigned last_file = 0;
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
    if (name != last_name || rows_.empty()) last_file = file_index(name);
    last_name = name;
    rows_.push_back({static_cast<uint32_t>(address), last_file,
                     static_cast<unsigned>(std::max(number, 0)), end, statement});
  }
}

std::optional<SourceLine> DebugInformation::line_at(uint32_t address) const {
  auto row = std::upper_bound(rows_.begin(), rows_.end(), address,
                              [](uint32_t a, const Row& r) { return a < r.address; });
  if (row == rows_.begin()) return std::nullopt;
  --row;
  // Line 0: the compiler names none; what stands before it is next to it.
  while (row != rows_.begin() && !row->end && row->line == 0) --row;
  if (row->end || row->line == 0) return std::nullopt;
  return SourceLine{files_[row->file], row->line};
}

std::vector<Place> DebugInformation::places_at(uint32_t address) const {
  std::vector<Place> places;
  const auto unit = std::find_if(units_.begin(), units_.end(), [address](const Unit& u) {
    return address >= u.first && address < u.behind;
  });
  Dwarf_Die entry;
  if (unit == units_.end() || dwarf_offdie(copy_->dwarf(), unit->die, &entry) == nullptr)
    return places;
  Scopes scopes(&entry, address);
  if (scopes.damaged()) complain(fmt::format("the functions at {:#010x}: {}", address, why()));
  std::optional<SourceLine> at = line_at(address);
  for (int i = 0; i < scopes.count(); ++i) {
    const int tag = dwarf_tag(scopes[i]);
    const bool inlined = tag == DW_TAG_inlined_subroutine;
    if (!inlined && tag != DW_TAG_subprogram) continue;
    Dwarf_Addr first = 0;
    const bool is_left_out = !inlined && dwarf_lowpc(scopes[i], &first) == 0 && first == 0;
    if (is_left_out) return {};  // it only claims the address
    places.push_back({function_name(scopes[i]), at.value_or(SourceLine{}), inlined});
    if (!inlined) return places;
    at = call_of(scopes[i], &entry);
  }
  return {};
}

}  // namespace capsoc::source
