#include "loader/elf_image.h"

#include <gtest/gtest.h>

#include <random>

#include "base/printable.h"
#include "loader/demangle.h"

namespace capsoc::loader {
namespace {

TEST(ElfImage, ABuiltProgramHasItsVectorTableAndItsSymbols) {
  const auto image = load_elf(HELLO_ELF);
  ASSERT_TRUE(image) << image.error();
  EXPECT_EQ(image.value().segments.front().address, 0u);
  const auto main = image.value().address_of("main");
  ASSERT_TRUE(main);
  EXPECT_EQ(image.value().symbolise(*main), "main");
  EXPECT_EQ(image.value().symbolise(*main | 1), "main");
  EXPECT_EQ(image.value().symbolise(*main + 2), "main+0x2");
  EXPECT_EQ(image.value().symbolise(0x70000000), "");
}

TEST(ElfImage, NamesAreWhatATerminalShows) {
  std::string bytes = *load_elf(HELLO_ELF).value().file;
  const std::size_t name = bytes.rfind(std::string("\0main\0", 6)) + 1;
  bytes.replace(name, 4, "\x1B[0m");
  const auto image = parse_elf("f.elf", bytes);
  ASSERT_TRUE(image) << image.error();
  EXPECT_TRUE(image.value().address_of("?[0m"));
}

TEST(Demangle, NamesOfCppAndRust) {
  EXPECT_EQ(demangled("_ZNK5outer3BoxIiE3getEPKci"),
            "outer::Box<int>::get(char const*, int) const");
  EXPECT_EQ(demangled("_RNvNtCs1234_7mycrate3foo3bar"), "mycrate::foo::bar");
  EXPECT_EQ(demangled("_ZN4core3fmt9Formatter3pad17h0123456789abcdefE"),
            "core::fmt::Formatter::pad");
  for (const char* plain : {"main", "_start", "_Z", "_R", "_Reset", "Z3fv", ""})
    EXPECT_EQ(demangled(plain), plain);
}

TEST(Demangle, DamagedNamesEnd) {
  const std::string names[] = {
      "_ZNSt3mapIiSt6vectorIN1a1bIXadL_Z1fvEEEESaIS4_EEE4findERKi",
      "_RINvNtCsbDqzhRXHg_4core3ptr13drop_in_placeNtNtB2_3fmt9FormatterEB4_",
      "_ZN4core3fmt9Formatter3pad17h0123456789abcdefE"};
  std::mt19937 random(20261125);
  for (unsigned round = 0; round < 100'000; ++round) {
    std::string name = names[round % 3];
    for (unsigned i = 0; i < 3; ++i)
      name[2 + random() % (name.size() - 2)] = static_cast<char>(' ' + random() % 95);
    if (round % 5 == 0) name.resize(random() % name.size());
    const std::string text = demangled(name);
    EXPECT_EQ(printable(text, text.size()), text) << name;
    EXPECT_LE(text.size(), 993U) << name;
  }
}

}  // namespace
}  // namespace capsoc::loader
