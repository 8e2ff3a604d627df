#include "trace/node_format.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "coprocessor/device.h"

namespace capsoc::trace {
namespace {

std::string probe_source() {
  std::ifstream file("rtl/verification/coprocessor_probe.sv");
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(NodeFormat, EveryNodeHasOne) {
  for (const coprocessor::NamedNode& node : coprocessor::node_names()) {
    const NodeFormat format = node_format(node.name);
    const std::string name = node.name;
    EXPECT_EQ(format.width == 64, name == "s_low" || name == "c_low") << name;
    EXPECT_LE(format.fraction, format.width) << name;
  }
}

// The probe takes every signal out through a function of its width: s32(), u32(), bit_of() ...
TEST(NodeFormat, WidthAndSignAreTheRtls) {
  const std::string source = probe_source();
  ASSERT_FALSE(source.empty());
  const std::regex assignment("node_(\\w+)_o\\s*<?=\\s*(s|u)(32|48)\\(");
  unsigned compared = 0;
  for (std::sregex_iterator at(source.begin(), source.end(), assignment), end; at != end; ++at) {
    const NodeFormat format = node_format((*at)[1].str());
    if (format.meaning == Meaning::word) continue;
    EXPECT_EQ(format.width, static_cast<unsigned>(std::stoi((*at)[3].str()))) << (*at)[0];
    EXPECT_EQ(format.is_signed, (*at)[2].str() == "s") << (*at)[0];
    ++compared;
  }
  EXPECT_GE(compared, 20U);
}

TEST(NodeFormat, Values) {
  EXPECT_DOUBLE_EQ(node_format("a1").value(0x40000000), 0.5);
  EXPECT_DOUBLE_EQ(node_format("u").value(-0x40000000), -0.5);
  EXPECT_DOUBLE_EQ(node_format("a_u").value(int64_t{3} << 45), 1.5);
  EXPECT_DOUBLE_EQ(node_format("angle").value(0xC0000000), 270);
  EXPECT_DOUBLE_EQ(node_format("residue").value(-0x40000000), -90);
  EXPECT_DOUBLE_EQ(node_format("frequency").value(int64_t{1} << 46), 90);
  EXPECT_DOUBLE_EQ(node_format("travel").value(-(int64_t{1} << 28)), -90);
  EXPECT_DOUBLE_EQ(node_format("deviation").value(0xC0000000), 1.5);
  EXPECT_DOUBLE_EQ(node_format("samples").value(7), 7);
}

}  // namespace
}  // namespace capsoc::trace
