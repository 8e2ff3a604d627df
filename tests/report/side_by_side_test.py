#!/usr/bin/env python3
"""Two results side by side: the terminal and the page say the same, and what differs comes first."""

import json
import re
import tempfile
import unittest
from pathlib import Path

from harness import SOURCE
from report_test import HOSTILE, ReportCase, Seen, capsoc

CTEST = {"name": "side by side", "timeout": 300}

#: A short regression.
COUNTS = ("--samples", "200", "--accesses", "100")

#: What a page shows of its colours: those of lines with and without a variant, of the legend and of A and B.
COLOURS = """
    const style = (e, pseudo) => getComputedStyle(e, pseudo);
    const legend = [...document.querySelectorAll('#figure-angle-error .legend li:not(.mark)')];
    return {lines: [...document.querySelectorAll('#figure-angle-error .curve')].slice(0, 4).map((e) => style(e).stroke),
      legend: legend.map((li) => [li.textContent, style(li, '::before').borderTopColor, style(li, '::before').borderTopStyle]),
      key: [style(document.querySelector('.key .a')).borderLeftColor, style(document.querySelector('.key .b')).borderLeftColor]};"""


def results(folder):
    """Two runs that differ in the arithmetic."""
    precise, paper = folder / "precise.json", folder / "paper.json"
    for file, options in ((precise, ()), (paper, ("--arithmetic", "paper"))):
        done = capsoc("run", *options, "--curves", "--json", file)
        assert done.returncode == 0, done.stderr
    return precise, paper


def luminance(colour):
    """Of "rgb(r, g, b)" or "#rrggbb", 0 to 1."""
    if colour.startswith("#"):
        parts = [int(colour[at : at + 2], 16) for at in (1, 3, 5)]
    else:
        parts = [int(part) for part in re.findall(r"\d+", colour)[:3]]
    linear = [p / 255 / 12.92 if p / 255 <= 0.03928 else ((p / 255 + 0.055) / 1.055) ** 2.4 for p in parts]
    return sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear))


class Pages(Seen):
    """The page of two runs."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.a, cls.b = results(Path(folder.name))
        cls.html = Path(folder.name) / "both.html"
        cls.said = capsoc("report", cls.a, cls.b, "--html", cls.html).stdout.decode()

    def test_it_keeps_what_every_report_keeps(self):
        self.check_page(self.html)
        again = self.folder / "again.html"
        self.assertEqual(capsoc("report", self.a, self.b, "--html", again).stdout.decode(), self.said)
        self.assertEqual(again.read_bytes(), self.html.read_bytes())

    def test_its_first_screen_is_the_answer_in_the_words_of_the_terminal(self):
        self.open(self.html)
        said, style, _ = self.answer()
        self.assertEqual(said, self.said.splitlines()[2])
        self.assertRegex(said, r"^The answers agree: pass, exit 0; the bound is \S+ deg in A and \S+ deg in B\. 2 of ")
        self.assertEqual(style, "good")
        a, b = (json.loads(file.read_text())["verdict"]["bound_deg"] for file in (self.a, self.b))
        bound = self.browser.run(
            """const d = [...document.querySelectorAll('.key div')].find((d) => d.textContent.startsWith("the program's own"));
            return [...d.querySelectorAll('dd')].map((e) => [e.className, e.textContent, e.title])"""
        )
        self.assertEqual(
            bound,
            [
                ["a", f"{a:.3g} deg", f"precise.json: {a!r} deg"],
                ["b", f"{b:.3g} deg", f"paper.json: {b!r} deg"],
            ],
        )
        tables = self.browser.run(
            """return [...document.querySelectorAll('section')].slice(0, 2).flatMap((s) => [...s.querySelectorAll('.scroll > table')])
              .filter((t) => t.caption.textContent.includes('differ')).map((t) => [t.caption.textContent, [...t.tBodies[0].rows].map((r) => r.cells[0].textContent)])"""
        )
        names = [name for _, rows in tables for name in rows]
        self.assertEqual(names[0], "verdict.bound_deg")
        self.assertIn("configuration.coprocessor.arithmetic", names)
        for caption, rows in tables:
            self.assertIn("\n" + caption.partition(";")[0] + "\n", self.said)
            for name in rows:
                self.assertRegex(self.said, rf"(?m)^  {re.escape(name)} ")

    def test_exact_values_are_under_the_pointer(self):
        self.open(self.html)
        row = self.browser.run(
            """const c = [...document.querySelectorAll('td')].find((c) => c.textContent === 'parameters.beta.value');
            return [...c.parentElement.cells].map((c) => [c.textContent, c.title])"""
        )
        a, b = (json.loads(file.read_text())["parameters"]["beta"]["value"] for file in (self.a, self.b))
        self.assertEqual([row[1][0], row[2][1], row[3][1]], ["rad", repr(a), repr(b)])
        self.assertEqual(row[4][0], f"{b - a:+.3g}")
        self.assertEqual(row[5][0], f"{100 * (b - a) / a:+.3g} %")

    def test_each_result_has_its_colour_in_light_and_dark(self):
        self.open(self.html)
        names = [series["name"] for series in self.figures()["angle-error"]["series"]]
        self.assertEqual([name.split(", ")[-1] for name in names], ["precise.json"] * 2 + ["paper.json"] * 2)
        for dark in (False, True):
            self.browser.emulate(width=1200, dark=dark)
            found = self.browser.run(COLOURS)
            lines, legend = found["lines"], found["legend"]
            self.assertEqual([lines[0], lines[2]], [lines[1], lines[3]])
            self.assertEqual([each[0] for each in legend], names)
            self.assertEqual([each[2] for each in legend], ["solid", "dashed", "solid", "dashed"])
            self.assertEqual([legend[0][1], legend[2][1]], found["key"])
            for colour in found["key"]:
                self.assertGreater(abs(luminance(colour) - (0.01 if dark else 1)), 0.2, found)
            # Blue and orange: the pair that the usual colour blindnesses leave apart.
            blue, orange = ([int(part) for part in re.findall(r"\d+", each)[:3]] for each in found["key"])
            self.assertGreater(blue[2], blue[0])
            self.assertGreater(orange[0], orange[2])
        self.browser.emulate(width=1200, dark=False)

    def test_what_is_the_same_is_one_line(self):
        self.open(self.html)
        line = self.said.splitlines()[-1]
        summary = self.browser.run(
            """const d = [...document.querySelectorAll('main details')];
            return d.map((e) => [e.open, e.firstChild.textContent, e.querySelectorAll('tbody tr').length])"""
        )
        self.assertEqual([[False, line.rstrip(".")]], [each[:2] for each in summary])
        values, settings = (int(re.search(rf"(\d+) {what}", line)[1]) for what in ("value", "setting"))
        self.assertEqual(summary[0][2], values + settings)

    def test_hostile_texts_stay_texts(self):
        results = []
        for text in ("plain", "".join(HOSTILE)):
            results.append(
                {
                    "command": "capsoc run " + text,
                    "configuration": {text: "1", "x": text},
                    "uart0": {"text": text},
                    "curves": {f"status.{text}": {"x": [0, 1], "y": [0, 1]}},
                }
            )
        page = self.report(*results)
        self.open(page)
        found = self.browser.run(
            """return {hacked: window.hacked ?? null, scripts: document.scripts.length, shown: document.body.textContent,
            strange: document.querySelectorAll('img, iframe, object, embed, base, form, svg:not(.plot > svg:first-child, .plot > svg:first-child > .area), body link, body style').length}"""
        )
        self.assertEqual([found[key] for key in ("hacked", "scripts", "strange")], [None, 2, 0])
        self.assertIn(HOSTILE[0], found["shown"])


class Commands(ReportCase):
    """What the command says and ends with."""

    def two(self, *changes):
        """Files of a small result with changes."""
        files = []
        for number, change in enumerate(changes):
            files.append(self.folder / f"{number}.json")
            files[-1].write_text(json.dumps({"command": "capsoc run", "exit": {"code": 0, "reason": "x"}, **change}))
        return files

    def test_the_same(self):
        a, b = self.two({"time": {"wall_s": 1}}, {"time": {"wall_s": 2}})
        for files in ((a, b), (a, a)):
            done = capsoc("report", *files)
            self.done(done)
            self.assertIn("The two results are the same in all 3 values: exit 0.\n", done.stdout.decode())
        self.assertIn("A  0.json (A)\nB  0.json (B)\n", done.stdout.decode())

    def test_files_of_one_name_are_told_apart_by_their_folders(self):
        files = []
        for name in "xy":
            files.append(self.folder / name / "r.json")
            files[-1].parent.mkdir()
            files[-1].write_text('{"command": "capsoc run"}')
        said = capsoc("report", *files).stdout.decode()
        self.assertTrue(said.startswith(f"A  {files[0]}\nB  {files[1]}\n"), said)

    def test_answers_that_differ(self):
        done = capsoc("report", *self.two({}, {"exit": {"code": 1, "reason": "y"}}))
        self.done(done)
        self.assertIn("The answers differ: exit 0 in A, exit 1 in B.", done.stdout.decode())

    def test_what_is_not_compared(self):
        a, b = self.two({}, {"command": "capsoc fit x"})
        broken = self.folder / "broken.json"
        broken.write_text("{")
        for files, expected in (
            ((a, b), "two results of one command are compared, and here is one of run and one of fit"),
            ((a, a, a), "only two results of one command are compared"),
            ((a,), "only two results of one command are compared"),
            ((a, broken), "broken.json: is not JSON"),
            ((self.folder / "none.json", a), "none.json"),
        ):
            with self.subTest(files=files):
                done = capsoc("report", *files)
                self.assertEqual((done.returncode, done.stdout), (2, b""))
                self.assertEqual(len(done.stderr.decode().splitlines()), 1)
                self.assertIn(expected, done.stderr.decode())

    def test_other_kinds_and_more_files_still_make_a_page(self):
        a, b = self.two({}, {"command": "capsoc fit x"})
        for files in ((a, b), (a, a, a)):
            page = self.folder / "page.html"
            done = capsoc("report", *files, "--html", page)
            self.done(done)
            self.assertEqual(done.stdout, b"")
            self.assertIn("<h1>capsoc run", page.read_text())

    def test_regressions_of_two_seeds(self):
        """Thousands of values: the terminal has the first ones and says how many more there are."""
        files = []
        for seed in (1, 2):
            files.append(self.folder / f"{seed}.json")
            options = ("--scenario", "noise", "--arithmetic", "precise", "--first-seed", seed, "--seeds", "1", *COUNTS)
            self.done(capsoc("regress", *options, "--json", files[-1]))
        page = self.folder / "page.html"
        done = capsoc("report", *files, "--html", page)
        self.done(done)
        said = done.stdout.decode()
        self.assertIn("The answers agree: no difference. 2 of ", said)
        self.assertRegex(said, r"\n  and \d+ more; --html FILE has them\n")
        self.assertLess(len(said.splitlines()), 80)


class Traces(ReportCase):
    """Fits of two recordings."""

    def test_two_fits(self):
        files = []
        for name in ("csfn_eq", "csfn_h3"):
            files.append(self.folder / f"{name}.json")
            self.done(capsoc("fit", SOURCE / "traces" / f"{name}.toml", "--json", files[-1]))
        said = capsoc("report", *files).stdout.decode()
        self.assertIn("The answers differ: identified in A, identified without a bound in B.", said)
        self.assertRegex(said, r"(?m)^  inputs.sensor.path +A: .*csfn_eq.toml$")


if __name__ == "__main__":
    unittest.main()
