"""The pages of the tree as sources for Sphinx: links made to fit, the order taken from docs/README.md."""

import os
import re
from collections import Counter
from functools import lru_cache
from pathlib import Path, PurePosixPath

from capsoc_tools.generate import registers
from capsoc_tools.pages.diagrams import drawn

INDEX = "docs/README.md"
#: The index names this page as code, since a build generates it.
REGISTERS = "docs/reference/registers.md"
IMAGES = (".png", ".svg")
CODE = re.compile(r"^```.*?^```[^\n]*$|(?<=\n\n)(?: {4}[^\n]*\n+)+|`[^`]+`|<!--.*?-->", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^)\s]+)\)")


class Faults(Exception):
    """What is wrong with the pages, a sentence each."""

    def __init__(self, sentences):
        super().__init__("\n".join(sentences))
        self.sentences = sentences


def without_code(text):
    """The text with its code and comments blanked, each character at its place."""
    return CODE.sub(lambda code: re.sub(r"[^\n]", "\0", code[0]), text)


@lru_cache(None)
def anchors(text):
    """The anchors that GitHub gives to the headings of a page."""
    seen, found = Counter(), set()
    for heading in re.finditer(r"(?m)^#+ (.*)$", without_code(text)):
        words = re.sub(r"\[([^\[\]]*)\]\([^)]*\)", r"\1", text[heading.start(1) : heading.end(1)])
        slug = re.sub(r"[^\w -]", "", words.strip().lower()).replace(" ", "-")
        found.add(f"{slug}-{seen[slug]}" if seen[slug] else slug)
        seen[slug] += 1
    return found


def staged_name(name):
    """Where a page lies for Sphinx: a folder's README.md is its index."""
    path = PurePosixPath(name)
    return str(path.with_name("index.md") if path.name == "README.md" else path)


class Pages:
    """The pages of a tree by their path from its top, and what is wrong with them."""

    def __init__(self, top):
        self.top = Path(top).resolve()
        self.faults = []
        self.images = set()
        self.texts = {"README.md": self.read("README.md")}
        for path in sorted((self.top / "docs").rglob("*.md")):
            name = path.relative_to(self.top).as_posix()
            self.texts[name] = self.read(name)
        self.texts[REGISTERS] = registers.texts(self.top / "models" / "registers" / "capsoc.svd")["registers.md"]
        self.texts[INDEX] = self.texts[INDEX].replace("`registers.md`", "[registers.md](reference/registers.md)")
        for _, _, target, _ in self.links(INDEX):
            name, _ = self.place(INDEX, target)
            if name and name.endswith(".md") and name not in self.texts and (self.top / name).is_file():
                self.texts[name] = self.read(name)

    def read(self, name):
        return (self.top / name).read_text(encoding="utf-8")

    def links(self, name):
        """(whether it is an image, its words, its target, (start, end)) of each link outside of code."""
        text = self.texts[name]
        for link in LINK.finditer(without_code(text)):
            yield bool(link[1]), text[link.start(2) : link.end(2)], link[3], link.span()

    def place(self, name, target):
        """(path from the top, anchor) of what a relative link leads to; (None, "") for an address elsewhere."""
        if re.match(r"[a-z]+:", target):
            return None, ""
        path, _, anchor = target.partition("#")
        folder = PurePosixPath(name).parent
        return (os.path.normpath(folder / path) if path else name), anchor

    def navigation(self):
        """(kind, names of its pages) in the order of docs/README.md; a page belongs to the first list it is in."""
        text, groups, placed = self.texts[INDEX], [("", [INDEX])], {"README.md", INDEX}
        headings = [(found.start(), found[1]) for found in re.finditer(r"(?m)^## (.*)$", text)]
        for (start, kind), (end, _) in zip(headings, [*headings[1:], (len(text), "")]):
            groups.append((kind, []))
            for _, _, target, (place, _) in self.links(INDEX):
                name, _ = self.place(INDEX, target)
                if start < place < end and name in self.texts and name not in placed:
                    placed.add(name)
                    groups[-1][1].append(name)
        for name in sorted(self.texts.keys() - placed):
            if PurePosixPath(name).parent.name != "docs":  # docs/coprocessor.md stays for links from elsewhere
                self.faults.append(f"{name}: is in no list of {INDEX}; add a line to the list of its kind")
        return [group for group in groups if group[1]], self.texts.keys() - placed

    def fitted(self, name, is_image, words, target):
        """The text of a link in the site, and its target checked."""
        mark = "!" if is_image else ""
        path, anchor = self.place(name, target)
        if path is None:
            return f"{mark}[{words}]({target})"
        if path in self.texts:
            if anchor and anchor not in anchors(self.texts[path]):
                raise LookupError(f"{path} has no heading #{anchor}")
            relative = os.path.relpath(staged_name(path), PurePosixPath(name).parent)
            return f"{mark}[{words}]({relative}{'#' + anchor if anchor else ''})"
        if path.startswith("..") or not (self.top / path).exists():
            raise LookupError(f"there is no {path}")
        if path.endswith(IMAGES):
            self.images.add(path)
            return f"{mark}[{words}]({target})"
        return words if path in words else f"{words} (`{path}`)"  # the site has no sources

    def staged(self, name):
        """A page's text for Sphinx."""
        text, parts, done = self.texts[name], [], 0
        for is_image, words, target, (start, end) in self.links(name):
            parts.append(text[done:start])
            done = end
            try:
                parts.append(self.fitted(name, is_image, words, target))
            except LookupError as fault:
                line = text[:start].count("\n") + 1
                self.faults.append(f"{name}:{line}: the link {target} leads nowhere: {fault.args[0]}; correct it")
        return "".join([*parts, text[done:]])

    def write(self, folder):
        """Writes the sources for Sphinx into an empty folder, or raises Faults."""
        groups, unlisted = self.navigation()
        texts = {name: self.staged(name) for name in self.texts}
        if self.faults:
            raise Faults(self.faults)
        for name in unlisted:
            texts[name] = f"---\norphan: true\n---\n{texts[name]}"
        for kind, names in groups:
            entries = "\n".join(staged_name(name).removesuffix(".md") for name in names)
            caption = f":caption: {kind}\n" if kind else ""
            texts["README.md"] += f"\n```{{toctree}}\n:hidden:\n{caption}\n{entries}\n```\n"
        for name, text in texts.items():
            path = folder / staged_name(name)
            path.parent.mkdir(parents=True, exist_ok=True)
            text, pictures = drawn(text)
            path.write_text(text, encoding="utf-8")
            for picture, content in pictures.items():
                (path.parent / picture).write_text(content, encoding="utf-8")
        for name in self.images:
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes((self.top / name).read_bytes())
