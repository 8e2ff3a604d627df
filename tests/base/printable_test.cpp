#include "base/printable.h"

#include <gtest/gtest.h>

namespace capsoc {
namespace {

TEST(Printable, KeepsTheCharactersOfAnyLanguage) {
  for (const char* text :
       {"main.c", "größe", "Öl prüfen", "日本", "π ≈ 3", "😀", "\xF4\x8F\xBF\xBF"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, ReplacesControlsAndWhatIsNoUtf8) {
  EXPECT_EQ(printable("\x1b[0m\n\x7f"), "?[0m??");
  EXPECT_EQ(printable("a\xC2\x9B"
                      "b"),
            "a??b")
      << "CSI, as one character";
  EXPECT_EQ(printable("gr\xF6\xDF"
                      "e"),
            "gr??e")
      << "Latin-1";
  EXPECT_EQ(printable("\xC0\xAF"), "??") << "too long a form";
  EXPECT_EQ(printable("\xE0\x80\xAF"), "???");
  EXPECT_EQ(printable("\xED\xA0\x80"), "???") << "a surrogate";
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "????") << "beyond Unicode";
  EXPECT_EQ(printable("\xE6\x97"), "??") << "cut short";
  EXPECT_EQ(printable("a\xC2\xA0"
                      "b\xE2\x80\xAE"
                      "c\xEF\xBB\xBF"),
            "a??b???c???");
}

TEST(Printable, CutsInFrontOfACharacter) {
  EXPECT_EQ(printable("abc", 3), "abc");
  EXPECT_EQ(printable("abcd", 3), "abc...");
  EXPECT_EQ(printable("aöö", 4), "aö...");
  EXPECT_EQ(printable("aöö", 5), "aöö");
}

TEST(Printable, ANameOfAFileKeepsItsBytes) {
  EXPECT_EQ(without_controls("gr\xF6\xDF"
                             "e\n\x7f.c"),
            "gr\xF6\xDF"
            "e??.c");
}

}  // namespace
}  // namespace capsoc
