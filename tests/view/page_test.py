#!/usr/bin/env python3
"""The live page in a real browser: it opens, draws, is used by keyboard, fits a narrow window and a dark one."""

import re
import time
import unittest

from harness import FIRMWARE
from processor_times import processor_times
from view_case import Browsed, Events

CTEST = {"name": "view: page", "timeout": 300}


def told(name, begin, end, now):
    """The page's sentence about a bar, times in ps."""
    length, size, unit = end - begin, 1000, "ns"
    for size, unit in ((10**12, "s"), (10**9, "ms"), (10**6, "\u00b5s"), (1000, "ns")):
        if length >= size:
            break
    until = "until now, " if end == now else ""
    return f"{name}: from {begin / 1e12:.9f} s, {until}{float(f'{length / size:.6g}'):g} {unit} long"


class Page(Browsed):
    """One browser a test."""

    def test_nothing_is_undefined_and_there_is_help(self):
        view = self.view()
        self.open(view)
        speeds = self.browser.run("return [...document.getElementById('speed').options].map((each) => each.text)")
        self.assertEqual([each for each in speeds if not re.match(r"[0-9.]+x$|as fast as it can$", each)], [])
        self.assertNotIn("undefined", self.browser.run("return document.body.innerText"))
        self.browser.run("document.querySelector('#help summary').focus()")
        self.browser.press("Enter")
        self.assertTrue(self.browser.run("return document.getElementById('help').open"))
        self.check_clean(view)

    def test_curves_appear(self):
        view = self.view("--uart0", "null")
        begin = time.monotonic()
        self.open(view)
        self.assertLess(time.monotonic() - begin, 5)
        self.mode("over")
        for name, least in (
            ("raw", 1000),
            ("calibrated", 1000),
            ("dial", 1000),
            ("parameters", 2000),
            ("errors", 2000),
        ):
            self.assertGreater(self.painted(name), least, name)
        values = self.browser.run(
            """return [...document.querySelectorAll('#values tbody tr')]
            .map((row) => [...row.cells].map((cell) => cell.textContent))"""
        )
        self.assertEqual([row[0] for row in values], ["a1", "a2", "b1", "b2", "beta_rad"])
        for name, found, true, _ in values:
            self.assertAlmostEqual(float(found), float(true), 4, name)
        self.assertIn("VALID 1", self.text("verdict"))
        self.assertIn("flag LOCKCHG 1", self.text("verdict"))
        self.assertIn("self-calibration", self.text("terminal"))
        self.assertIn("STATUS", self.text("registers"))
        self.check_clean(view)
        self.press("end", "Enter")
        self.mode("ended")
        self.assertIn("exit code 0: the firmware ended with status 0", self.text("result"))
        view.process.communicate(timeout=60)
        self.assertEqual(view.process.returncode, 0)

    def moment(self):
        """What the page says of the bar, after it has drawn."""
        script = "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()));"
        self.browser.do("POST", "/execute/async", {"script": script, "args": []})
        return self.text("moment")

    def parts(self):
        """The table below the time line: name, share and times begun."""
        return self.browser.run(
            """return [...document.querySelectorAll('#parts tbody tr')]
            .map((row) => [...row.cells].map((cell) => cell.textContent))"""
        )

    def window(self, name):
        """Chosen by keyboard."""
        self.press("window", *name)
        wanted = f"return document.getElementById('window').selectedOptions[0].text === '{name}'"
        self.browser.wait(wanted, f"{name} is chosen")
        seconds = {"1 ms": 0.001, "10 ms": 0.01, "100 ms": 0.1, "1 s": 1, "10 s": 10}[name]
        self.browser.wait(
            f"return document.getElementById('activity').dataset.window === '{seconds}'", f"{name} is shown"
        )

    def read_bars(self, row, bars, now):
        """Each bar of a row, from the first to the last, by keyboard."""
        self.press("activity", *["ArrowUp"] * 40, *["ArrowDown"] * row, "Home")
        for name, begin, end in bars:
            wanted = told(name, begin, end, now)
            self.browser.wait(
                f"return document.getElementById('moment').textContent === '{wanted}'",
                f"{wanted!r}",
                5,
            )
            self.browser.press("ArrowRight")
        self.browser.press("End")
        self.browser.wait(f"return document.getElementById('moment').textContent === '{wanted}'", "it is the last", 5)

    def times_of_run(self, program, until_ps, *options):
        """By another process: a run with --timeline."""
        file = self.folder / "timeline.json"
        self.start("run", program, "--timeline", file, *options).communicate(timeout=120)
        return processor_times(file, until_ps)

    def compare_rows(self, times, begin, now):
        """Every bar of every row in a window, read by keyboard, with another run's times."""
        there = {name: [(at, to) for at, to in each if to > begin] for name, each in times.items()}
        shown = [row for row in self.parts() if row[1] != "0 %"]
        self.assertEqual({row[0] for row in shown}, {name for name, bars in there.items() if bars})
        for number, (name, share, begun) in enumerate(self.parts()):
            bars = there.get(name, [])
            busy = sum(to - max(at, begin) for at, to in bars)
            self.assertAlmostEqual(float(share.removesuffix(" %")), 100 * busy / (now - begin), delta=0.06)
            self.assertEqual(int(begun), sum(at >= begin and at > 0 for at, _ in bars), name)
            if bars:
                self.read_bars(number, [(name, *bar) for bar in bars], now)

    def test_the_time_line_of_the_main_job(self):
        view = self.view("--uart0", "null")
        self.open(view)
        self.mode("over")
        self.assertEqual([row[0] for row in self.parts()], ["asleep", "thread", "uart0 tx", "coprocessor"])
        whole = self.painted("activity")
        events = Events(view)
        view.do(events, "goto", time_s=1.0051)
        self.mode("paused")
        self.window("10 ms")
        frame = Events(view).next()[1]
        now, begin = frame["state"]["time_ps"], frame["activity"]["begin_ps"]
        times = self.times_of_run(FIRMWARE / "selfcal.elf", now, "--uart0", "null", "--simlimit", "1.2")
        self.assertGreater(len(times["coprocessor"]), 200)
        self.compare_rows(times, begin, now)
        painted = self.painted("activity")
        self.assertGreater(painted, 5000)
        # A long window has shares: of each handler alone the width would be a hundredth of a pixel.
        self.window("10 s")
        self.press("activity", *["ArrowUp"] * 5, "End")
        self.assertRegex(self.moment(), r"^asleep: [\d.]+ % of the [\d.]+ ms from [\d.]+ s$")
        self.press("activity", *["ArrowDown"] * 5, "End")
        self.assertRegex(self.moment(), r"^coprocessor: less than 0.4 % of the [\d.]+ ms from [\d.]+ s$")
        self.assertNotEqual(self.painted("activity"), whole)
        self.check_clean(view)

    def test_the_time_line_of_several_interrupts(self):
        """And what was after an instant is gone after going back to it."""
        view = self.view(FIRMWARE / "board.elf")
        self.open(view)
        self.mode("over")
        now = Events(view).next()[1]["state"]["time_ps"]
        times = self.times_of_run(FIRMWARE / "board.elf", now)
        self.assertEqual(times.keys(), {"asleep", "thread", "NMI", "dual_timer"})
        names = [row[0] for row in self.parts()]
        self.assertEqual(names, ["asleep", "thread", "NMI", "dual_timer"])
        self.compare_rows(times, 0, now)
        events = Events(view)
        first = {name: min(at for at, _ in each) for name, each in times.items()}
        self.assertLess(first["dual_timer"], first["NMI"])
        for until, left in (
            (first["NMI"] - 1_000_000, ["asleep", "thread", "dual_timer"]),
            (first["asleep"] - 1_000_000, ["thread"]),
        ):
            at = view.do(events, "goto", time_s=until / 1e12)["state"]["time_ps"]
            self.browser.wait("return document.documentElement.dataset.mode === 'paused'", "it is there")
            wanted = f"return document.querySelectorAll('#parts tbody tr').length === {len(left)}"
            self.browser.wait(wanted, "the later rows are gone")
            self.assertEqual([row[0] for row in self.parts()], left)
            until_then = {
                name: [(begin, min(end, at)) for begin, end in each if begin < at] for name, each in times.items()
            }
            self.compare_rows(until_then, 0, at)
        view.do(events, "run")
        self.mode("over")
        self.browser.wait("return document.querySelectorAll('#parts tbody tr').length === 4", "they are back")
        self.check_clean(view)

    def test_pointing_at_the_time_line(self):
        view = self.view(FIRMWARE / "board.elf")
        self.open(view)
        self.mode("over")
        self.press("activity", "ArrowUp")
        asleep = self.moment()
        self.assertIn("asleep: from", asleep)
        # The frame of the keyboard goes with the focus; that of the pointer with the pointer.
        self.browser.run("document.activeElement.blur(); document.getElementById('activity').scrollIntoView()")
        for row, name in enumerate(("asleep", "thread", "NMI", "dual_timer")):
            x, y = self.browser.run(
                """const box = document.getElementById('activity').getBoundingClientRect();
                scrollBy(0, box.top - 300);
                const there = document.getElementById('activity').getBoundingClientRect();
                return [there.left, there.top];"""
            )
            self.browser.wait("return document.getElementById('moment').textContent.startsWith('Point')", "nothing")
            found = False
            for step in range(100, 700, 4):
                self.browser.point_at(x + step, y + 24 * row + 12)
                if found := re.match(rf"{name}: from [\d.]+ s, [\d.]+ \S?s long", self.moment()):
                    break
            self.assertTrue(found, name)
            self.browser.point_at(x + 10, y - 60)
        nodes = self.browser.accessibility_tree()
        mine = [n for n in nodes if n.get("role", {}).get("value") == "application"]
        self.assertEqual(len(mine), 1)
        self.assertIn("Left and right arrows", mine[0]["name"]["value"])
        self.check_clean(view)

    def test_a_story(self):
        view = self.view("--story", "flipped-bit", "--realtime", "0", command="view")
        self.open(view)
        self.browser.wait("return document.getElementById('chapter').textContent.includes('(1 of 4)')", "its beginning")
        for step in (2, 3, 4):
            self.mode("paused")
            self.press("next", "Enter")
            wanted = f"return document.getElementById('chapter').textContent.includes('({step} of 4)')"
            self.browser.wait(wanted, f"step {step}")
        self.assertIn("bound of 1.44 degrees", self.text("tale"))
        self.assertFalse(self.browser.run("return document.getElementById('next').checkVisibility()"))
        self.check_clean(view)
        self.press("end", "Enter")
        view.process.communicate(timeout=60)

    def test_by_keyboard(self):
        view = self.view("--uart0", "null", "--realtime", "10", "--record-session", "a.session")
        self.open(view)
        self.mode("running")
        self.press("play", "Enter")
        self.mode("paused")
        self.assertIn(
            "firmware/", self.browser.wait("return document.getElementById('where').textContent", "where it is")
        )
        samples = self.browser.run("return document.getElementById('line').textContent")
        self.press("sample", " ")
        self.browser.wait("return document.getElementById('line').textContent.includes('one sample')", samples)
        self.press("turn", "Enter")
        self.browser.wait("return document.getElementById('line').textContent.includes('one turn')", "one turn")
        self.press("past", "Home")
        self.browser.wait("return document.getElementById('line').textContent.includes(': 0.000 s')", "the beginning")
        # One turn at least: how far the run came before the pause is the host's matter.
        end = float(re.search(r"the history has 0 to ([\d.]+) s", self.text("time"))[1])
        self.assertGreaterEqual(end, 20)
        self.press("past", "End")
        self.browser.wait(f"return document.getElementById('line').textContent.includes(': {int(end)}.')", "the end")
        self.browser.run(
            "document.querySelector('[name=a1]').value = '0.5'; document.querySelector('[name=a1]').focus()"
        )
        self.browser.press("Enter")
        self.browser.wait("return document.getElementById('time').textContent.includes('1 changes')", "a1 is changed")
        self.assertEqual(
            self.browser.run("return document.querySelectorAll('#values tbody tr')[0].cells[2].textContent"), "0.5"
        )
        self.press("reset", "Tab", "Tab")
        names = self.browser.run(
            """return [...document.querySelectorAll('button, select, input')]
            .map((e) => e.textContent.trim() || e.labels[0]?.textContent.trim() || '')"""
        )
        self.assertNotIn("", names)
        nodes = self.browser.accessibility_tree()
        named = {"button", "slider", "textbox", "combobox", "spinbutton", "img"}
        roles = [(n["role"]["value"], n.get("name", {}).get("value")) for n in nodes if not n.get("ignored")]
        self.assertEqual([each for each in roles if each[0] in named and not each[1]], [])
        self.assertGreater(len([each for each in roles if each[0] in named]), 20)
        self.check_clean(view)
        self.press("end", "Enter")
        view.process.communicate(timeout=60)
        self.assertIn("the same until", self.run_plain("replay", "a.session")[1])

    def test_narrow_and_dark(self):
        view = self.view("--uart0", "null")
        self.open(view)
        self.mode("over")
        backs = set()
        for dark in (False, True):
            for width in (400, 800, 1400):
                self.browser.emulate(width=width, dark=dark)
                wide, outside = self.browser.run(
                    """
                    const inside = (b) => !b.width || (b.left >= -0.5 && b.right <= innerWidth + 0.5);
                    const parts = [...document.querySelectorAll('main > *, canvas, button, input, select, pre')];
                    const outside = parts.filter((e) => !inside(e.getBoundingClientRect())).map((e) => e.id);
                    return [document.documentElement.scrollWidth, outside];
                    """
                )
                self.assertEqual((wide, outside), (width, []), (width, dark))
                self.assertGreater(self.painted("parameters"), 800)
                self.assertGreater(self.painted("activity"), 4 * width)
            backs.add(self.browser.run("return getComputedStyle(document.body).backgroundColor"))
        self.assertEqual(backs, {"rgb(255, 255, 255)", "rgb(18, 22, 27)"})
        self.check_clean(view)

    def test_ten_tabs(self):
        # Slow enough that the run is not over before a busy host has opened them all.
        view = self.view("--uart0", "null", "--realtime", "1")
        self.open(view)
        for _ in range(9):
            handle = self.browser.do("POST", "/window/new", {"type": "tab"})["handle"]
            self.browser.do("POST", "/window", {"handle": handle})
            self.open(view)
            self.mode("running")
        self.press("play", "Enter")
        self.mode("paused")
        handles = self.browser.do("GET", "/window/handles")
        self.assertEqual(len(handles), 10)
        self.browser.do("POST", "/window", {"handle": handles[0]})
        self.mode("paused")
        # The tab that listened is closed; another one takes its place.
        self.browser.do("DELETE", "/window")
        self.browser.do("POST", "/window", {"handle": handles[5]})
        self.press("play", "Enter")
        self.mode("running")
        self.assertGreater(len(Events(view).until(lambda frame: frame["mode"] == "running")), 0)

    def test_what_a_program_sends_is_text(self):
        view = self.view(FIRMWARE / "echo.elf")
        self.open(view)
        self.mode("asleep")
        hostile = "<img src=x onerror=window.hacked=1></pre><script>window.hacked=2</script>"
        view.tell("uart", uart=0, text=chr(len(hostile)) + "\0\0\0" + hostile)
        self.mode("over")
        self.assertEqual(self.text("terminal")[4:], hostile)
        self.assertIsNone(self.browser.run("return window.hacked ?? null"))
        self.check_clean(view)


if __name__ == "__main__":
    unittest.main()
