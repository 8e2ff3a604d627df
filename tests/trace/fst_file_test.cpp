// What FstFile writes, read back by GTKWave's own reader.
#include "trace/fst_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "gtkwave/fstapi.h"

namespace capsoc::trace {
namespace {

struct Seen {
  std::map<uint32_t, std::string> names;  ///< by handle
  std::vector<std::string> changes;       ///< "time name value"
};

void note(void* user, uint64_t time, fstHandle handle, const unsigned char* value, uint32_t size) {
  auto& seen = *static_cast<Seen*>(user);
  seen.changes.push_back(std::to_string(time) + " " + seen.names[handle] + " " +
                         std::string(reinterpret_cast<const char*>(value), size));
}

void note_fixed(void* user, uint64_t time, fstHandle handle, const unsigned char* value) {
  note(user, time, handle, value,
       static_cast<uint32_t>(std::char_traits<char>::length(reinterpret_cast<const char*>(value))));
}

struct FstFiles : testing::Test {
  std::string path = testing::TempDir() + std::to_string(getpid()) + "waves.fst";
  ~FstFiles() override { std::remove(path.c_str()); }

  Seen read() const {
    Seen seen;
    void* reader = fstReaderOpen(path.c_str());
    if (reader == nullptr) return seen;
    EXPECT_EQ(fstReaderGetTimescale(reader), -12);
    std::string scope;
    while (fstHier* each = fstReaderIterateHier(reader)) {
      if (each->htyp == FST_HT_SCOPE) scope += std::string(each->u.scope.name) + ".";
      if (each->htyp == FST_HT_UPSCOPE) scope.erase(scope.find_last_of('.', scope.size() - 2) + 1);
      if (each->htyp == FST_HT_VAR) seen.names[each->u.var.handle] = scope + each->u.var.name;
    }
    fstReaderSetFacProcessMaskAll(reader);
    fstReaderIterBlocks2(reader, note_fixed, note, &seen, nullptr);
    fstReaderClose(reader);
    return seen;
  }

  bool has(const Seen& seen, const std::string& change) const {
    for (const std::string& each : seen.changes)
      if (each == change) return true;
    return false;
  }
};

TEST_F(FstFiles, KeepsNamesTimesAndValues) {
  auto made = FstFile::create(path);
  ASSERT_TRUE(made) << made.error();
  FstFile& file = *made.value();
  file.open_scope("soc");
  file.open_scope("bus");
  const auto word = file.add_bits("word", 5);
  const auto line = file.add_bits("line", 1);
  file.close_scope();
  const auto number = file.add_real("number");
  const auto text = file.add_text("text");
  file.close_scope();
  file.set(30, line, 0);  // ahead of time
  file.set(10, line, 1);
  file.set(10, word, 0b10110);
  file.flush(20);
  file.set_real(20, number, -0.25);
  file.set_text(20, text, "SysTick");
  file.set(25, word, 0b10110);  // no change
  EXPECT_FALSE(file.finish(40));

  const Seen seen = read();
  std::vector<std::string> names;
  for (const auto& [handle, name] : seen.names) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"soc.bus.word [4:0]", "soc.bus.line", "soc.number",
                                             "soc.text"}));
  for (const char* change : {"10 soc.bus.line 1", "10 soc.bus.word [4:0] 10110",
                             "30 soc.bus.line 0", "20 soc.number -0.25", "20 soc.text SysTick"})
    EXPECT_TRUE(has(seen, change)) << change;
  for (const std::string& each : seen.changes) EXPECT_NE(each.rfind("25 ", 0), 0U) << each;
}

TEST_F(FstFiles, AllSixtyFourBits) {
  auto made = FstFile::create(path);
  const auto word = made.value()->add_bits("word", 64);
  made.value()->set(1, word, 0x8000000000000001);
  EXPECT_FALSE(made.value()->finish(2));
  EXPECT_TRUE(has(read(), "1 word [63:0] 1" + std::string(62, '0') + "1"));
}

TEST_F(FstFiles, AWholeFileOrNone) {
  {
    auto made = FstFile::create(path);
    made.value()->set(1, made.value()->add_bits("word", 2), 1);
  }
  const std::filesystem::path beside = testing::TempDir();
  for (const auto& entry : std::filesystem::directory_iterator(beside))
    EXPECT_EQ(entry.path().string().find(path), std::string::npos) << entry.path();
  EXPECT_NE(FstFile::create("/nonexistent/w.fst").error().find("/nonexistent/w.fst: cannot be"),
            std::string::npos);
}

}  // namespace
}  // namespace capsoc::trace
