#!/usr/bin/env python3
"""Reports: what a person sees, in a real browser without a network."""

import base64
import json
import math
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from capsoc_tools import browser
from harness import CAPSOC, CLEAN, Case, FIRMWARE, SOURCE

CTEST = {"name": "report", "timeout": 600}

HOSTILE = (
    "<script>window.hacked=1</script>",
    "</script><script>window.hacked=2</script>",
    "<img src=x onerror=window.hacked=3>",
    '"><svg onload=window.hacked=4>',
    "' onmouseover='window.hacked=5",
    "<!--",
    "-->",
    "]]>",
    "<iframe src=javascript:window.hacked=6>",
    "javascript:window.hacked=7",
    "</title><script>window.hacked=8</script>",
    "</style><script>window.hacked=9</script>",
    "</pre></textarea><script>window.hacked=10</script>",
    "&lt;script&gt;",
    "{{7*7}}",
    "${window.hacked=11}",
    "`;window.hacked=12//",
    "\\u003cscript\\u003e",
    "<math><mtext></form><form><mglyph><style></math><img src onerror=window.hacked=13>",
    "\u2028window.hacked=14\u2029",
    "<base href=https://example.org/>",
    "<meta http-equiv=refresh content=0;url=https://example.org>",
    "<link rel=stylesheet href=//example.org/x>",
    "\u202e<b>",
    "<a href=data:text/html,<script>window.hacked=15</script>>x</a>",
    "\x1b]0;title\x07",
    "\x00nul",
    "__proto__",
    "constructor",
)


def capsoc(*arguments, stdin=b""):
    return subprocess.run(
        [CAPSOC, *map(str, arguments)], capture_output=True, timeout=570, check=False, input=stdin, env=CLEAN
    )


#: What stands in each plot: data of its paths, and all of its ticks as markup.
PLOTS = """return Object.fromEntries([...document.querySelectorAll('figure[data-figure]')].map((f) => [f.dataset.figure, {
    curves: [...f.querySelectorAll('.plot .curve')].map((e) => e.getAttribute('d')),
    marks: [...f.querySelectorAll('.plot .mark')].map((e) => e.getAttribute('d')),
    spreads: [...f.querySelectorAll('.plot .spread')].map((e) => e.getAttribute('d')),
    ticks: f.querySelectorAll('.plot .ticks text').length, stops: f.plot.stops(), log: f.plot.log()[1],
    markup: [...f.querySelectorAll('.plot .ticks > *')].map((e) => e.outerHTML)}]))"""

#: A point in the data of a path, by the kind of the figure.
VERTEX = {"lines": "[Ml]", "steps": "[Mv]", "lanes": "[Mv]", "points": "M", "bars": "M"}


class ReportCase(Case):
    def done(self, process, code=0):
        self.assertEqual(process.returncode, code, process.stdout.decode() + process.stderr.decode())

    def report(self, *results, name="report.html"):
        """The page of results that are files or, as JSON, to be written."""
        page, files = self.folder / name, []
        for number, result in enumerate(results):
            if not isinstance(result, Path):
                files.append(self.folder / f"result{number}.json")
                files[-1].write_text(json.dumps(result))
            else:
                files.append(result)
        self.done(capsoc("report", *files, "--html", page))
        return page


class Seen(ReportCase):
    """Tests that open pages: one browser for a class, as new for each of its tests."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        if reason := browser.missing():
            raise AssertionError(reason)
        cls.browser = browser.Browser()
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        super().setUp()
        self.browser.fresh()

    def open(self, page):
        self.browser.open(page)
        self.browser.wait("return document.documentElement.dataset.ready", "the page's script has run")
        self.CLEAN(page)

    def CLEAN(self, page):
        self.assertEqual(self.browser.console(), [])
        self.assertLessEqual(set(self.browser.requests()), {page.resolve().as_uri()})

    def answer(self):
        """What the first screen says: the sentence and its style, the figures by label; the drawing is there, too."""
        found = self.browser.run(
            """const p = document.querySelector('.answer');
            return {said: [p.textContent, p.firstChild.className], key: [...document.querySelectorAll('.key div')].map((d) =>
              [d.querySelector('dt').textContent, d.querySelector('dd').textContent, d.querySelector('dd').title]),
              plot: document.querySelector('figure .plot').getBoundingClientRect().bottom}"""
        )
        self.assertLess(found["plot"], 900)
        return (*found["said"], {label: (text, exact) for label, text, exact in found["key"]})

    def figures(self):
        return self.browser.run("return JSON.parse(document.getElementById('figures').textContent)")

    def check_page(self, page):
        """What every report has to keep."""
        self.assertLess(page.stat().st_size, 3_000_000)
        self.open(page)
        self.points_are_there()
        self.names_are_there()
        for dark in (False, True):
            for width in (400, 800, 1400):
                self.browser.emulate(width=width, dark=dark)
                self.layout_holds(width, dark)
        self.browser.emulate(width=1200, dark=False)
        self.CLEAN(page)

    def points_are_there(self):
        figures = self.figures()
        self.assertGreater(len(figures), 0)
        drawn = self.browser.run(PLOTS)
        self.assertEqual(set(drawn), set(figures))
        for name, figure in figures.items():
            found, log = drawn[name], drawn[name]["log"]
            self.assertEqual(len(found["curves"]), len(figure["series"]), name)
            self.assertEqual(len(found["marks"]), len(figure["marks"]), name)
            self.assertGreater(found["ticks"], 1, name)
            for series, curve in zip(figure["series"], found["curves"]):
                shown = [y for y in series["y"] if y is not None and not (log and y == 0)]
                self.assertEqual(len(re.findall(VERTEX[figure["kind"]], curve)), len(shown), name)
            xs = [x for series in figure["series"] for x in series["x"]]
            if figure["marks"]:
                xs += [min(xs), max(xs)]
            points = sum(len(series["x"]) for series in figure["series"])
            self.assertEqual(found["stops"], points if figure["kind"] == "points" else len(set(xs)), name)
        # The script places curves and ticks as they were written: letter for letter.
        self.browser.run("document.querySelectorAll('figure[data-figure]').forEach((f) => f.plot.reset())")
        again = self.browser.run(PLOTS)
        for name, before in drawn.items():
            self.assertEqual(again[name], before, name)

    def layout_holds(self, width, dark):
        found = self.browser.run(
            """
            const inside = (e) => { const b = e.getBoundingClientRect(); return b.left >= -0.5 && b.right <= innerWidth + 0.5; };
            const colour = (c) => c.match(/[0-9.]+/g).map((n, i) => Number(n) * (c.startsWith('color(srgb') && i < 3 ? 255 : 1));
            const light = ([r, g, b]) => [r, g, b].map((c) => (c /= 255) <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
                .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
            const ratio = (a, b) => (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
            const back = (e) => { for (; e; e = e.parentElement) { const c = colour(getComputedStyle(e).backgroundColor); if (c[3] !== 0) return light(c); } return 1; };
            const texts = [...document.querySelectorAll('h1, h2, h3, p, td, th, figcaption, a, button, pre, li, .plot text')];
            return {
              wide: document.documentElement.scrollWidth, inner: innerWidth,
              outside: [...document.querySelectorAll('section, figure, .plot, figcaption, .tools, pre, .scroll')].filter((e) => !inside(e)).length,
              flat: [...document.querySelectorAll('.plot')].filter((e) => e.clientHeight < 100 || e.clientWidth < 200).length,
              back: light(colour(getComputedStyle(document.body).backgroundColor)),
              worst: Math.min(...texts.filter((e) => e.textContent.trim() && (e.offsetParent || e.ownerSVGElement)).map((e) => ratio(light(colour(getComputedStyle(e).color)), back(e)))),
            };"""
        )
        where = f"width {width}, {'dark' if dark else 'light'}: {found}"
        self.assertEqual(found["inner"], width, where)
        self.assertLessEqual(found["wide"], width, where)
        self.assertEqual(found["outside"], 0, where)
        self.assertEqual(found["flat"], 0, where)
        (self.assertLess if dark else self.assertGreater)(found["back"], 0.1 if dark else 0.9, where)
        self.assertGreaterEqual(found["worst"], 4.5, where)

    def names_are_there(self):
        """Everything that a key reaches has a name and a role that a screen reader can say; the page has an outline."""
        roles = {}
        for node in self.browser.accessibility_tree():
            focusable = any(p["name"] == "focusable" and p["value"].get("value") for p in node.get("properties", []))
            role = node.get("role", {}).get("value")
            if node.get("ignored") or role == "RootWebArea":
                continue
            roles[role] = roles.get(role, 0) + 1
            if focusable or role in ("figure", "table", "region", "slider", "button", "link"):
                name = node.get("name", {}).get("value", "").strip()
                if role != "figure":
                    self.assertTrue(name, f"{role} has no name: {node}")
        self.assertEqual(roles.get("slider", 0), len(self.figures()))
        for landmark in ("main", "banner", "navigation", "contentinfo"):
            self.assertEqual(roles.get(landmark), 1, roles)
        page = self.browser.run(
            """
            const ids = [...document.querySelectorAll('[id]')].map((e) => e.id);
            return {language: document.documentElement.lang, title: document.title, double: ids.filter((id, i) => ids.indexOf(id) !== i),
              levels: [...document.querySelectorAll('h1, h2, h3')].map((h) => Number(h.tagName[1])),
              lost: [...document.querySelectorAll('[aria-describedby], [aria-labelledby]')].filter((e) =>
                !document.getElementById(e.getAttribute('aria-describedby') ?? e.getAttribute('aria-labelledby'))).length,
              captions: [...document.querySelectorAll('table')].filter((t) => !t.caption?.textContent.trim()).length};"""
        )
        self.assertEqual((page["language"], page["double"], page["lost"], page["captions"]), ("en", [], 0, 0))
        self.assertTrue(page["title"].startswith("capsoc"))
        self.assertEqual(page["levels"][0], 1)
        self.assertEqual(page["levels"].count(1), 1)
        for before, after in zip(page["levels"], page["levels"][1:]):
            self.assertLessEqual(after, before + 1)


class OfACommand(Seen):
    """Tests of one result and the report that its command made with it."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.shared = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.shared.cleanup)
        cls.json, cls.html = (Path(cls.shared.name) / f"{cls.COMMAND}.{kind}" for kind in ("json", "html"))
        cls.process = capsoc(cls.COMMAND, "--json", cls.json, "--html", cls.html)
        cls.result = json.loads(cls.json.read_text())


class Runs(OfACommand):
    """The report of the main job."""

    COMMAND = "run"

    def test_it_keeps_what_every_report_keeps(self):
        self.done(self.process)
        self.check_page(self.html)

    def test_its_first_screen_is_the_answer(self):
        self.open(self.html)
        error, verdict = self.result["angle_error_deg"], self.result["verdict"]
        self.assertEqual(
            self.browser.run("return document.querySelector('.answer').textContent"),
            f"Pass: the angles of the last {verdict['samples']} samples are within {verdict['bound_deg']:.3g} deg.",
        )
        shown = self.browser.run(
            "return [...document.querySelectorAll('.key dd')].map((d) => [d.textContent, d.title])"
        )
        values = (error["uncalibrated_max"], error["calibration_mode_max"], verdict["bound_deg"])
        self.assertEqual([each[0] for each in shown], [f"{value:.3g} deg" for value in values])
        self.assertEqual([float(each[1].split()[0]) for each in shown], list(values))
        plot = self.browser.run("return document.querySelector('figure .plot').getBoundingClientRect().bottom")
        self.assertLess(plot, 900)

    def test_numbers_have_the_digits_that_mean_something(self):
        self.open(self.html)
        cell = """const row = [...document.querySelectorAll('td')].find((c) => c.textContent === arguments[0]).parentElement;
            return [...row.cells].slice(1).map((c) => [c.textContent, c.title])"""
        before = self.result["angle_error_deg"]["uncalibrated_max"]
        self.assertEqual(self.browser.run(cell, "largest angle error before, deg"), [[f"{before:.5g}", repr(before)]])
        self.assertEqual(self.browser.run(cell, "cycles"), [[str(self.result["cpu"]["cycles"]), ""]])
        a1 = self.result["parameters"]["a1"]
        row = self.browser.run(cell, "a1")
        self.assertEqual([float(text or title) for text, title in row][0], a1["word"])
        self.assertEqual(float(row[1][1]), a1["value"])

    def test_a_verdict_that_is_none(self):
        """No pass, one with conditions and one that does not hold are said as such, and a run without one says none."""
        for change, expected in (
            ({"pass": False, "reason": "no <b> lock"}, "No pass: no <b> lock."),
            ({"conditions": ["no sample is stale", "x"]}, "deg, if no sample is stale and x."),
            ({"bound_holds": False, "largest_error_deg": 1.5}, "That does not hold: an angle is 1.5 deg off."),
            (None, None),
        ):
            result = {**self.result, "verdict": None if change is None else {**self.result["verdict"], **change}}
            with self.subTest(change=change):
                self.open(self.report(result))
                said = self.browser.run("return document.querySelector('.answer')?.textContent ?? null")
                self.assertEqual(said, expected) if expected is None else self.assertIn(expected, said)

    def printed(self):
        return self.coloured(base64.b64decode(self.browser.devtools("Page.printToPDF")["data"]))

    def test_it_is_drawn_without_a_script_and_when_it_is_printed(self):
        blank = self.folder / "blank.html"
        blank.write_text(re.sub(r'(<path class="(?:curve|mark)[^>]* d=)"[^"]*"', r'\1""', self.html.read_text()))
        self.assertNotEqual(blank.read_bytes(), self.html.read_bytes())
        counts = []
        self.browser.devtools("Emulation.setScriptExecutionDisabled", value=True)
        try:
            for page in (self.html, blank):
                self.browser.open(page)
                counts.append(self.printed())
        finally:
            self.browser.devtools("Emulation.setScriptExecutionDisabled", value=False)
        self.assertLessEqual(set(self.browser.requests()), {page.resolve().as_uri() for page in (self.html, blank)})
        self.assertGreater(counts[0], 10 * counts[1])
        # With the script it has as much, also from a dark screen.
        self.browser.emulate(dark=True)
        self.open(self.html)
        self.assertAlmostEqual(self.printed(), counts[0], delta=counts[0] / 50)

    def test_a_picture_and_the_page_have_the_same_curves(self):
        paths = re.compile(r'<path class="(?:curve|mark|spread)[^>]*>')
        page = self.html.read_text()
        for name in ("a1", "angle-error", "spectrum"):
            picture = self.folder / f"{name}.svg"
            self.done(capsoc("report", self.json, "--figure", name, "--plot", picture))
            inline = re.search(rf'<figure id="figure-{name}".*?</figure>', page, re.DOTALL)[0]
            self.assertGreater(len(paths.findall(inline)), 0)
            self.assertEqual(paths.findall(picture.read_text()), paths.findall(inline))

    def test_the_mouse_zooms_and_goes_back(self):
        self.open(self.html)
        get = "const p = document.querySelector('figure[data-figure=a1] .plot'), g = p.parentElement.plot; "
        box = self.browser.run(
            get
            + """p.scrollIntoView({block: 'center'}); const b = p.querySelector('.frame').getBoundingClientRect();
            return [b.left, b.top, b.width, b.height]"""
        )
        now = get + "return [g.x(), g.y(), p.querySelector('.curve').getAttribute('d')]"
        whole = self.browser.run(now)

        def at(across, up):
            return box[0] + across * box[2], box[1] + (1 - up) * box[3]

        self.browser.drag(at(0.5, 0.5), at(0.75, 0.5))
        near, wide = self.browser.run(now), whole[0][1] - whole[0][0]
        self.assertAlmostEqual(near[0][0], whole[0][0] + 0.5 * wide, delta=wide / 100)
        self.assertAlmostEqual(near[0][1], whole[0][0] + 0.75 * wide, delta=wide / 100)
        self.assertNotEqual(near[2], whole[2])
        # The other axis follows what is seen.
        curve = self.figures()["a1"]["series"][0]
        seen = [y for x, y in zip(curve["x"], curve["y"]) if near[0][0] <= x <= near[0][1]]
        self.assertLessEqual(near[1][0], min(seen))
        self.assertGreaterEqual(near[1][1], max(seen))
        self.assertLess(near[1][1] - near[1][0], (whole[1][1] - whole[1][0]) / 10)
        self.browser.drag(at(0.5, 0.25), at(0.5, 0.75))
        tall, room = self.browser.run(now), near[1][1] - near[1][0]
        self.assertAlmostEqual(tall[1][1] - tall[1][0], room / 2, delta=room / 50)
        self.assertEqual(tall[0], near[0])
        self.browser.double_click(*at(0.5, 0.5))
        self.assertEqual(self.browser.run(now), whole)
        self.CLEAN(self.html)

    def coloured(self, pdf):
        """How many points of the sheets, at 40 dpi, are of a line's colour."""
        file = self.folder / "printed.pdf"
        file.write_bytes(pdf)
        subprocess.run(["pdftoppm", "-r", "40", file, self.folder / "sheet"], check=True)
        sheets = sorted(self.folder.glob("sheet*.ppm"))
        self.assertGreater(len(sheets), 3)
        count = 0
        for sheet in sheets:
            points = sheet.read_bytes().split(b"\n255\n", 1)[1]
            count += sum(abs(r - b) > 100 for r, b in zip(points[0::3], points[2::3]))
            sheet.unlink()
        return count

    def test_every_figure_of_a_run_is_there(self):
        self.open(self.html)
        listed = capsoc("report", "--list-figures").stdout.decode().splitlines()
        expected = {line.split()[0] for line in listed if line.split()[1] == "run"} - {"profile"}
        self.assertEqual(set(self.figures()), expected)
        curves = self.result["curves"]
        for name in ("a1", "phi"):
            self.assertEqual(self.figures()[name]["series"][0]["y"], curves[name]["y"])
            self.assertEqual(
                self.figures()[name]["marks"], [{"label": "true", "at": self.result["parameters"][name]["true"]}]
            )
        self.assertEqual(curves["a1"]["y"][-1], round(self.result["parameters"]["a1"]["value"], 10))
        largest = max(abs(y) for x, y in zip(*curves["angle_error"].values()) if x > 400)
        self.assertAlmostEqual(largest, self.result["angle_error_deg"]["calibration_mode_max"], 12)

    def test_hovering_shows_the_value(self):
        self.open(self.html)
        for name in ("a1", "angle-error", "spectrum"):
            figure = self.figures()[name]
            place = self.browser.run(
                """const p = document.querySelector(`figure[data-figure="${arguments[0]}"] .plot`);
                p.scrollIntoView({block: 'center'}); const b = p.getBoundingClientRect(), [from, to] = p.parentElement.plot.x(),
                a = p.querySelector('.frame').getBoundingClientRect();
                return [a.left + a.width / 2, b.top + b.height / 2, (from + to) / 2]""",
                name,
            )
            self.browser.point_at(*place[:2])
            text = self.browser.wait(
                f"""return document.querySelector('figure[data-figure="{name}"] .readout').textContent""", "a readout"
            )
            first = figure["series"][0]
            near = min(range(len(first["x"])), key=lambda k: abs(first["x"][k] - place[2]))
            if name != "spectrum":
                shown = float(re.match(r"time, s ([-0-9.e]+);", text)[1])
                self.assertAlmostEqual(shown, first["x"][near], delta=1.0)
                near = min(range(len(first["x"])), key=lambda k: abs(first["x"][k] - shown))
            value = float(re.search(re.escape(first["name"]) + r": ([-0-9.e]+)", text)[1])
            self.assertAlmostEqual(value, first["y"][near], delta=abs(first["y"][near]) * 1e-6)
        self.CLEAN(self.html)

    def test_keys_read_points_and_zoom(self):
        self.open(self.html)
        get = "const p = document.querySelector('figure[data-figure=a1] .plot'); "
        self.browser.run(get + "p.focus()")
        first = self.result["curves"]["a1"]
        self.browser.press("Home", "ArrowRight")
        said = self.browser.run(get + "return [p.getAttribute('aria-valuetext'), p.getAttribute('aria-valuenow')]")
        self.assertEqual(said[1], "1")
        self.assertIn(f"a1: {first['y'][1]:.7g}", said[0])
        whole = self.browser.run(get + "return p.parentElement.plot.x()")
        self.browser.press("+", "+")
        near = self.browser.run(get + "return p.parentElement.plot.x()")
        self.assertAlmostEqual(near[1] - near[0], (whole[1] - whole[0]) / 4)
        self.browser.press("0")
        self.assertEqual(self.browser.run(get + "return p.parentElement.plot.x()"), whole)

    def test_the_csv_has_every_point(self):
        self.open(self.html)
        address = self.browser.run(
            """const a = document.querySelector('figure[data-figure=a1] a');
            a.addEventListener('click', (e) => e.preventDefault()); a.click(); return decodeURIComponent(a.href)"""
        )
        kind, text = address.split(",", 1)
        self.assertEqual(kind, "data:text/csv;charset=utf-8")
        lines = text.splitlines()
        self.assertEqual(lines[0], 'series,"time, s","a1, full scale"')
        points = [line.split(",") for line in lines[1:] if line.startswith("a1,")]
        self.assertEqual([float(p[2]) for p in points], self.result["curves"]["a1"]["y"])

    def test_tables_sort_by_number(self):
        self.open(self.html)
        column = """const t = document.querySelectorAll('table.sortable')[1]; if (arguments[0]) t.tHead.rows[0].cells[1].firstChild.click();
            return [t.tHead.rows[0].cells[1].getAttribute('aria-sort'), ...[...t.tBodies[0].rows].map((r) => Number(r.cells[1].textContent))]"""
        for direction in ("ascending", "descending"):
            order, *words = self.browser.run(column, True)
            self.assertEqual((order, words), (direction, sorted(words, reverse=direction == "descending")))

    def curve(self, name):
        """What the first curve of a figure draws: values that its axis has, their places downwards, and whether the axis
        is logarithmic."""
        series = self.figures()[name]["series"][0]["y"]
        path, logarithmic = self.browser.run(
            """const f = document.querySelector(`figure[data-figure=${arguments[0]}]`);
            return [f.querySelector('.plot .curve').getAttribute('d'), f.plot.log()[1]]""",
            name,
        )
        place, places = 0, []
        for command, numbers in re.findall(r"([Ml])([^Ml]*)", path):
            down = int(re.findall(r"-?\d+", numbers)[1])
            place = down if command == "M" else place + down
            places.append(place)
        return [y for y in series if y is not None and not (logarithmic and y == 0)], places, logarithmic

    def test_logarithmic_axes_switch(self):
        self.open(self.html)
        log = self.browser.run(
            """const f = document.querySelector('figure[data-figure=a1]'), b = [...f.querySelectorAll('button')].find((b) => b.textContent === 'Log');
            const before = f.plot.log()[1]; b.click(); return [before, f.plot.log()[1], b.textContent]"""
        )
        self.assertEqual(log, [False, True, "Linear"])
        # An axis is named alike by the drawing and by the script.
        switched = """const f = document.querySelector(`figure[data-figure=${arguments[0]}]`), names = [];
            for (let n = 0; n < 3; ++n) {
              names.push(f.querySelector('.y-name').textContent);
              [...f.querySelectorAll('button')].find((b) => ['Log', 'Linear'].includes(b.textContent)).click();
            }
            return names"""
        # Each place is a linear function of the value, or of its logarithm, whichever the axis shows then.
        for figure in ("a1", "angle-error"):
            for _ in range(2):
                values, places, logarithmic = self.curve(figure)
                values = [math.log10(abs(value)) if logarithmic else value for value in values]
                least, greatest = min(values), max(values)
                low, high = (places[values.index(value)] for value in (least, greatest))
                self.assertGreater(low - high, 100, figure)  # places grow downwards
                for value, place in zip(values, places, strict=True):
                    due = low + (high - low) * (value - least) / (greatest - least)
                    self.assertAlmostEqual(place, due, delta=1.01, msg=f"{figure}, {value}")
                self.browser.run(switched.replace("n < 3", "n < 1"), figure)
        magnitude, name = "|angle error|, deg", "angle error, deg"
        self.assertEqual(self.browser.run(switched, "angle-error"), [magnitude, name, magnitude])
        self.CLEAN(self.html)

    def test_the_same_result_gives_the_same_bytes(self):
        again = self.report(self.json)
        self.assertEqual(again.read_bytes(), self.html.read_bytes())


class Campaigns(Seen):
    """The report of `capsoc campaign`."""

    def campaign(self, count=400, name="drawn", axis="noise", metric="error"):
        """As its JSON: the error follows the first axis, and beyond 0.5 a run does not pass."""
        noise = [10 ** (-6 + 4 * k / count) for k in range(count)]
        error = [value * 100 for value in noise]
        passed = [value < 0.5 for value in error]
        share = {axis: {"share": 0.9, "correlation": 0.99}, "bits": {"share": 0.01, "correlation": 0}}
        return {
            "schema": 1,
            "command": "capsoc campaign",
            "name": name,
            "kind": "run",
            "version": "x",
            "runs": count,
            "done": count,
            "finished": count,
            "passed": sum(passed),
            "yield": sum(passed) / count,
            "yield_interval": [0.9, 0.95],
            "least_yield": 0.5,
            "criteria": [{"name": "small", "expression": metric + " < 0.5", "met": sum(passed)}],
            "exits": [{"exit": "0: " + name, "runs": count}],
            "metrics": [
                {
                    "name": metric,
                    "expression": metric,
                    "missing": 0,
                    "count": count,
                    "summary": {"mean": 0.2, "quantiles": {"0": error[0], "0.5": error[count // 2], "1": error[-1]}},
                    "histogram": {
                        "logarithmic": True,
                        "least": error[0],
                        "greatest": error[-1],
                        "bins": [count // 20] * 20,
                    },
                    "sensitivity": share,
                }
            ],
            "worst_metric": metric,
            "worst": [{"run": 3, "worst": 0.99, "exit": name, "command": "capsoc run -C " + name}],
            "failures": [],
            "sample": {
                "of": count,
                "runs": list(range(count)),
                "passed": passed,
                "axes": {
                    axis: noise,
                    "bits": [12 + k % 3 for k in range(count)],
                    "kind": [["tlm", "rtl"][k % 2] for k in range(count)],
                },
                "metrics": {metric: error, "half": [None if k % 2 else 1.0 for k in range(count)]},
            },
        }

    def shown(self):
        return self.browser.run(
            """const f = document.querySelector('figure[data-figure="campaign-any-two"]');
            return {rows: f.plot.stops(), y: f.plot.log()[1], x: f.plot.log()[0], label: f.querySelector('.x-name').textContent,
              drawn: [...f.querySelectorAll('.curve')].map((e) => e.getAttribute('d')).join('').split('M').length - 1}"""
        )

    def choose(self, place, number, value):
        self.browser.run(
            """const s = document.querySelectorAll(arguments[0] + ' select')[arguments[1]]; s.value = arguments[2];
            s.dispatchEvent(new Event('change'))""",
            place,
            number,
            value,
        )

    def test_it_keeps_what_every_report_keeps(self):
        self.check_page(self.report(self.campaign()))
        figures = self.figures()
        self.assertEqual(sum(figures["campaign-metric-1"]["series"][0]["y"]), 400)
        self.assertEqual(figures["campaign-dependence"]["labels"], ["noise", "bits"])
        self.assertEqual([len(s["x"]) for s in figures["campaign-any-two"]["series"]], [370, 30])
        text = self.browser.run("return document.body.textContent")
        self.assertEqual(
            self.answer(),
            (
                "Yield 92.50 %: 370 of 400 runs passed, wanted 50.00 %.",
                "good",
                {
                    "yield": ("92.50 %", "0.925"),
                    "95 % interval of the yield": ("90.00 to 95.00 %", "0.9 to 0.95"),
                    "largest error": ("0.99", "0.99"),
                },
            ),
        )
        self.assertEqual(figures["campaign-yield"]["series"][0]["y"], [92.5, 92.5])
        self.assertEqual(figures["campaign-yield"]["marks"], [{"label": "wanted", "at": 50}])
        self.assertEqual(figures["campaign-metric-1"]["title"], "error: distribution")
        self.assertIn("95 % interval by Wilson: 90.00 % to 95.00 %; wanted are 50.00 %.", text)
        self.assertIn("capsoc run -C drawn", text)

    def test_a_yield_that_is_not_reached_names_its_criterion(self):
        """So does one that is not known, or not yet."""
        whole = self.campaign(40)
        for change, said, style in (
            (
                {"least_yield": 0.99},
                "Yield 92.50 %: 37 of 40 runs passed, wanted 99.00 %. The fewest runs meet small: 92.50 %.",
                "bad",
            ),
            ({"runs": 50}, "Yield 92.50 %: 37 of 40 runs passed, wanted 50.00 %. 40 of 50 runs are done.", "odd"),
            ({"yield": None, "yield_interval": None}, "No run is done.", "odd"),
        ):
            with self.subTest(said=said):
                self.open(self.report({**whole, **change}))
                self.assertEqual(self.answer()[:2], (said, style))

    def test_any_two_columns_are_drawn(self):
        self.open(self.report(self.campaign()))
        self.assertEqual(self.shown(), {"rows": 400, "drawn": 400, "y": True, "x": True, "label": "noise"})
        self.choose("figure[data-figure=campaign-any-two]", 0, 1)
        self.assertEqual(self.shown(), {"rows": 400, "drawn": 400, "y": True, "x": False, "label": "bits"})
        self.choose("figure[data-figure=campaign-any-two]", 1, 4)
        self.assertEqual(self.shown(), {"rows": 200, "drawn": 200, "y": False, "x": False, "label": "bits"})
        self.assertEqual(self.browser.console(), [])

    def test_the_heat_map_counts_and_averages(self):
        self.open(self.report(self.campaign()))
        cells = """return [...document.querySelectorAll('.heat tbody tr')].map((r) => [...r.cells].map((c) => c.textContent))"""
        table = self.browser.run(cells)
        self.assertEqual([row[0] for row in table], ["12", "13", "14"])
        self.assertEqual(len(table[0]), 11)
        runs = sum(int(cell.split("(")[1][:-1]) for row in table for cell in row[1:] if cell)
        self.assertEqual(runs, 400)
        self.assertEqual([row[1].split()[0] for row in table], ["1", "1", "1"])
        self.assertLess(float(table[0][-1].split()[0]), 0.5)
        self.choose(".heat", 0, 2)
        self.choose(".heat", 2, 1)
        table = self.browser.run(cells)
        self.assertEqual(
            self.browser.run("return [...document.querySelectorAll('.heat thead th')].map((c) => c.textContent)"),
            ["tlm", "rtl"],
        )
        noise = [10 ** (-6 + 4 * k / 400) for k in range(400)]
        mean = sum(100 * noise[k] for k in range(0, 400, 6)) / len(range(0, 400, 6))
        self.assertAlmostEqual(float(table[0][1].split()[0]), mean, delta=0.01 * mean)
        self.assertEqual(self.browser.console(), [])

    def test_hostile_names_stay_text(self):
        for text in HOSTILE:
            page = self.report(self.campaign(40, text, "a" + text, "m" + text))
            self.open(page)
            self.choose("figure[data-figure=campaign-any-two]", 1, 0)
            self.choose(".heat", 2, 1)
            found = self.browser.run(
                """return {hacked: window.hacked ?? null, scripts: document.scripts.length,
                strange: document.querySelectorAll('img, iframe, object, embed, base, form, svg:not(.plot > svg:first-child, .plot > svg:first-child > .area), body link, body style').length,
                names: [...document.querySelectorAll('select option')].map((o) => o.textContent)}"""
            )
            self.assertEqual((found["hacked"], found["scripts"], found["strange"]), (None, 2, 0))
            self.CLEAN(page)

    def test_damage_is_no_error_of_the_page(self):
        whole = self.campaign(30)
        for key in ("sample", "metrics", "criteria", "exits", "worst", "yield_interval"):
            for value in (None, [], {}, 5, "x", [[]], [{}]):
                self.report({**whole, key: value})
        odd = self.campaign(30)
        odd["sample"]["axes"]["noise"] = odd["sample"]["axes"]["noise"][:7]
        odd["sample"]["metrics"]["error"][3] = {"a": [1]}
        self.open(self.report(odd))
        self.assertEqual(self.browser.console(), [])


class Hostile(Seen):
    """Texts that would like to be markup stay texts."""

    def check_texts(self, page, *texts):
        self.open(page)
        self.browser.run("document.querySelectorAll('th button, figure button').forEach((b) => b.click())")
        self.browser.run(
            """document.querySelectorAll('.plot').forEach((p) => { p.focus();
            for (const key of ['Home', 'ArrowRight', 'End']) p.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true})); })"""
        )
        found = self.browser.run(
            """return {hacked: window.hacked ?? null, text: document.body.textContent,
            scripts: document.scripts.length, strange: document.querySelectorAll('img, iframe, object, embed, base, form, svg:not(.plot > svg:first-child, .plot > svg:first-child > .area), math, body link, body style, body meta').length,
            handlers: [...document.querySelectorAll('*')].filter((e) => [...e.attributes].some((a) => a.name.startsWith('on'))).length}"""
        )
        self.assertEqual((found["hacked"], found["scripts"], found["strange"], found["handlers"]), (None, 2, 0, 0))
        for text in texts:
            self.assertIn(re.sub(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]", "\ufffd", text), found["text"])
        self.CLEAN(page)

    def test_in_every_text_of_a_result(self):
        for text in HOSTILE:
            curve = {"x": [0, 1, 2], "y": [0.5, 0.6, 0.7]}
            result = {
                "schema": 1,
                "command": "capsoc run " + text,
                "versions": {text: text},
                "configuration": {text: text, "a": text},
                "inputs": [{"role": text, "path": text, "sha256": text}],
                "exit": {"code": 1, "reason": text},
                "convergence": text,
                "fault_report": text,
                "place_report": text,
                "divergence": text,
                "sensor_warnings": [text],
                "lost": [text],
                "uart0": {"bytes": 1, "sha256": text, "text": text, "left_out": 0},
                "verdict": {"reason": text},
                "profile": [{"function": text, "cycles": 5, "instructions": 1}],
                "parameters": {"a1": {"word": text, "value": text, "true": 0.6}},
                "curves": {"a1": curve, "status." + text: curve, "flags." + text: curve},
            }
            page = self.report(result)
            self.check_texts(page, text)
            two = self.report(result, result)
            self.check_texts(two, text)

    def test_in_names_of_files_symbols_and_uart_output(self):
        """The whole way: an ELF of a strange name, with strange symbols, prints what it is sent."""
        strange = "<img src=x onerror=window.hacked=1>"
        elf, sent = self.folder / f"{strange}.elf", self.folder / "sent"
        subprocess.run(
            ["arm-none-eabi-objcopy", f"--redefine-sym=main={strange}", FIRMWARE / "echo.elf", elf], check=True
        )
        text = "\n".join(HOSTILE).encode() + bytes(range(256))
        sent.write_bytes(len(text).to_bytes(4, "little") + text)
        page, result = self.folder / "run.html", self.folder / "run.json"
        process = capsoc(
            "run",
            elf,
            "-C",
            f"uart0.input={sent}",
            "--profile",
            self.folder / "p",
            "--html",
            page,
            "--json",
            result,
            "--simlimit",
            "5",
            "--uart0",
            "null",
        )
        self.assertIn(process.returncode, (0, 124), process.stderr.decode())
        kept = json.loads(result.read_text())
        self.assertIn("<script>window.hacked=1</script>", kept["uart0"]["text"])
        self.assertIn(strange, [f["function"] for f in kept["profile"]])
        self.check_texts(page, strange, *(t for t in HOSTILE if t.isprintable()))
        self.assertEqual(self.report(result).read_bytes(), page.read_bytes())


class Papers(OfACommand):
    """The report of `capsoc reproduce`: both papers' figures."""

    # The figures that carry data; the others are block diagrams and photographs.
    SOC = {6, 7, 8, 9, 10, 12, 13, 14, 16, 17, 18, 19}
    CSFN = {7, 8, 9, 10, 11, 12, 13, 14, 16, 17, 18, 19, 20, 21, 22, 23}

    COMMAND = "reproduce"

    def test_it_keeps_what_every_report_keeps(self):
        self.done(self.process)
        self.check_page(self.html)
        self.assertEqual(self.report(self.json).read_bytes(), self.html.read_bytes())

    def test_its_first_screen_is_the_answer(self):
        self.open(self.html)
        rows = [row["verdict"] for table in self.result["tables"] for row in table["rows"]]
        agree, hold, known = (rows.count(verdict) for verdict in ("agrees", "holds", "known"))
        said, style, key = self.answer()
        self.assertEqual(
            said,
            f"0 rows differ that should agree: {agree} agree with the papers, {hold} hold, {known} differ for a reason "
            "that is known.",
        )
        self.assertEqual((style, key["rows that hold"]), ("good", (str(hold), f"{hold} of {len(rows)} rows")))
        parts = self.figures()["reproduce-rows"]["series"][0]["y"]
        self.assertGreater(len(parts), 150)
        self.assertLessEqual(max(parts), 100 + 1e-9)

    def test_a_row_that_should_agree_is_named(self):
        result = json.loads(self.json.read_text())
        table = result["tables"][0]
        table["rows"][0].update(verdict="unexpected", here="77", here_least=77, here_greatest=77)
        del result["curves"]
        self.open(self.report(result))
        said, style, _ = self.answer()
        self.assertIn("1 rows differ that should agree: ", said)
        self.assertIn(
            f". The first that should agree: {table['rows'][0]['quantity']} ({table['title']}), here 77.", said
        )
        self.assertEqual(style, "bad")
        self.assertGreater(max(self.figures()["reproduce-rows"]["series"][0]["y"]), 100)

    def test_every_figure_with_data_is_there(self):
        self.open(self.html)
        here = set(self.figures())
        listed = [
            line
            for line in capsoc("report", "--list-figures").stdout.decode().splitlines()
            if line.split()[1] == "reproduce"
        ]
        self.assertEqual(here, {line.split()[0] for line in listed})
        for paper, figures in (("SoC", self.SOC), ("CSFN", self.CSFN)):
            named = {int(n) for line in listed for n in re.findall(rf"{paper} paper, Figure (\d+)", line)}
            self.assertEqual(named, figures)
        for name, figure in self.figures().items():
            for series in figure["series"]:
                self.assertGreater(len(series["x"]), 0, name)

    def test_the_papers_numbers_are_marked(self):
        self.open(self.html)
        figures = self.figures()
        rows = {(t["id"], r["quantity"]): r for t in self.result["tables"] for r in t["rows"]}
        for name, row in (
            ("soc-7-a1", ("1", "a1")),
            ("soc-12-beta", ("8", "beta, identified")),
            ("csfn-18-b2", ("csfn-2", "b2")),
            ("soc-10-2", ("figure-10", "m = -2, mean gain of the last 20 s")),
        ):
            self.assertEqual([m["at"] for m in figures[name]["marks"]], [rows[row]["paper_value"]], name)
        self.assertEqual([m["at"] for m in figures["soc-8"]["marks"]], [30.38, 9.52e-4])
        self.assertEqual([m["at"] for m in figures["soc-18"]["marks"]], [0.9814, 1.1630, 1.7284])
        # What is drawn is what the rows say.
        calibrated = next(s for s in figures["soc-8"]["series"] if s["name"] == "with calibration")
        self.assertAlmostEqual(
            max(map(abs, calibrated["y"])), rows["1", "largest error calibrated"]["here_least"], delta=1e-8
        )
        raw = figures["soc-17"]["series"][0]["y"]
        self.assertAlmostEqual(
            max(raw) - min(raw), rows["figure-17", "uncalibrated, peak to peak"]["here_least"], delta=1e-4
        )
        after = figures["csfn-22-b"]["series"][0]["y"]
        self.assertAlmostEqual(max(after) - min(after), rows["csfn-2", "after"]["here_least"], delta=1e-3)

    def test_every_agreement_has_its_tolerance(self):
        self.open(self.html)
        cells = self.browser.run("return [...document.querySelectorAll('td.good')].map((c) => c.textContent)")
        agreed = [c for c in cells if c.startswith(("agrees ", "agrees:"))]
        rows = [r for t in self.result["tables"] for r in t["rows"] if r["verdict"] == "agrees"]
        self.assertEqual(len(agreed), len(rows))
        for cell in agreed:
            self.assertRegex(cell, r"^agrees(: (at most|at least) | within |: )[-0-9.e]+")


class Others(Seen):
    """The reports of the other commands."""

    def test_fit(self):
        page, result = self.folder / "f.html", self.folder / "f.json"
        self.done(
            capsoc("fit", SOURCE / "traces" / "csfn_h3.toml", "--method", "adam", "--html", page, "--json", result)
        )
        self.check_page(page)
        figures, fit = self.figures(), json.loads(result.read_text())
        self.assertEqual(
            set(figures),
            {
                "fit-ellipse",
                "fit-residuals",
                "fit-residuals-by-angle",
                "fit-angle-error",
                "fit-intervals",
                "fit-companions",
                "fit-loss",
                "fit-learning",
            },
        )
        largest = max(map(abs, figures["fit-residuals"]["series"][0]["y"]))
        self.assertAlmostEqual(largest, fit["residuals"]["largest"], delta=1e-6 * largest)
        error = figures["fit-angle-error"]["series"][0]["y"]
        self.assertAlmostEqual(max(error) - min(error), fit["angle_error_deg"]["calibrated_peak_to_peak"], delta=1e-3)
        self.assertEqual(figures["fit-intervals"]["series"][0]["y"][0], fit["parameters"]["a1"]["interval"])
        self.assertEqual(self.report(result).read_bytes(), page.read_bytes())
        answer = "return [...document.querySelectorAll('.answer')].map((p) => [p.textContent, p.firstChild.className])"
        self.assertEqual(
            self.browser.run(answer), [[f"Identified from 10000 samples, without a bound: {fit['warning']}.", "odd"]]
        )
        self.done(capsoc("fit", SOURCE / "traces" / "csfn_eq.toml", "--html", page, "--json", result))
        self.open(page)
        bound = json.loads(result.read_text())["angle_bound_deg"]["total"]
        ((sentence, style),) = self.browser.run(answer)
        self.assertIn(
            f": the angle is within {bound:.3g} deg over the whole turn at 99.99 % confidence, without", sentence
        )
        self.assertEqual(style, "good")

    def test_fit_alone_writes_no_calibration(self):
        page = self.folder / "f.html"
        self.done(
            subprocess.run(
                [CAPSOC, "fit", SOURCE / "traces" / "csfn_eq.toml", "--html", page],
                cwd=self.folder,
                env=CLEAN,
                capture_output=True,
                check=False,
            )
        )
        self.assertEqual([f.name for f in self.folder.iterdir()], ["f.html"])

    def test_accuracy(self):
        page, result = self.folder / "a.html", self.folder / "a.json"
        self.done(capsoc("accuracy", "--table", "widths", "--html", page, "--json", result))
        self.check_page(page)
        rows = json.loads(result.read_text())["tables"][0]["rows"]
        said, _, key = self.answer()
        self.assertEqual(said, "Rows that miss their bound: 0; 0 of 5 rows have one.")
        self.assertEqual(key["largest error, precise"][1], f"{rows[0]['precise']!r} deg")
        figure = self.figures()["accuracy-widths"]
        self.assertEqual(figure["labels"], [row["quantity"] for row in rows])
        self.assertEqual(figure["series"][0]["y"], [row["precise"] for row in rows])

    def test_bench(self):
        page, result = self.folder / "b.html", self.folder / "b.json"
        self.done(capsoc("bench", "cpu", FIRMWARE / "bench_crc.elf", "--repeat", "2", "--html", page, "--json", result))
        self.check_page(page)
        row, mean = json.loads(result.read_text())["tables"][0]["rows"]
        said, _, key = self.answer()
        self.assertIn(f"The translator executes {mean['translator_mips']:.0f} million instructions a second", said)
        self.assertEqual(
            key["translator, geometric mean"],
            (f"{mean['translator_mips']:.0f} MIPS", f"{mean['translator_mips']!r} MIPS"),
        )
        self.assertIn("slowest run below the best, at most", key)
        blocks = self.figures()["bench-mips"]["series"][0]
        self.assertEqual(
            (blocks["y"][0], blocks["low"][0], blocks["high"][0]), (row["mips"], row["mips_least"], row["mips"])
        )
        self.assertLessEqual(row["mips_least"], row["mips"])

    def test_regress(self):
        page, result = self.folder / "r.html", self.folder / "r.json"
        self.done(
            capsoc(
                "regress",
                "--arithmetic",
                "precise",
                "--seeds",
                "1",
                "--samples",
                "500",
                "--accesses",
                "500",
                "--html",
                page,
                "--json",
                result,
            )
        )
        self.check_page(page)
        data = json.loads(result.read_text())
        bins = [hits for group in data["arithmetics"]["precise"]["coverage"].values() for hits in group.values()]
        runs = data["arithmetics"]["precise"]["runs"]
        clocks, samples = (sum(run[key] for run in runs) for key in ("cycles", "samples"))
        hit, all_bins = len(bins) - bins.count(0), len(bins)
        said, style, key = self.answer()
        self.assertIn("No difference between the model and the RTL: ", said)
        self.assertIn(f": {len(runs)} runs, {clocks / 1e6:.2f} million clocks, {samples} samples.", said)
        self.assertEqual(style, "good")
        self.assertEqual(key["runs that differ"][0], f"0 of {len(runs)}")
        self.assertEqual(key["clocks compared"][1], str(clocks))
        self.assertEqual(key["functional coverage"][0], f"{hit} of {all_bins}")
        shown = self.browser.run(
            "return [document.querySelectorAll('.map li').length, document.querySelectorAll('.map li.bad').length]"
        )
        self.assertEqual(shown, [len(bins), bins.count(0)])
        figure = self.figures()["regress-scenarios"]
        self.assertEqual(
            sum(figure["series"][0]["y"]), sum(run["cycles"] for run in data["arithmetics"]["precise"]["runs"])
        )
        self.assertEqual(self.report(result).read_bytes(), page.read_bytes())

    def test_a_difference_is_drawn_around_its_clock(self):
        waves = [
            {"node": "sine", "model": [0.5] * 41, "rtl": [0.5] * 24 + [0.25] * 17},
            {"node": "angle", "model": [1] * 41, "rtl": [2] * 41},
        ]
        run = {
            "scenario": "random",
            "seed": 3,
            "samples": 9,
            "accesses": 8,
            "commits": 7,
            "cycles": 600,
            "difference": {
                "cycle": 524,
                "what": "node sine of T2: model 1, RTL 2",
                "node": "sine (T2)",
                "command": "capsoc regress",
                "report": "report",
                "first_cycle": 500,
                "waves": waves,
            },
        }
        page = self.report(
            {
                "schema": "capsoc-regress-1",
                "difference": True,
                "arithmetics": {"precise": {"runs": [run], "coverage": {"g": {"b": 0, "c": 1}}}},
            }
        )
        self.check_page(page)
        figures = self.figures()
        self.assertEqual([s["name"] for s in figures["regress-wave-1"]["series"]], ["sine, model", "sine, RTL"])
        rtl = figures["regress-wave-1"]["series"][1]
        self.assertEqual((rtl["x"][0], rtl["y"][rtl["x"].index(-1)], rtl["y"][rtl["x"].index(0)]), (-24, 0.5, 0.25))
        self.assertNotIn("regress-wave-3", figures)
        said, style, key = self.answer()
        self.assertEqual(
            (said, style),
            (
                "Difference in scenario random (precise), seed 3, cycle 524: node sine of T2: model 1, RTL 2.",
                "bad",
            ),
        )
        self.assertEqual((key["runs that differ"][0], key["first difference at clock"][0]), ("1 of 1", "524"))

    def test_the_mutation_table(self):
        page = self.report(
            {
                "schema": "capsoc-mutation-1",
                "arithmetics": {
                    "paper": {
                        "files": {"lms.sv": {"killed": 9, "survived": 1, "equivalent": 2}},
                        "survivors": [{"number": 4, "place": "lms.sv:7", "what": "x"}],
                    }
                },
            }
        )
        self.check_page(page)
        self.assertEqual(self.figures()["mutation-score"]["series"][0]["y"], [90])
        said, style, key = self.answer()
        self.assertEqual(
            (said, style), ("The regression kills 90.00 % of the mutants: 9 of 10, wanted 95.00 %.", "bad")
        )
        self.assertEqual(key["equivalent mutants"][0], "2")

    def test_results_of_several_commands_in_one(self):
        run, fit = self.folder / "run.json", self.folder / "fit.json"
        self.done(capsoc("run", "--simlimit", "8", "--curves", "--json", run), 124)
        self.done(capsoc("fit", SOURCE / "traces" / "csfn_eq.toml", "--curves", "--json", fit))
        page = self.report(run, fit)
        self.check_page(page)
        self.assertTrue({"a1", "fit-ellipse"} <= set(self.figures()))


class Refusals(ReportCase):
    """What is no result is a sentence and exit code 2, and nothing is written."""

    def refuse(self, expected, *arguments):
        before = sorted(self.folder.iterdir())
        process = capsoc("report", *arguments)
        text = process.stderr.decode()
        self.assertEqual((process.returncode, process.stdout), (2, b""), text)
        self.assertEqual(len(text.strip().splitlines()), 1, text)
        self.assertIn(expected, text)
        self.assertEqual(sorted(self.folder.iterdir()), before)

    def test_wrong_inputs(self):
        page = self.folder / "r.html"
        for name, content, expected in (
            ("a.json", "{", "is not JSON"),
            ("b.json", "[1]", "is no result"),
            ("c.json", '{"command": "ls"}', "is no result"),
            ("d.json", "", "empty"),
            ("e.json", "[" * 50, "is not JSON"),
            ("f.json", '{"a": 1e999}', "is not JSON"),
            ("h.json", '{"command": "capsoc run", "curves": ' + "[" * 200_000 + "]" * 200_000 + "}", "nested"),
        ):
            file = self.folder / name
            file.write_text(content)
            self.refuse(f"{name}: ", file, "--html", page)
            self.refuse(expected, file, "--html", page)
        self.refuse("No such file", self.folder / "none.json", "--html", page)
        good = self.folder / "g.json"
        good.write_text('{"command": "capsoc run"}')
        self.refuse("--html", good)
        self.refuse("RESULT", "--html", page)
        self.refuse("g.json", good, "--html", good)
        self.refuse("no/such", good, "--html", self.folder / "no/such/r.html")

    def test_an_output_of_a_run_is_none_of_its_inputs(self):
        sensor = self.folder / "s.toml"
        sensor.write_bytes((SOURCE / "traces" / "soc_eq21.toml").read_bytes())
        process = capsoc("run", "--sensor", sensor, "--html", sensor)
        self.assertEqual(process.returncode, 2, process.stderr.decode())
        self.assertEqual(sensor.read_bytes(), (SOURCE / "traces" / "soc_eq21.toml").read_bytes())

    def test_a_place_that_takes_nothing_is_told_of(self):
        process = capsoc("run", FIRMWARE / "hello.elf", "--html", "/dev/full")
        self.assertEqual(process.returncode, 74, process.stderr.decode())


class Unchanged(ReportCase):
    """A report changes nothing of what a run does."""

    def test_results_without_a_report_have_none_of_it(self):
        with_it, without = self.folder / "w.json", self.folder / "o.json"
        self.done(capsoc("run", "--simlimit", "20", "--json", without), 124)
        self.done(capsoc("run", "--simlimit", "20", "--json", with_it, "--html", self.folder / "r.html"), 124)
        plain, full = json.loads(without.read_text()), json.loads(with_it.read_text())
        self.assertNotIn("curves", plain)
        self.assertNotIn("text", plain["uart0"])
        for result in (plain, full):
            for key in ("wall_s",):
                del result["time"][key]
            del result["cpu"]["mips"]
        del full["curves"], full["uart0"]["text"], full["uart0"]["left_out"]
        self.assertEqual(plain, full)

    def test_no_file_of_the_page_comes_from_elsewhere(self):
        page = self.folder / "r.html"
        self.done(capsoc("run", FIRMWARE / "hello.elf", "--html", page))
        text = page.read_text()
        self.assertNotIn("sourceMappingURL", text)
        self.assertEqual(text.count("<script"), 2)
        self.assertIn("default-src 'none'", text)
        self.assertEqual(re.findall(r"<(?:script|img|iframe)[^>]* src=|<link[^>]* href=\"(?!data:,)", text), [])


if __name__ == "__main__":
    unittest.main()
