// The register description against the model: the same registers, reset values, masks and holes.
#include <gtest/gtest.h>

#include <string_view>

#include "capsoc_registers.h"
#include "coprocessor/coprocessor.h"

namespace {

using capsoc::coprocessor::Coprocessor;
using capsoc::registers::Access;
using capsoc::registers::RegisterDescription;
using namespace capsoc::registers::coprocessor;

const RegisterDescription* described(uint32_t offset) {
  for (const auto& entry : table) {
    if (entry.offset == offset) return &entry;
  }
  return nullptr;
}

// Registers whose write has an effect beyond their own bits, or that need a second write.
bool plain(const RegisterDescription& entry) {
  const std::string_view name = entry.name;
  const std::string_view ending = name.substr(name.size() < 3 ? 0 : name.size() - 3);
  const bool half_of_a_pair = ending == "_LO" || ending == "_HI";
  return entry.access == Access::read_write && entry.one_to_clear_mask == 0 && !half_of_a_pair;
}

TEST(CoprocessorTable, EveryDescribedRegisterResetsToItsValue) {
  Coprocessor model({});
  for (const auto& entry : table) {
    const auto read = model.read(0, entry.offset, true);
    EXPECT_TRUE(read.ok) << entry.name;
    EXPECT_EQ(read.value, entry.reset) << entry.name;
  }
}

TEST(CoprocessorTable, EveryOffsetWithoutDescriptionIsABusError) {
  Coprocessor model({});
  for (uint32_t offset = 0; offset < block_size; offset += 4) {
    const bool expected = described(offset) != nullptr;
    EXPECT_EQ(model.read(0, offset, false).ok, expected) << std::hex << offset;
    EXPECT_EQ(model.write(0, offset, 0), expected) << std::hex << offset;
  }
}

TEST(CoprocessorTable, PlainRegistersKeepTheirWritableBitsAndNoOthers) {
  // Below 2^31, which is the limit of the steps and amplitudes; CTRL.REF must not be 3.
  for (const uint32_t pattern : {0x55555555u, 0x2AAAAAAAu}) {
    for (const auto& entry : table) {
      if (!plain(entry)) continue;
      Coprocessor model({});
      ASSERT_TRUE(model.write(0, entry.offset, pattern)) << entry.name;
      const uint32_t kept = pattern & entry.writable_mask & entry.readable_mask;
      EXPECT_EQ(model.read(0, entry.offset, false).value, kept) << entry.name;
    }
  }
}

TEST(CoprocessorTable, ReadOnlyRegistersIgnoreWrites) {
  Coprocessor model({});
  for (const auto& entry : table) {
    if (entry.access != Access::read_only) continue;
    EXPECT_TRUE(model.write(0, entry.offset, 0xFFFFFFFF)) << entry.name;
    EXPECT_FALSE(capsoc::coprocessor::write_complaint(entry.offset, 0xFFFFFFFF).empty())
        << entry.name;
    EXPECT_EQ(model.read(0, entry.offset, false).value, entry.reset) << entry.name;
  }
}

}  // namespace
