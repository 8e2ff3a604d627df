#include "loader/elf_image.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <random>

namespace capsoc::loader {
namespace {

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

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

TEST(ElfImage, DamageIsAnErrorOrLoadsButNeverCrashes) {
  const std::string whole = contents(HELLO_ELF);
  ASSERT_GT(whole.size(), 1000u);
  const std::string path = testing::TempDir() + std::to_string(getpid()) + "damaged.elf";
  constexpr unsigned seed = 20191108;
  std::mt19937 random(seed);
  unsigned refused = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = whole;
    for (int i = 0; i < 4; ++i)
      damaged[random() % (i < 2 ? 0x100 : damaged.size())] = static_cast<char>(random());
    if (round % 4 == 0) damaged.resize(random() % damaged.size());
    std::ofstream(path, std::ios::binary) << damaged;
    const auto image = load_elf(path);
    if (image) continue;
    ++refused;
    EXPECT_EQ(image.error().rfind(path, 0), 0u) << image.error();
  }
  std::remove(path.c_str());
  EXPECT_GT(refused, 500u) << "seed " << seed;
}

}  // namespace
}  // namespace capsoc::loader
