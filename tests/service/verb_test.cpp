// Parameters against their declaration.
#include "service/verb.h"

#include <gtest/gtest.h>

namespace capsoc::service {
namespace {

const Declaration& declared() {
  static const Declaration about{
      "adc.inject",
      "",
      {need("u", Type::array, ""), need("v", Type::array, ""), may("name", Type::text, ""),
       may("at", Type::address, ""), may("count", Type::integer, ""), may("on", Type::boolean, ""),
       may("value", Type::number, ""), may("kinds", Type::list, ""), may("data", Type::bytes, "")},
      {}};
  return about;
}

std::string complaint(Json parameters, const Frames& frames = {}) {
  return Call(declared(), parameters, frames).complaint();
}

TEST(Call, AcceptsWhatIsDeclared) {
  EXPECT_EQ(complaint({{"u", {1, 2.5}}, {"v", Json::array()}, {"simulation", 3}}), "");
  EXPECT_EQ(complaint({{"u", {1}}, {"v", {1}}, {"at", "main"}, {"count", 7}, {"on", true}}), "");
  EXPECT_EQ(complaint({{"u", {1}}, {"v", {1}}, {"at", 4294967295U}, {"data", "text"}}), "");
}

TEST(Call, NamesWhatIsWrong) {
  const Json right = {{"u", {1}}, {"v", {1}}};
  const auto with = [&](const char* name, const Json& value) {
    Json all = right;
    all[name] = value;
    return complaint(all);
  };
  EXPECT_NE(complaint({{"u", {1}}}).find("'v' is missing"), std::string::npos);
  EXPECT_NE(with("name", 3).find("'name' has to be a text"), std::string::npos);
  EXPECT_NE(with("at", 4294967296U).find("'at'"), std::string::npos);
  EXPECT_NE(with("count", -1).find("'count'"), std::string::npos);
  EXPECT_NE(with("count", 1.5).find("'count'"), std::string::npos);
  EXPECT_NE(with("on", 1).find("'on'"), std::string::npos);
  EXPECT_NE(with("kinds", {1}).find("'kinds'"), std::string::npos);
  EXPECT_NE(with("u", "x").find("'u'"), std::string::npos);
  EXPECT_NE(with("cuont", 1).find("did you mean count"), std::string::npos);
}

TEST(Call, ArraysComeInFrames) {
  const double values[] = {0.5, -0.25};
  const Frames frames = {std::string(reinterpret_cast<const char*>(values), sizeof values),
                         std::string("\x01\xff\x7f", 3)};
  const Json wide = {{"frame", 0}, {"type", "<f8"}, {"shape", {2}}};
  const Json narrow = {{"frame", 1}, {"type", "|u1"}, {"shape", {3}}};
  const Json parameters = {{"u", wide}, {"v", narrow}, {"data", narrow}};
  const Call call(declared(), parameters, frames);
  ASSERT_EQ(call.complaint(), "");
  EXPECT_EQ(call.array("u"), (std::vector<double>{0.5, -0.25}));
  EXPECT_EQ(call.array("v"), (std::vector<double>{1, 255, 127}));
  EXPECT_EQ(call.bytes("data"), frames[1]);

  EXPECT_NE(complaint({{"u", {{"frame", 2}, {"type", "<f8"}}}, {"v", {1}}}, frames), "");
  EXPECT_NE(complaint({{"u", {{"frame", 1}, {"type", "<f8"}}}, {"v", {1}}}, frames), "")
      << "three bytes are no double";
  EXPECT_NE(complaint({{"u", {{"frame", 0}, {"type", "<x8"}}}, {"v", {1}}}, frames), "");
}

TEST(Schema, HasEveryParameter) {
  const Json schema = schema_of(declared(), true);
  ASSERT_EQ(schema.at("params").size(), declared().parameters.size() + 1);
  EXPECT_EQ(schema.at("params")[0].at("name"), "simulation");
  EXPECT_EQ(schema.at("params")[3].at("required"), false);
}

}  // namespace
}  // namespace capsoc::service
