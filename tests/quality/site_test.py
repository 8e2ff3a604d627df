#!/usr/bin/python3
"""scripts/tool site: the pages as a site whose links hold and whose search works from files, and as a book."""

import io
import re
import shutil
import subprocess
import unittest
from contextlib import redirect_stderr, redirect_stdout
from html.parser import HTMLParser
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.parse import unquote

from capsoc_tools import browser
from capsoc_tools.pages import book, site, sphinx
from capsoc_tools.pages.staging import LINK, Pages, anchors, without_code
from harness import CLEAN, SOURCE, Case

CTEST = {"name": "quality: site", "interpreter": "/usr/bin/python3"}

#: What a page loads by itself: the attribute of each element.
LOADED = {"script": "src", "link": "href", "img": "src", "iframe": "src", "source": "src", "object": "data"}
#: What a style loads.
FILES = re.compile(r"url\(\s*['\"]?([^'\")]+)|@import\s+['\"]([^'\"]+)")


class Page(HTMLParser):
    """The anchors of a page, its links, what it loads, and its text."""

    def __init__(self, text):
        super().__init__()
        self.anchors, self.links, self.loaded, self.words = [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.anchors += [values["id"]] if values.get("id") else []
        self.links += [values["href"]] if tag == "a" and values.get("href") else []
        self.loaded += [values[LOADED[tag]]] if values.get(LOADED.get(tag)) else []

    def handle_data(self, data):
        self.words.append(data)

    def text(self):
        return " ".join("".join(self.words).split())


def need(why):
    if why:
        raise AssertionError(why)


def is_address(target):
    return re.match(r"[a-z]+:|//", target) is not None


#: A small tree of pages.
TREE = {
    "CMakeLists.txt": "project(capsoc VERSION 1.2.3)\n",
    "README.md": "# Small\n\n[All pages](docs/README.md)\n",
    "docs/README.md": "# Pages\n\n## Guides\n\n- [one](guide/one.md)\n\n## Reference\n\n- [terms](reference/terms.md)\n"
    "- `registers.md`\n",
    "docs/guide/one.md": "# One\n\n[A term](../reference/terms.md#a-term)\n",
    "docs/reference/terms.md": "# Terms\n\n## A term\n\nIt is in `models/`.\n",
}


class Site(unittest.TestCase):
    """One site for all tests of the class."""

    @classmethod
    def setUpClass(cls):
        need(sphinx.missing())
        folder = TemporaryDirectory(prefix="capsoc-test-")
        cls.addClassCleanup(folder.cleanup)
        cls.site = Path(folder.name).resolve() / "site"
        done = subprocess.run(
            [SOURCE / "scripts" / "tool", "site", "--out", cls.site],
            capture_output=True,
            text=True,
            check=False,
            env=CLEAN,
        )
        said = (done.returncode, done.stdout, done.stderr)
        if said != (0, f"{cls.site / 'index.html'}\n", ""):
            raise AssertionError(said)
        cls.pages = {path: Page(path.read_text(encoding="utf-8")) for path in cls.site.rglob("*.html")}

    def test_every_page_is_there_with_its_headings(self):
        made = {path.relative_to(self.site).with_suffix("").as_posix() for path in self.pages}
        for path in [SOURCE / "README.md", *(SOURCE / "docs").rglob("*.md")]:
            name = path.relative_to(SOURCE).with_suffix("").as_posix().replace("README", "index")
            self.assertIn(name, made)
            text = path.read_text(encoding="utf-8")
            for heading in re.finditer(r"(?m)^#+ ([\w ]+)$", without_code(text)):
                self.assertIn(heading[1], self.pages[self.site / f"{name}.html"].text(), name)
        self.assertIn("docs/reference/registers", made)

    def test_every_link_leads_to_a_page_and_an_anchor(self):
        followed = 0
        for path, page in self.pages.items():
            self.assertEqual(len(page.anchors), len(set(page.anchors)), path)
            for target in page.links:
                if not is_address(target):
                    name, _, anchor = unquote(target).partition("#")
                    leads = (path.parent / name).resolve() if name else path
                    self.assertTrue(leads.is_file() and leads.is_relative_to(self.site), f"{path}: {target}")
                    if anchor and leads.suffix == ".html":
                        self.assertIn(anchor, self.pages[leads].anchors, f"{path}: {target}")
                        followed += 1
        self.assertGreater(followed, 500)

    def test_nothing_comes_from_a_network(self):
        for path, page in self.pages.items():
            self.assertGreater(len(page.loaded), 3, path)
            for target in page.loaded:
                name = re.split("[?#]", unquote(target))[0]
                self.assertFalse(is_address(target), f"{path}: {target}")
                self.assertTrue((path.parent / name).exists(), f"{path}: {target}")
        styles = list(self.site.rglob("*.css"))
        self.assertGreater(len(styles), 3)
        for path in styles:
            for found in FILES.findall(path.read_text(encoding="utf-8")):
                target = found[0] or found[1]
                if not target.startswith("data:"):
                    self.assertFalse(is_address(target), f"{path}: {target}")
                    name = re.split("[?#]", target)[0]
                    self.assertTrue((path.parent / name).is_file(), f"{path}: {target}")

    def test_pages_are_listed_in_the_order_of_the_index(self):
        text = (SOURCE / "docs" / "README.md").read_text(encoding="utf-8")
        kinds = re.findall(r"(?m)^## (.*)$", text)
        self.assertEqual(kinds, ["Start here", "Guides", "Reference", "Explanation", "Developer"])
        shown = self.pages[self.site / "index.html"]
        places = [shown.text().index(kind) for kind in kinds]
        self.assertEqual(places, sorted(places))
        listed = re.findall(r"\]\(((?:guide|reference|explanation|developer)/[\w-]+)\.md\)", text)
        expected = [f"docs/{name}.html" for name in listed]
        order = [target for target in dict.fromkeys(shown.links) if target in expected]
        self.assertEqual([name for name in order if "registers" not in name], expected)

    def test_layers_are_a_picture_and_other_blocks_are_code(self):
        architecture = self.site / "docs" / "explanation" / "architecture.html"
        (picture,) = [name for name in self.pages[architecture].loaded if "layers" in name]
        text = (architecture.parent / picture).read_text(encoding="utf-8")
        self.assertIn("<svg ", text)
        block = re.search(r"(?s)```layers\n(.*?)```", (SOURCE / "docs/explanation/architecture.md").read_text())[1]
        self.assertEqual(re.findall(r"<text[^>]*>([^<]*)<", text), block.split())
        page = (self.site / "docs" / "guide" / "for-rtl.html").read_text(encoding="utf-8")
        self.assertIn('<div class="highlight-sh ', page)
        self.assertIn('<div class="highlight-text ', page)

    def test_a_second_time_gives_the_same_bytes(self):
        with TemporaryDirectory(prefix="capsoc-test-again-") as folder:
            again = Path(folder) / "elsewhere"
            sphinx.build(SOURCE, "html", again)
            contents = [
                {path.relative_to(top): path.read_bytes() for path in top.rglob("*") if path.is_file()}
                for top in (self.site, again)
            ]
        self.assertEqual(contents[0].keys(), contents[1].keys())
        for name, content in contents[0].items():
            self.assertTrue(content == contents[1][name], name)

    def test_search_from_a_file(self):
        need(browser.missing())
        shown = browser.Browser()
        self.addCleanup(shown.close)
        shown.open(self.site / "docs" / "guide" / "checkpoints.html")
        shown.run(
            "const field = document.querySelector('input[name=q]'); field.value = arguments[0]; field.form.submit()",
            "glossary",
        )
        found = "return [...document.querySelectorAll('#search-results li a')].map(a => a.href)"
        shown.wait("return document.querySelectorAll('#search-results li a').length > 0", "results of the search")
        targets = [address.split("?")[0].split("#")[0] for address in shown.run(found)]
        self.assertIn((self.site / "docs" / "reference" / "glossary.html").as_uri(), targets)
        self.assertEqual(shown.console(), [])
        asked = shown.requests()
        self.assertGreater(len(asked), 5)
        self.assertEqual([address for address in asked if not address.startswith(self.site.as_uri())], [])


class Refused(Case):
    """What is wrong with pages ends with status 2 and a sentence that names the page and the link."""

    def setUp(self):
        super().setUp()
        need(sphinx.missing())
        self.tree = self.folder / "tree"
        for name, text in TREE.items():
            self.add(name, text)
        (self.tree / "models" / "registers").mkdir(parents=True)
        shutil.copy(SOURCE / "models" / "registers" / "capsoc.svd", self.tree / "models" / "registers")

    def made(self, *arguments):
        out, err = io.StringIO(), io.StringIO()
        with redirect_stdout(out), redirect_stderr(err):
            code = site.main(["--source", str(self.tree), "--out", str(self.folder / "site"), *arguments])
        return code, out.getvalue().encode(), err.getvalue()

    def add(self, name, text):
        path = self.tree / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text((path.read_text() if path.exists() else "") + text)

    def check(self, *words):
        self.check_refused(*self.made(), *words)
        self.assertFalse((self.folder / "site").exists())

    def test_what_is_right_is_made(self):
        code, _, said = self.made()
        self.assertEqual((code, said), (0, ""))
        self.assertIn("1.2.3", (self.folder / "site" / "index.html").read_text())

    def test_a_page_that_is_not_there(self):
        self.add("docs/guide/one.md", "\nSee [this](nowhere.md#top).\n")
        self.check(
            "site: docs/guide/one.md:5: the link nowhere.md#top leads nowhere: there is no docs/guide/nowhere.md;"
        )

    def test_a_heading_that_is_not_there(self):
        self.add("docs/guide/one.md", "\nSee [this](../reference/terms.md#nothing).\n")
        self.check(
            "site: docs/guide/one.md:5: the link ../reference/terms.md#nothing leads nowhere", "has no heading #nothing"
        )

    def test_a_source_and_a_picture_that_are_not_there(self):
        self.add("docs/guide/one.md", "\n[it](../../models/nothing.h)\n")
        self.check("site: docs/guide/one.md:5: the link ../../models/nothing.h leads nowhere")
        (self.tree / "models" / "nothing.h").touch()
        self.add("docs/guide/one.md", "\n![it](../images/nothing.png)\n")
        self.check("site: docs/guide/one.md:7: the link ../images/nothing.png leads nowhere")

    def test_a_page_in_no_list(self):
        self.add("docs/guide/alone.md", "# Alone\n")
        self.check("docs/guide/alone.md: is in no list of docs/README.md")

    def test_what_sphinx_warns_of(self):
        self.add("docs/guide/one.md", "\n#### Three levels down\n")
        code, _, said = self.made()
        self.assertEqual(code, 2)
        self.assertRegex(said, r"^site: docs/guide/one\.md:5: WARNING: ")
        self.assertNotIn(str(self.folder), said)

    def test_a_folder_with_other_files_is_left_alone(self):
        out = self.folder / "site"
        out.mkdir()
        (out / "mine.txt").touch()
        code, _, said = self.made()
        self.assertEqual((code, said), (2, f"site: {out}: holds files that are no site; name another folder\n"))
        self.assertEqual([path.name for path in out.iterdir()], ["mine.txt"])


class Staging(unittest.TestCase):
    def test_anchors_are_those_of_github(self):
        text = "# One `code` & [link](x.md)\n\n## Two, twice\n\n## Two, twice\n\n```sh run\n# no heading\n```\n"
        self.assertEqual(anchors(text), {"one-code--link", "two-twice", "two-twice-1"})

    def test_links_in_code_are_left_alone(self):
        text = "[a](b.md) `[c](d.md)`\n\n    [e](f.md)\n\n```\n[g](h.md)\n```\n[`i`](j.md)\n"
        self.assertEqual([link[3] for link in LINK.finditer(without_code(text))], ["b.md", "j.md"])

    def test_sources_are_named_and_pages_are_linked(self):
        pages = Pages(SOURCE)
        fitted = pages.fitted("docs/guide/view.md", False, "the list", "../../models/coprocessor/nodes.def")
        self.assertEqual(fitted, "the list (`models/coprocessor/nodes.def`)")
        fitted = pages.fitted("docs/guide/view.md", False, "all", "../README.md#guides")
        self.assertEqual(fitted, "[all](../index.md#guides)")
        fitted = pages.fitted("docs/guide/view.md", False, "it", "https://example.org/")
        self.assertEqual(fitted, "[it](https://example.org/)")


class Book(Case):
    def setUp(self):
        super().setUp()
        need(sphinx.missing() or browser.missing())
        need(
            None
            if shutil.which("pdftotext")
            else "pdftotext is not installed; install poppler-utils: ./scripts/setup test"
        )

    def test_all_pages_are_printed(self):
        """Its links lead to anchors that are there once, and the PDF has the title of every page."""
        sphinx.build(SOURCE, "book", self.folder / "book")
        page = Page((self.folder / "book" / "index.html").read_text(encoding="utf-8"))
        self.assertEqual(len(page.anchors), len(set(page.anchors)))
        inner = [target[1:] for target in page.links if target.startswith("#") and target != "#"]
        self.assertGreater(len(inner), 200)
        self.assertEqual(set(map(unquote, inner)) - set(page.anchors), set())
        self.assertEqual([target for target in page.links if not target.startswith("#") and not is_address(target)], [])
        self.assertIn("docs/explanation/verdicts:conditions-of-a-pass", inner)
        self.assertIn("document-docs/reference/registers", page.anchors)
        pdf = book.printed(self.folder / "book" / "index.html")
        self.assertTrue(pdf.startswith(b"%PDF-") and pdf.rstrip().endswith(b"%%EOF"))
        self.assertGreater(len(re.findall(rb"/Type /Page\b", pdf)), 100)
        self.assertNotIn(b"(D:20", pdf)
        (self.folder / "book.pdf").write_bytes(pdf)
        done = subprocess.run(
            ["pdftotext", self.folder / "book.pdf", "-"], capture_output=True, text=True, check=True, env=CLEAN
        )
        text = re.sub(r"\s+", "", done.stdout)
        for name, page in Pages(SOURCE).texts.items():
            title = re.search(r"(?m)^# (.*)$", page)[1].replace("`", "")
            self.assertTrue(re.sub(r"\s+", "", title) in text, name)


if __name__ == "__main__":
    unittest.main()
