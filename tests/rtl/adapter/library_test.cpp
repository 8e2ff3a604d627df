// Libraries that cannot be used are refused with one sentence.
#include <gtest/gtest.h>

#include <string>

#include "libraries.h"
#include "rtl/coprocessor_rtl.h"

namespace capsoc::rtl::test {
namespace {

using coprocessor::Arithmetic;

std::string refusal(const std::string& file, const coprocessor::Options& options) {
  const auto library = RtlLibrary::open(file, options);
  return library ? "it was opened" : library.error();
}

void expect_refusal(const std::string& file, const std::string& reason,
                    const coprocessor::Options& options = {}) {
  const std::string sentence = refusal(file, options);
  EXPECT_EQ(sentence.rfind(file, 0), 0u) << sentence;
  EXPECT_NE(sentence.find(reason), std::string::npos) << sentence;
  EXPECT_EQ(sentence.find('\n'), std::string::npos) << sentence;
}

TEST(RtlLibrary, AMissingFileIsNamed) {
  expect_refusal("/nonexistent/libcapsoc_rtl.so", "no such RTL library");
}

TEST(RtlLibrary, WhatIsNoLibraryIsRefused) {
  expect_refusal("README.md", "no shared library");
  expect_refusal("/proc/self/status", "is empty");
}

TEST(RtlLibrary, AnInterfaceOfAnotherVersionIsRefused) {
  expect_refusal(LIBRARIES "/rtl_library_wrong_version.so",
                 "its interface has version 9 and this program wants 8");
}

// What RTL is in a library is its own matter; nodes and registers that are not the program's are
// another coprocessor.
TEST(RtlLibrary, NodesAndRegistersHaveToBeTheProgramsOwn) {
  EXPECT_TRUE(RtlLibrary::open(LIBRARIES "/rtl_library_other_rtl.so", {}));
  expect_refusal(LIBRARIES "/rtl_library_other_nodes.so", "its nodes are not those");
  expect_refusal(LIBRARIES "/rtl_library_other_registers.so", "its registers are not those");
}

TEST(RtlLibrary, WhereOnlyThePinsAreKnownARunRefuses) {
  const char* const file = LIBRARIES "/rtl_library_pins_alone.so";
  expect_refusal(file, "`capsoc regress --rtl-library ");
  EXPECT_TRUE(RtlLibrary::open(file, {}, RtlLibrary::Use::at_its_pins));
}

TEST(RtlLibrary, OtherParametersThanTheModelsAreRefused) {
  expect_refusal(RtlLibrary::file_name(Arithmetic::precise), "its arithmetic is precise",
                 options_of(Arithmetic::paper));
  coprocessor::Options options = options_of(Arithmetic::paper);
  options.paper_operand_bits = 16;
  expect_refusal(RtlLibrary::file_name(Arithmetic::paper), "(operand bits 32,", options);
  options = options_of(Arithmetic::paper);
  options.paper_plain_arctangent = true;
  expect_refusal(RtlLibrary::file_name(Arithmetic::paper),
                 "plain arctangent 0, iteration clocks 1) are not the model's", options);
  options = options_of(Arithmetic::paper);
  options.paper_iteration_clocks = 2;
  expect_refusal(RtlLibrary::file_name(Arithmetic::paper), "are not the model's (32, 0, 0, 0, 2)",
                 options);
}

TEST(RtlLibrary, IsFoundByItsParameters) {
  coprocessor::Options options = options_of(Arithmetic::paper);
  EXPECT_EQ(RtlLibrary::file_name(options), RtlLibrary::file_name(Arithmetic::paper));
  options.paper_step_shift = 7;
  EXPECT_NE(RtlLibrary::file_name(options).find("libcapsoc_rtl_paper_32_0_7_0.so"),
            std::string::npos);
  options.paper_iteration_clocks = 2;
  EXPECT_NE(RtlLibrary::file_name(options).find("libcapsoc_rtl_paper_32_0_7_0_2.so"),
            std::string::npos);
  options.arithmetic = Arithmetic::precise;
  EXPECT_EQ(RtlLibrary::file_name(options), RtlLibrary::file_name(Arithmetic::precise))
      << "precise has none of them";
}

TEST(RtlLibrary, ExportsEveryNodeOfTheModel) {
  const auto library = open_library(Arithmetic::precise);
  ASSERT_NE(library, nullptr);
  ASSERT_EQ(library->api().inside->node_count, coprocessor::node_count);
  for (std::size_t i = 0; i < coprocessor::node_count; ++i)
    EXPECT_STREQ(library->api().inside->node_names[i], coprocessor::node_names().at(i).name);
}

TEST(RtlLibrary, WavesThatCannotBeWrittenAreAnError) {
  CoprocessorRtl rtl(open_library(Arithmetic::precise));
  const auto error = rtl.open_waves("/nonexistent/waves.fst");
  ASSERT_TRUE(error);
  EXPECT_NE(error->text.find("/nonexistent/waves.fst: cannot be written"), std::string::npos);
  const std::string folder = testing::TempDir();
  const auto no_file = rtl.open_waves(folder);
  ASSERT_TRUE(no_file);
  EXPECT_EQ(no_file->text, folder + ": is no file; name one for the waves");
}

}  // namespace
}  // namespace capsoc::rtl::test
