#!/usr/bin/env python3
"""Counts how hard the pages, comments and messages are to read: words a sentence, long sentences, listed words.

Sentences of fewer than five words are labels and not counted. `above` are the sentences of more than --above words,
`words` the occurrences of words.txt, which has the plain term for each.
"""

import argparse
import re
import sys
from collections import defaultdict
from pathlib import Path

from capsoc_tools.text.prose import SOURCE, passages, sentences, tracked

WORDS = Path(__file__).with_name("words.txt")


def word_list(path=WORDS):
    """(compiled pattern, plain term) for each line of the list."""
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.strip() and not line.startswith("#"):
            pattern, plain = line.split(" = ", 1)
            rows.append((re.compile(rf"(?<![\w-])(?:{pattern})(?![\w-])", re.IGNORECASE), plain))
    return rows


def all_passages(names=None):
    """The prose of the tree, or of these files of it."""
    for name in tracked() if names is None else names:
        if Path(name).suffix in (".md", ".cpp", ".h", ".c", ".def", ".sv", ".py"):
            yield from passages(name, (SOURCE / name).read_text(encoding="utf-8"))


def listed_words(found, words):
    """(passage, what stands there, plain term) for each listed word outside of code and of the targets of links."""
    for passage in found:
        text = re.sub(r"`[^`]*`|\]\([^)\s]*\)", " ", passage.text)
        for pattern, plain in words:
            for match in pattern.finditer(text):
                yield passage, match[0], plain


def long_sentences(found, above):
    """(passage, sentence, words) of the sentences with more words than `above`, the longest first."""
    all_of_them = ((passage, *each) for passage in found for each in sentences(passage))
    return sorted((each for each in all_of_them if each[2] > above), key=lambda each: -each[2])


def figures(found, words, above):
    """Kind -> [files, sentences, mean words of a sentence, most words, sentences above, listed words]."""
    by_kind = defaultdict(list)
    for passage in found:
        for kind in {passage.kind, passage.kind.split(":")[0]}:
            by_kind[kind].append(passage)
    table = {}
    for kind in sorted(by_kind):
        counts = [count for passage in by_kind[kind] for _, count in sentences(passage)] or [0]
        table[kind] = [
            len({passage.file for passage in by_kind[kind]}),
            len(counts),
            sum(counts) / len(counts),
            max(counts),
            sum(count > above for count in counts),
            sum(1 for _ in listed_words(by_kind[kind], words)),
        ]
    return table


def main(arguments):
    parser = argparse.ArgumentParser(prog="readability", description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("file", nargs="*", help="files of the tree, by their path from its top (all)")
    parser.add_argument("--above", type=int, default=35, metavar="WORDS", help="what a long sentence is (35)")
    parser.add_argument("--list", action="store_true", help="every long sentence and every listed word with its place")
    parser.add_argument("--kind", default="", help="only kinds that begin so: pages, pages: guide, comments, messages")
    options = parser.parse_args(arguments)
    for name in options.file:
        if not (SOURCE / name).is_file():
            print(f"readability: {name}: no such file in {SOURCE}; paths begin at the top folder", file=sys.stderr)
            return 2
    found = [each for each in all_passages(options.file or None) if each.kind.startswith(options.kind)]
    words = word_list()
    if options.list:
        for passage, sentence, count in long_sentences(found, options.above):
            print(f"{passage.file}:{passage.line}: {count} words: {sentence}")
        for passage, said, plain in listed_words(found, words):
            print(f"{passage.file}:{passage.line}: '{said}': {plain}")
    print(f"{'':<20} {'files':>6} {'sentences':>10} {'mean':>6} {'longest':>8} {'above':>6} {'words':>6}")
    for kind, (files, count, mean, most, above, listed) in figures(found, words, options.above).items():
        print(f"{kind:<20} {files:>6} {count:>10} {mean:>6.1f} {most:>8} {above:>6} {listed:>6}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
