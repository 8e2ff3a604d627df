#!/usr/bin/env python3
"""The layers of docs/explanation/architecture.md: which folder may include which, and that no includes form a ring."""

import re
import unittest
from collections import defaultdict

from harness import SOURCE

CTEST = {"name": "quality: layers", "whole": True}

#: Where an include is looked for (CMakeLists.txt), in addition to the folder of the file itself.
ROOTS = [
    SOURCE / root for root in ("platform", "platform/simulation", "platform/experiments", "platform/cli", "models")
]


def block(name):
    """The lines of the block ```name of the page."""
    page = (SOURCE / "docs" / "explanation" / "architecture.md").read_text(encoding="utf-8")
    return re.search(rf"^```{name}\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)[1].splitlines()


def layers():
    """Folder -> line in the block ```layers, counted from the top."""
    return {folder: number for number, line in enumerate(block("layers")) for folder in line.split()}


def kinds():
    """Folder of models/ -> its kind, from the block ```kinds."""
    return {folder: kind for kind, *folders in map(str.split, block("kinds")) for folder in folders}


def sources():
    return [
        path
        for top in ("models", "platform")
        for path in sorted((SOURCE / top).rglob("*"))
        if path.suffix in (".h", ".cpp", ".def")
    ]


def includes(path):
    """(line number, file) of what a file includes of this tree."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if found := re.match(r'\s*#\s*include "([^"]+)"', line):
            for root in (path.parent, *ROOTS):
                if (root / found[1]).is_file():
                    yield number, (root / found[1]).resolve()
                    break


def rings(graph):
    """The strongly connected components of more than one node (Tarjan's algorithm)."""
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in graph[node]:
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            ring = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            found.append(ring)

    for node in sorted(graph):
        if node not in index:
            visit(node)
    return [ring for ring in found if len(ring) > 1]


class Layers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.layers = layers()

    def folder(self, path):
        """The longest one of the page that a file lies in."""
        parts = path.relative_to(SOURCE).parts
        names = ["/".join(parts[:length]) for length in range(len(parts) - 1, 0, -1)]
        return next((name for name in names if name in self.layers), None)

    def test_every_folder_has_its_line(self):
        for path in sources():
            self.assertIsNotNone(
                self.folder(path), f"{path}: its folder is in no line of docs/explanation/architecture.md"
            )
        for folder in self.layers:
            self.assertTrue((SOURCE / folder).is_dir(), f"{folder}: is no folder")

    def test_includes_go_downwards(self):
        for path in sources():
            for number, other in includes(path):
                mine, its = self.folder(path), self.folder(other)
                self.assertTrue(
                    mine == its or self.layers[mine] < self.layers[its],
                    f"{path.relative_to(SOURCE)}:{number}: {mine} may not include {its} "
                    "(docs/explanation/architecture.md)",
                )

    def test_models_by_kind(self):
        """A model includes its own kind and the base."""
        kind_of = kinds()
        folders = {f"models/{path.name}" for path in (SOURCE / "models").iterdir() if path.is_dir()}
        self.assertEqual(set(kind_of), folders, "the block kinds of docs/explanation/architecture.md")
        self.assertEqual(set(kind_of.values()), {"hardware", "world", "identification", "base"})
        for path in sources():
            mine = kind_of.get("/".join(path.relative_to(SOURCE).parts[:2]))
            for number, other in includes(path) if mine else ():
                its = kind_of.get("/".join(other.relative_to(SOURCE).parts[:2]))
                self.assertIn(
                    its,
                    (mine, "base"),
                    f"{path.relative_to(SOURCE)}:{number}: {mine} may not include {its or 'the platform'}",
                )

    def test_rings_of_rooms(self):
        graph = defaultdict(set)
        for path in sources():
            room = path.with_suffix("")
            graph[room] |= {other.with_suffix("") for _, other in includes(path)} - {room}
            for other in list(graph[room]):
                graph.setdefault(other, set())
        for ring in rings(graph):
            names = ", ".join(sorted(str(room.relative_to(SOURCE)) for room in ring))
            self.assertLessEqual(len(ring), 2, f"these include each other in a ring: {names}")


if __name__ == "__main__":
    unittest.main()
