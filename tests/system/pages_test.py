#!/usr/bin/env python3
"""The pages that have commands: the commands are run, and print what the pages say.

A code block "```sh run" is run from a folder with the project's folders in it, the blocks of a page one after the
other, each ending with 0. Every line of a block "```text printed" except "..." is a line of what the block before it
printed. The test also plots the picture in the README.
"""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import BUILD, CAPSOC, SOURCE, agree, is_firmware_of_the_pages

CTEST = {"name": "pages", "timeout": 600}

DOCS = SOURCE / "docs"


def blocks(page):
    """The fenced blocks of a page: what stands after the fence, the text, and the line."""
    text = page.read_text()
    found = re.finditer(r"^```([^\n]*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    return [(m[1], m[2], text[: m.start()].count("\n") + 1) for m in found]


class Pages(unittest.TestCase):
    """One test for each page with commands."""

    def run_page(self, name):
        environment = {k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_")}
        environment["PATH"] = f"{BUILD}:{environment['PATH']}"
        ran, printed = 0, None
        with tempfile.TemporaryDirectory() as folder:
            for part in ("traces", "firmware", "tests", "models", "rtl", "platform", "scripts"):
                (Path(folder) / part).symlink_to(SOURCE / part)
            (Path(folder) / "build").symlink_to(BUILD)
            for kind, text, line in blocks(DOCS / name):
                where = f"docs/{name}:{line}"
                if kind == "sh run":
                    process = subprocess.run(
                        ["bash", "-euo", "pipefail", "-c", text],
                        cwd=folder,
                        env=environment,
                        text=True,
                        stdin=subprocess.DEVNULL,
                        stdout=subprocess.PIPE,
                        stderr=subprocess.STDOUT,
                        timeout=300,
                        check=False,
                    )
                    printed = process.stdout.splitlines()
                    self.assertEqual(process.returncode, 0, f"{where}:\n{process.stdout}")
                    ran += 1
                elif kind == "text printed":
                    self.assertIsNotNone(printed, f"{where}: nothing was run before")
                    for expected in text.splitlines():
                        if expected != "..." and not any(agree(line, expected) for line in printed):
                            self.assertIn(expected, printed, where)
                else:
                    self.assertIn(
                        kind, ("sh", "text", "c", "toml", "make", "cmake"), f"{where}: an unknown kind of block"
                    )
        self.assertGreater(ran, 2, name)

    def test_every_page_with_commands_is_run(self):
        text = Path(__file__).read_text(encoding="utf-8")
        run = set(re.findall(r'self.run_page\("([^"]+)"\)', text))
        having = {str(page.relative_to(DOCS)) for page in DOCS.rglob("*.md") if "\n```sh run\n" in page.read_text()}
        self.assertEqual(having, run)

    def test_protocol(self):
        self.run_page("reference/protocol.md")

    def test_for_virtual_platforms(self):
        self.run_page("guide/for-virtual-platforms.md")

    def test_for_firmware(self):
        self.run_page("guide/for-firmware.md")

    def test_for_rtl(self):
        self.run_page("guide/for-rtl.md")

    def test_for_sensors(self):
        self.run_page("guide/for-sensors.md")

    def test_safety(self):
        self.run_page("guide/safety.md")

    def test_view(self):
        self.run_page("guide/view.md")

    def test_papers(self):
        self.run_page("explanation/papers.md")


class Links(unittest.TestCase):
    """The README leads to the four roads, docs/README.md to every page, and no relative link leads nowhere."""

    def targets(self, page):
        return [t for t in re.findall(r"\]\(([^)\s]+)\)", page.read_text()) if not t.startswith(("http:", "https:"))]

    def test_the_readme_leads_to_the_four_roads_and_the_picture(self):
        targets = [t.split("#")[0] for t in self.targets(SOURCE / "README.md")]
        roads = sorted((DOCS / "guide").glob("for-*.md"))
        self.assertEqual(len(roads), 4)
        for page in roads:
            self.assertIn(f"docs/guide/{page.name}", targets)
        self.assertIn("docs/README.md", targets)
        self.assertIn("docs/images/main_job.svg", targets)

    def test_the_index_leads_to_every_page(self):
        targets = {t.split("#")[0] for t in self.targets(DOCS / "README.md")}
        pages = {str(page.relative_to(DOCS)) for page in DOCS.glob("*/*.md")}
        self.assertEqual(pages - targets, set())

    def test_every_page_links_the_glossary_and_the_index(self):
        pages = list(DOCS.glob("*/*.md"))
        self.assertGreater(len(pages), 30)
        for page in pages:
            targets = {(page.parent / t).resolve() for t in self.targets(page) if not t.startswith("#")}
            self.assertIn(DOCS / "README.md", targets, page)
            if page.name != "glossary.md":
                self.assertIn(DOCS / "reference" / "glossary.md", targets, page)

    def test_the_glossary_defines_each_term_once(self):
        rows = re.findall(
            r"^\| ([^|]+) \| ([^|]+) \| \[", (DOCS / "reference" / "glossary.md").read_text(), re.MULTILINE
        )
        terms = [term for row, _ in rows for term in row.split(", ")]
        self.assertGreater(len(terms), 50)
        self.assertEqual(len(terms), len(set(terms)))

    def test_every_link_leads_somewhere(self):
        pages = [page for page in SOURCE.glob("*.md") if page.is_file()]
        pages += [SOURCE / "traces" / "README.md", *(SOURCE / "platform").rglob("*.md"), *DOCS.rglob("*.md")]
        self.assertGreater(len(pages), 30)
        for page in sorted(pages):
            for target in self.targets(page):
                name, _, anchor = target.partition("#")
                file = (page.parent / name) if name else page
                self.assertTrue(file.exists(), f"{page}: {target}")
                if anchor:
                    headings = re.findall(r"^#+ (.*)$", file.read_text(), re.MULTILINE)
                    anchors = [re.sub(r"[^\w -]", "", h.lower()).replace(" ", "-") for h in headings]
                    self.assertIn(anchor, anchors, f"{page}: {target}")


class Picture(unittest.TestCase):
    """docs/images/main_job.svg is what the main job prints."""

    def test_it_is_drawn_anew_to_the_byte(self):
        with tempfile.TemporaryDirectory() as folder:
            drawn = Path(folder) / "main_job.svg"
            script = [SOURCE / "scripts" / "tool", "main_job_picture"]
            process = subprocess.run(
                [*script, "--capsoc", CAPSOC, "--output", drawn], capture_output=True, text=True, check=False
            )
            self.assertEqual(process.returncode, 0, process.stderr)
            pictures = [drawn.read_text(), (DOCS / "images" / "main_job.svg").read_text()]
            if not is_firmware_of_the_pages():
                pictures = [re.sub(r"\d+ instructions, \d+ cycles", "", picture) for picture in pictures]
            self.assertEqual(
                *pictures, "the main job prints something else: run scripts/tool main_job_picture and look at it"
            )


if __name__ == "__main__":
    unittest.main()
