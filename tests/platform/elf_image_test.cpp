#include "loader/elf_image.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace capsoc::loader
