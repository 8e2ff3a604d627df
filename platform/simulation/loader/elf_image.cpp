#include "loader/elf_image.h"

#include <fmt/format.h>
#include <gelf.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "base/input_file.h"
#include "base/printable.h"
#include "loader/demangle.h"

namespace capsoc::loader {
namespace {

constexpr uint64_t largest_program = 256U << 20U;  // debugging information included
constexpr std::size_t longest_name = 990;          // mangled ones of templates are long
using ElfHandle = std::unique_ptr<Elf, int (*)(Elf*)>;

Error wrong(const std::string& path, const std::string& what) {
  return Error{fmt::format("{}: {}", path, what)};
}

/// Segments with file contents or zeroed memory; physical addresses, where a loader puts them.
Result<std::vector<Segment>> read_segments(const std::string& path, Elf* elf, uint64_t file_size) {
  std::vector<Segment> segments;
  size_t count = 0;
  if (elf_getphdrnum(elf, &count) != 0)
    return wrong(path, "its program headers are damaged; rebuild it");
  std::size_t raw_size = 0;
  const char* raw = elf_rawfile(elf, &raw_size);
  for (size_t i = 0; i < count; ++i) {
    GElf_Phdr header;
    if (gelf_getphdr(elf, static_cast<int>(i), &header) == nullptr)
      return wrong(path, fmt::format("program header {} is damaged; rebuild it", i));
    if (header.p_type != PT_LOAD || header.p_memsz == 0) continue;
    if (header.p_offset > file_size || header.p_filesz > file_size - header.p_offset ||
        raw == nullptr)
      return wrong(path, fmt::format("segment {} ends outside the file; the file is cut short", i));
    if (header.p_filesz > header.p_memsz || header.p_memsz > (1ull << 32) ||
        header.p_paddr + header.p_memsz > (1ull << 32))
      return wrong(path, fmt::format("segment {} has an impossible size; rebuild it", i));
    Segment segment;
    segment.address = static_cast<uint32_t>(header.p_paddr);
    segment.memory_size = static_cast<uint32_t>(header.p_memsz);
    // .bss is zeroed by the start-up code where it runs (virtual address), not where it is loaded.
    if (header.p_vaddr != header.p_paddr)
      segment.memory_size = static_cast<uint32_t>(header.p_filesz);
    segment.bytes.assign(raw + header.p_offset, raw + header.p_offset + header.p_filesz);
    if (segment.memory_size > 0) segments.push_back(std::move(segment));
  }
  if (segments.empty()) return wrong(path, "it has nothing to load; link it with a linker script");
  return segments;
}

/// '$t' and '$d', or '$t.anything'.
bool is_mapping(const char* name) {
  return name[0] == '$' && (name[1] == 't' || name[1] == 'd') &&
         (name[2] == '\0' || name[2] == '.');
}

void read_symbols(Elf* elf, ElfImage& image) {
  std::vector<Symbol>& symbols = image.symbols;
  std::vector<Mapping>& mappings = image.mappings;
  for (Elf_Scn* section = nullptr; (section = elf_nextscn(elf, section)) != nullptr;) {
    GElf_Shdr header;
    if (gelf_getshdr(section, &header) == nullptr || header.sh_type != SHT_SYMTAB) continue;
    Elf_Data* data = elf_getdata(section, nullptr);
    if (data == nullptr || header.sh_entsize == 0) continue;
    const auto count =
        static_cast<int>(std::min<uint64_t>(data->d_size / header.sh_entsize, 1u << 20));
    for (int i = 0; i < count; ++i) {
      GElf_Sym symbol;
      if (gelf_getsym(data, i, &symbol) == nullptr) break;
      const auto type = GELF_ST_TYPE(symbol.st_info);
      if (type != STT_FUNC && type != STT_OBJECT && type != STT_NOTYPE) continue;
      const char* name = elf_strptr(elf, header.sh_link, symbol.st_name);
      if (name != nullptr && is_mapping(name) && symbol.st_shndx != SHN_UNDEF)
        mappings.push_back({static_cast<uint32_t>(symbol.st_value), name[1] == 't'});
      if (name == nullptr || *name == '\0' || *name == '$' || symbol.st_shndx == SHN_UNDEF)
        continue;
      const auto address = static_cast<uint32_t>(symbol.st_value) & (type == STT_FUNC ? ~1u : ~0u);
      const bool weak = GELF_ST_BIND(symbol.st_info) == STB_WEAK;
      const bool is_code = type == STT_FUNC || (type == STT_NOTYPE && symbol.st_size == 0);
      symbols.push_back({address, static_cast<uint32_t>(symbol.st_size),
                         printable(name, longest_name), weak, is_code});
    }
  }
  // Lookups find the last of equals first: weak aliases of one default handler stand before its own
  // name.
  std::stable_sort(symbols.begin(), symbols.end(), [](const Symbol& a, const Symbol& b) {
    return a.address != b.address ? a.address < b.address : a.weak && !b.weak;
  });
  std::stable_sort(mappings.begin(), mappings.end(),
                   [](const Mapping& a, const Mapping& b) { return a.address < b.address; });
}

}  // namespace

const Symbol* ElfImage::symbol_at(uint32_t address) const {
  address &= ~1u;
  auto next = std::upper_bound(symbols.begin(), symbols.end(), address,
                               [](uint32_t a, const Symbol& s) { return a < s.address; });
  for (auto it = next; it != symbols.begin();) {
    --it;
    if (it->size == 0 || address - it->address >= it->size) {
      if (address - it->address > 0x1000) break;
      continue;
    }
    return &*it;
  }
  return nullptr;
}

bool ElfImage::is_code(uint32_t address) const {
  const auto next = std::upper_bound(mappings.begin(), mappings.end(), address,
                                     [](uint32_t a, const Mapping& m) { return a < m.address; });
  return next != mappings.begin() && std::prev(next)->is_code;
}

std::string ElfImage::symbolise(uint32_t address) const {
  const Symbol* symbol = symbol_at(address);
  if (symbol == nullptr) return "";
  const uint32_t offset = (address & ~1u) - symbol->address;
  const std::string name = demangled(symbol->name);
  return offset == 0 ? name : fmt::format("{}+{:#x}", name, offset);
}

std::optional<uint32_t> ElfImage::address_of(const std::string& name) const {
  for (const Symbol& symbol : symbols)
    if (symbol.name == name) return symbol.address;
  for (const Symbol& symbol : symbols)
    if (demangled(symbol.name) == name) return symbol.address;
  return std::nullopt;
}

std::optional<std::vector<uint8_t>> ElfImage::contents(const std::string& name) const {
  for (const Symbol& symbol : symbols) {
    if (symbol.name != name || symbol.size == 0) continue;
    for (const Segment& segment : segments) {
      const uint64_t offset = uint64_t{symbol.address} - segment.address;
      if (symbol.address < segment.address || offset + symbol.size > segment.bytes.size()) continue;
      const auto begin = segment.bytes.begin() + static_cast<std::ptrdiff_t>(offset);
      return std::vector<uint8_t>(begin, begin + symbol.size);
    }
  }
  return std::nullopt;
}

bool ElfImage::overwrite(const std::string& name, const std::vector<uint8_t>& bytes) {
  for (const Symbol& symbol : symbols) {
    if (symbol.name != name || symbol.size != bytes.size()) continue;
    for (Segment& segment : segments) {
      const uint64_t offset = uint64_t{symbol.address} - segment.address;
      if (symbol.address < segment.address || offset + bytes.size() > segment.bytes.size())
        continue;
      std::copy(bytes.begin(), bytes.end(),
                segment.bytes.begin() + static_cast<std::ptrdiff_t>(offset));
      return true;
    }
  }
  return false;
}

Result<std::string> read_program(const std::string& path) {
  return read_input(path, {"name an ELF file for the Cortex-M3", largest_program});
}

Result<ElfImage> load_elf(const std::string& path) {
  auto bytes = read_program(path);
  if (!bytes) return Error{bytes.error()};
  return parse_elf(path, std::move(bytes.value()));
}

Result<ElfImage> parse_elf(const std::string& path, std::string bytes) {
  elf_version(EV_CURRENT);
  const ElfHandle elf(elf_memory(bytes.data(), bytes.size()), elf_end);
  if (!elf || elf_kind(elf.get()) != ELF_K_ELF)
    return wrong(
        path,
        "is no ELF file, no Intel HEX and no S-records; build it with arm-none-eabi-gcc "
        "-mcpu=cortex-m3, load raw bytes where they belong with --load FILE@ADDRESS, or give a "
        "recording with --sensor");
  GElf_Ehdr header;
  if (gelf_getehdr(elf.get(), &header) == nullptr)
    return wrong(path, "its ELF header is damaged; rebuild it");
  if (header.e_machine != EM_ARM || header.e_ident[EI_CLASS] != ELFCLASS32 ||
      header.e_ident[EI_DATA] != ELFDATA2LSB)
    return wrong(path, "is for another machine; build it with arm-none-eabi-gcc -mcpu=cortex-m3");
  if (header.e_type != ET_EXEC) return wrong(path, "is not linked to an executable; link it first");

  auto segments = read_segments(path, elf.get(), bytes.size());
  if (!segments) return Error{segments.error()};
  ElfImage image;
  image.path = path;
  image.entry = static_cast<uint32_t>(header.e_entry);
  image.segments = std::move(segments.value());
  read_symbols(elf.get(), image);
  image.file = std::make_shared<const std::string>(std::move(bytes));
  return image;
}

}  // namespace capsoc::loader
