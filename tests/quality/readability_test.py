#!/usr/bin/env python3
"""The words and sentences of pages, comments and messages, and how scripts/tool readability counts them."""

import subprocess
import unittest

from capsoc_tools.text.prose import passages, sentences
from capsoc_tools.text.readability import all_passages, figures, listed_words, word_list
from harness import CLEAN, SOURCE

CTEST = {"name": "quality: readability", "timeout": 300}

#: Kind -> (sentences of more than 35 words, listed words) of the tree. A number may only become smaller: a test
#: fails above it, and below it until it is lowered here.
LEFT = {
    "pages: guide": (0, 0),
    "pages: reference": (0, 0),
    "pages: explanation": (0, 0),
    "pages: developer": (0, 0),
    "pages: others": (0, 0),
    "comments": (0, 0),
    "messages": (0, 0),
}

PAGE = """# A heading anew

One sentence of [six words](x.md#whoever) here. capsoc is
the subject of the second one.

    code anew

- An item that goes on in `code anew`.

| name | a cell that somebody reads here |
|---|---|

```sh
anew
```
"""

CPP = r"""
#include "anew/anew.h"
// Nobody reads this comment,
// which has two lines.
int a = 1'000;  // A comment at the end.
//   a table   of columns anew
const char* text = "a message that "
                   "nobody reads: {}\n"
                   "and a second line of that message";
const char* name = "anew";
"""

PYTHON = '''"""Documentation that somebody reads.

usage: a line that is no sentence
"""
import sys
# A comment of one line here.
def f(x):
    """More words for the caller."""
    return x + f"the value {x} is not a number"
'''


def found(name, text):
    return list(passages(name, text))


class Passages(unittest.TestCase):
    def test_a_page(self):
        self.assertEqual(
            [(each.kind, each.line, each.text) for each in found("docs/guide/x.md", PAGE)],
            [
                (
                    "pages: guide",
                    3,
                    "One sentence of [six words](x.md#whoever) here. capsoc is the subject of the second one.",
                ),
                ("pages: guide", 8, "An item that goes on in `code anew`."),
                ("pages: guide", 10, "name"),
                ("pages: guide", 10, "a cell that somebody reads here"),
            ],
        )

    def test_what_a_tool_writes_into_a_page_is_not_read(self):
        self.assertEqual(found("x.md", "<!-- Below: written by scripts/tool protocol_page. -->\n\nWords.\n"), [])

    def test_cpp(self):
        self.assertEqual(
            [(each.kind, each.line, each.text) for each in found("models/x.cpp", CPP)],
            [
                ("comments", 3, "Nobody reads this comment, which has two lines."),
                ("comments", 5, "A comment at the end."),
                ("messages", 7, "a message that nobody reads: X"),
                ("messages", 7, "and a second line of that message"),
            ],
        )
        self.assertEqual({each.kind for each in found("tests/x.cpp", CPP)}, {"comments"})

    def test_python(self):
        self.assertEqual(
            [(each.kind, each.line, each.text) for each in found("scripts/x.py", PYTHON)],
            [
                ("comments", 6, "A comment of one line here."),
                ("comments", 1, "Documentation that somebody reads."),
                ("comments", 8, "More words for the caller."),
                ("messages", 9, "the value X is not a number"),
            ],
        )

    def test_sentences(self):
        page = found("x.md", PAGE)[0]
        self.assertEqual([count for _, count in sentences(page)], [6, 8])


class Words(unittest.TestCase):
    def said(self, text):
        return [said for _, said, _ in listed_words(found("x.md", text), word_list())]

    def test_listed_words_stand_outside_of_code_and_links(self):
        self.assertEqual(self.said(PAGE), ["goes on", "somebody"])

    def test_each_line_of_the_list_has_a_plain_term(self):
        for pattern, plain in word_list():
            self.assertGreater(len(plain), 3, pattern.pattern)

    def test_the_house_words_are_found(self):
        for text, word in {
            "It vouches for the angle.": "vouches",
            "The run goes on.": "goes on",
            "It is drawn anew.": "anew",
            "RTL is held against the model.": "held against",
            "A thing of one's own.": "of one's own",
        }.items():
            self.assertIn(word, " ".join(self.said(text)), text)

    def test_plain_words_are_not_found(self):
        self.assertEqual(self.said("The core retires it again. A shaft at rest goes to 0. Outside and inside."), [])


class Tree(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.table = figures(list(all_passages()), word_list(), 35)

    def test_every_kind_has_its_numbers(self):
        self.assertEqual(set(self.table) - {"pages"}, set(LEFT))

    def test_what_is_left_only_becomes_less(self):
        for kind, (long, words) in LEFT.items():
            with self.subTest(kind):
                found = tuple(self.table[kind][4:])
                places = f"scripts/tool readability --list --kind '{kind}' has the places"
                self.assertLessEqual(found[0], long, f"sentences of more than 35 words: {places}")
                self.assertLessEqual(found[1], words, f"words of words.txt: {places}")
                self.assertEqual(found, (long, words), f"fewer are left: lower LEFT['{kind}'] to {found}")

    def test_the_means_are_below_20_words(self):
        for kind, row in self.table.items():
            with self.subTest(kind):
                self.assertLess(row[2], 20)


class Tool(unittest.TestCase):
    def tool(self, *arguments):
        return subprocess.run(
            [SOURCE / "scripts" / "tool", "readability", *arguments],
            capture_output=True,
            text=True,
            check=False,
            env=CLEAN,
        )

    def test_figures(self):
        table = figures(found("docs/guide/x.md", PAGE), word_list(), 7)
        self.assertEqual(table["pages: guide"], table["pages"])
        self.assertEqual(table["pages"], [1, 4, 6.75, 8, 1, 2])

    def test_table_and_list(self):
        done = self.tool("--list", "--above", "5", "LICENSE", "CONTRIBUTING.md")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, r"CONTRIBUTING.md:\d+: \d+ words: ")
        self.assertRegex(done.stdout, r"(?m)^pages: others +1 +\d+ +\d+\.\d +\d+ +\d+ +\d+$")

    def test_a_file_that_is_not_there(self):
        done = self.tool("nowhere.md")
        said = f"readability: nowhere.md: no such file in {SOURCE}; paths begin at the top folder\n"
        self.assertEqual((done.returncode, done.stdout, done.stderr), (2, "", said))


if __name__ == "__main__":
    unittest.main()
