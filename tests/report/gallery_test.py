#!/usr/bin/env python3
"""The gallery of the repository's own reports: scripts/tool gallery."""

import re
import subprocess
import unittest

from harness import CAPSOC, CLEAN, SOURCE
from report_test import Seen

CTEST = {"name": "gallery", "timeout": 300}


def gallery(*arguments):
    return subprocess.run(
        [SOURCE / "scripts" / "tool", "gallery", *arguments, "--capsoc", CAPSOC],
        capture_output=True,
        text=True,
        check=False,
        env=CLEAN,
    )


class Gallery(Seen):
    def test_an_entry_has_the_answer_a_plot_and_the_commands(self):
        folder = self.folder / "gallery"
        done = gallery(folder, "--only", "run", "--only", "side_by_side")
        self.assertEqual(done.returncode, 0, done.stderr)
        page = folder / "index.html"
        self.browser.open(page)
        entries = self.browser.run(
            """return [...document.querySelectorAll('article')].map((a) => ({id: a.id, link: a.querySelector('h2 a').getAttribute('href'),
              answer: a.querySelector('.answer').textContent, key: a.querySelectorAll('.key dd').length,
              drawn: a.querySelector('img').naturalWidth, commands: a.querySelector('pre').textContent}))"""
        )
        self.assertEqual([entry["id"] for entry in entries], ["run", "side_by_side"])
        for entry in entries:
            report = (folder / entry["link"]).read_text()
            self.assertIn(f">{entry['answer']}</span></p>", report)
            self.assertGreaterEqual(entry["key"], 3)
            self.assertGreater(entry["drawn"], 300)
        self.assertEqual(entries[0]["commands"], "capsoc run --curves --json run.json --html run.html")
        self.assertTrue(entries[1]["answer"].startswith("The answers agree: pass, exit 0; the bound is "))
        for dark in (False, True):
            for width in (400, 1200):
                self.browser.emulate(width=width, dark=dark)
                self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width)
        self.browser.emulate(width=1200, dark=False)
        self.assertEqual(self.browser.console(), [])
        for request in self.browser.requests():
            self.assertTrue(request.startswith((folder.resolve().as_uri(), "data:")), request)
        first = page.read_bytes()
        self.assertEqual(gallery(folder, "--only", "run", "--only", "side_by_side").returncode, 0)
        self.assertEqual(page.read_bytes(), first)

    def test_every_command_of_it_is_in_the_source_tree(self):
        """Files that it names exist, and so do its figures."""
        text = (SOURCE / "scripts" / "capsoc_tools" / "release" / "gallery.py").read_text()
        figures = subprocess.run(
            [CAPSOC, "report", "--list-figures"], capture_output=True, text=True, check=True
        ).stdout
        known = {line.split()[0] for line in figures.splitlines()}
        named = set(re.findall(r'^        "([a-z0-9]+-[a-z0-9-]+)",$', text, re.MULTILINE))
        self.assertGreater(len(named), 5)
        self.assertLessEqual(named, known)
        self.assertTrue((SOURCE / "campaigns" / "small.toml").is_file())

    def test_what_is_wrong_is_a_sentence(self):
        for arguments, code, expected in (
            ((self.folder / "x", "--only", "nothing"), 2, "invalid choice: 'nothing'"),
            (("/dev/null/x", "--only", "run"), 1, "gallery: "),
        ):
            done = gallery(*arguments)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(expected, done.stderr)
            self.assertNotIn("Traceback", done.stderr)


if __name__ == "__main__":
    unittest.main()
