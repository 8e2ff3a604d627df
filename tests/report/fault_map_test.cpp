// The map of a fault campaign: areas are numbers of faults, and nothing is left out or drawn twice.
#include "report/fault_map.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <random>
#include <regex>
#include <string>
#include <vector>

namespace capsoc::report {
namespace {

struct Box {
  std::string kind;
  double x, y, width, height;
  double area() const { return width * height; }
};

std::vector<Box> boxes_in(const std::string& html) {
  static const std::regex rectangle(
      R"re(<rect class="(\w+)" x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)"/>)re");
  std::vector<Box> boxes;
  for (std::sregex_iterator it(html.begin(), html.end(), rectangle), end; it != end; ++it)
    boxes.push_back({(*it)[1], std::stod((*it)[2]), std::stod((*it)[3]), std::stod((*it)[4]),
                     std::stod((*it)[5])});
  return boxes;
}

Json campaign(const std::map<std::string, std::map<std::string, int>>& units,
              const std::string& kind = "fault") {
  Json values = Json::array();
  for (const auto& [unit, exits] : units) {
    Json row = {{"value", unit}, {"exits", Json::array()}};
    for (const auto& [exit, runs] : exits) row["exits"].push_back({{"exit", exit}, {"runs", runs}});
    values.push_back(row);
  }
  return {{"kind", kind},
          {"by", {{{"name", "unit"}, {"expression", "fault.unit"}, {"values", values}}}}};
}

TEST(FaultMap, AnAreaIsANumberOfFaultsAndIsDividedByVerdicts) {
  const std::string map =
      fault_maps_of(campaign({{"rtl.u_judge", {{"0: masked", 60}, {"1: silent", 20}}},
                              {"rtl.u_bank", {{"0: detected", 20}}}}));
  std::map<std::string, double> areas;
  for (const Box& box : boxes_in(map)) areas[box.kind] += box.area();
  const double all = areas.at("edge");
  EXPECT_NEAR(all, 1000 * 420, 100);
  EXPECT_NEAR(areas.at("masked") / all, 0.6, 1e-3);
  EXPECT_NEAR(areas.at("silent") / all, 0.2, 1e-3);
  EXPECT_NEAR(areas.at("detected") / all, 0.2, 1e-3);
  EXPECT_NE(map.find("<title>rtl.u_judge: 80 faults, silent 20, masked 60</title>"),
            std::string::npos);
  EXPECT_NE(map.find("All: 100 faults, silent 20, detected 20, masked 60"), std::string::npos);
  EXPECT_NE(map.find(">u_judge</text>"), std::string::npos);
  const std::string memory =
      fault_maps_of(campaign({{"coprocessor.corrections.45", {{"0: latent", 1}}}}));
  EXPECT_NE(memory.find(">corrections.45</text>"), std::string::npos);
}

TEST(FaultMap, PlacesNeitherOverlapNorLeaveAGap) {
  std::mt19937 random(40);
  for (int round = 0; round < 50; ++round) {
    std::map<std::string, std::map<std::string, int>> units;
    int faults = 0;
    const int count = 1 + static_cast<int>(random() % 400);
    for (int i = 0; i < count; ++i) {
      const int runs = 1 + static_cast<int>(random() % (round % 2 == 0 ? 10 : 1000));
      units[fmt::format("unit{}", i)] = {{"0: latent", runs}};
      faults += runs;
    }
    std::vector<Box> edges;
    double all = 0;
    for (const Box& box : boxes_in(fault_maps_of(campaign(units)))) {
      if (box.kind != "edge") continue;
      EXPECT_LE(box.x + box.width, 1000.02);
      EXPECT_LE(box.y + box.height, 420.02);
      for (const Box& other : edges)
        EXPECT_FALSE(box.x + 0.05 < other.x + other.width && other.x + 0.05 < box.x + box.width &&
                     box.y + 0.05 < other.y + other.height && other.y + 0.05 < box.y + box.height)
            << "round " << round;
      edges.push_back(box);
      all += box.area();
    }
    EXPECT_EQ(edges.size(), static_cast<std::size_t>(std::min(count, 301)));
    EXPECT_NEAR(all, 1000 * 420, 1000) << faults << " faults in " << count << " places";
  }
}

TEST(FaultMap, OnlyACampaignOfFaultsHasOne) {
  const std::map<std::string, std::map<std::string, int>> units = {{"a", {{"0: masked", 1}}}};
  EXPECT_EQ(fault_maps_of(campaign(units, "run")), "");
  EXPECT_EQ(fault_maps_of(campaign({})), "");
  EXPECT_EQ(fault_maps_of(Json::object()), "");
}

TEST(FaultMap, TextsOfAResultAreNoMarkup) {
  const std::string map = fault_maps_of(campaign({{"<script>\"&", {{"2: <b>", 5}}}}));
  EXPECT_EQ(map.find("<script>"), std::string::npos);
  EXPECT_EQ(map.find("<b>"), std::string::npos);
  EXPECT_NE(map.find("&#60;script&#62;"), std::string::npos);
  EXPECT_NE(map.find("others 5"), std::string::npos);
}

}  // namespace
}  // namespace capsoc::report
