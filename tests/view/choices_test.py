#!/usr/bin/env python3
"""Another run on the same page: a story, a program and the arithmetic, from lists that the page was given.

The oracle is a run of the same choice without a page, and `capsoc replay` of what was recorded.
"""

import shutil
import unittest

from harness import FIRMWARE, without_host_times
from view_case import SHORT, Browsed, Events, ViewCase

CTEST = {"name": "view: choices", "timeout": 300}


class Another(ViewCase):
    """Over plain sockets."""

    def begin(self, *arguments, **keywords):
        """(view, events, first frame)"""
        view = self.view(*arguments, **keywords)
        events = Events(view)
        return view, events, events.next()[1]

    def new(self, view, events, **choice):
        """The frame that begins the new run, which has everything."""
        number = view.tell("new", **choice)
        while True:
            kind, frame = events.next()
            if frame["command"] >= number:
                return kind, frame

    def test_what_there_is(self):
        _, _, frame = self.begin()
        choices = frame["choices"]
        self.assertEqual(choices["programs"][0], "selfcal")
        self.assertLessEqual({"calibrate", "track", "echo", "safe"}, set(choices["programs"]))
        self.assertEqual(choices["arithmetics"], ["paper", "precise"])
        self.assertIn({"name": "paper", "title": choices["stories"][2]["title"]}, choices["stories"])
        self.assertEqual(frame["run"], {"story": "", "program": "selfcal", "arithmetic": ""})
        # Programs of its folder, which has others, too.
        mine = self.folder / "mine"
        mine.mkdir()
        shutil.copy(FIRMWARE / "echo.elf", mine / "my echo.elf")
        shutil.copy(FIRMWARE / "hello.elf", mine / "b.elf")
        (mine / "c.elf").mkdir()
        (mine / "notes.txt").write_text("x", encoding="utf-8")
        _, _, frame = self.begin(mine / "b.elf", "--story", "paper", command="view")
        programs = frame["choices"]["programs"]
        self.assertEqual(programs[0], "b.elf")
        self.assertEqual([name for name in programs if name.endswith(".elf")], ["b.elf", "my echo.elf"])
        self.assertIn("selfcal", programs)
        self.assertEqual(frame["run"], {"story": "paper", "program": "b.elf", "arithmetic": ""})

    def test_it_is_the_run_of_that_choice(self):
        view, events, _ = self.begin("--record-session", "a.session", "--json", "r.json", "-C", "sensor.a1=0.5")
        view.do(events, "pause")
        view.do(events, "sensor", parameters={"b1": 0.1})
        kind, frame = self.new(view, events, program="echo", arithmetic="paper")
        self.assertEqual((kind, frame["said"], frame["host_s"]), ("full", [], 0))
        self.assertEqual((frame["state"]["time_s"], frame["history"]["inputs"]), (0, 0))
        self.assertEqual(frame["samples"]["t"], [])
        self.assertEqual(frame["run"], {"story": "", "program": "echo", "arithmetic": "paper"})
        self.assertEqual(frame["sensor"]["parameters"]["a1"], 0.5)
        events.until(lambda frame: frame["mode"] == "asleep")
        kind, frame = self.new(view, events, program="selfcal")
        self.assertEqual(frame["run"]["arithmetic"], "")
        kind, frame = self.new(view, events, program="selfcal", arithmetic="paper")
        self.assertEqual(kind, "full")
        view.do(events, "pause")
        view.do(events, "sensor", parameters={"b2": 0.1})
        view.tell("run")
        events.until(lambda frame: frame["mode"] == "over")
        text = Events(view).next()[1]["text"]["uart0"]
        self.assertEqual((text.count("self-calibration"), text.count("paper arithmetic")), (1, 1))
        code, out, said = view.end()
        again, about = self.run_plain("replay", "a.session")
        self.assertIn("1 inputs", about)
        self.assertTrue(out.endswith(again), out)
        self.assertIn("the same until", about)
        self.assertEqual(code, self.result()["exit"]["code"], said)

    def test_its_result_is_that_of_a_plain_run(self):
        view, events, _ = self.begin("--uart0", "null", "--json", "r.json", FIRMWARE / "echo.elf")
        self.new(view, events, program="track", arithmetic="paper")
        events.until(lambda frame: frame["mode"] == "over")
        self.assertEqual(view.end()[0], 0)
        options = ("-C", "coprocessor.arithmetic=paper", "--uart0", "null", "--json", "plain.json")
        self.run_plain("run", FIRMWARE / "track.elf", *options)
        mine, plain = (without_host_times(self.result(name)) for name in ("r.json", "plain.json"))
        for result in (mine, plain):
            result.pop("command")
            result.pop("configuration")
        self.assertEqual(mine, plain)

    def test_a_story(self):
        view, events, frame = self.begin("--uart0", "null", "--record-session", "a.session")
        self.assertIsNone(frame["story"])
        _, frame = self.new(view, events, story="flipped-bit")
        self.assertEqual((frame["story"]["steps"], frame["speed"]), (4, 2))
        _, frame = self.new(view, events, story="")
        self.assertIsNone(frame["story"])
        _, frame = self.new(view, events, story="flipped-bit")
        view.tell("speed", factor=0)
        for step in (1, 2, 3):
            events.until(lambda frame, n=step: frame["mode"] == "paused" and frame["story"]["step"] == n)
            view.tell("run")
        events.until(lambda frame: frame["mode"] == "paused" and frame["story"]["step"] == 4)
        self.assertEqual(view.end()[0], 0)
        self.assertIn("1 inputs", self.run_plain("replay", "a.session")[1])

    def test_what_the_command_line_says_comes_before_a_story(self):
        """As at the start. What the page says comes before both."""
        for options, choice, arithmetic in (
            ([], {}, "paper"),
            (["--arithmetic", "precise"], {}, "precise"),
            (["--arithmetic", "precise"], {"arithmetic": "paper"}, "paper"),
            ([], {"arithmetic": "precise"}, "precise"),
        ):
            with self.subTest(options=options, choice=choice):
                view, events, _ = self.begin("--uart0", "null", *options)
                _, frame = self.new(view, events, story="paper", **choice)
                self.assertEqual(frame["run"], {"story": "paper", "program": "selfcal", "arithmetic": "", **choice})
                view.tell("speed", factor=0)
                events.until(lambda frame: frame["mode"] == "paused")
                view.tell("run")
                frames = events.until(lambda frame: frame["mode"] == "paused" and frame["story"]["step"] == 2)
                text = "".join(frame["text"].get("uart0", "") for frame in frames)
                self.assertIn(f"{arithmetic} arithmetic", text)
                view.end()

    def test_what_is_refused_leaves_the_run(self):
        view, events, _ = self.begin(*SHORT, "--uart0", "null", "--realtime", "1")
        view.do(events, "pause")
        time_s = view.do(events, "sample")["state"]["time_s"]
        for choice, sentence in (
            ({"program": "selfcall"}, "there is no program 'selfcall'; did you mean selfcal"),
            ({"program": str(FIRMWARE / "echo.elf")}, "there is no program '"),
            ({"program": "../firmware/echo"}, "there is no program '../firmware/echo'"),
            ({"program": "/etc/passwd"}, "there is no program '/etc/passwd'"),
            ({"program": 5}, "new: story, program and arithmetic are texts"),
            ({"story": "flipped"}, "there is no story 'flipped'; did you mean flipped-bit"),
            ({"story": None}, "new: story, program and arithmetic are texts"),
            ({"arithmetic": "exact"}, "new: arithmetic is paper or precise"),
            ({"program": "hello"}, "hello.elf has no settings"),
        ):
            with self.subTest(choice=choice):
                frame = view.do(events, "new", **choice)
                self.assertEqual(len(frame["said"]), 1)
                self.assertIn(sentence, frame["said"][0])
                self.assertTrue(frame["said"][0].startswith("new: "))
                self.assertEqual((frame["mode"], frame["state"]["time_s"]), ("paused", time_s))
                self.assertEqual(frame["run"]["program"], "selfcal")
        view.tell("speed", factor=0)
        view.tell("run")
        events.until(lambda frame: frame["mode"] == "over")
        view.end()

    def test_a_recording_has_no_choice(self):
        view, events, _ = self.begin(*SHORT, "--uart0", "null", "--record-session", "a.session")
        events.until(lambda frame: frame["mode"] == "over")
        view.end()
        view, events, frame = self.begin("a.session", "--view", "0", command="replay")
        self.assertEqual((frame["choices"], frame["run"]), (None, None))
        self.assertIn("a recording is shown", view.do(events, "new", program="echo")["said"][0])
        view.end()

    def test_old_runs_leave_nothing(self):
        view, events, _ = self.begin("--uart0", "null")
        tasks = f"/proc/{view.process.pid}/task/{view.process.pid}/children"
        with open(tasks, encoding="ascii") as file:
            session = file.read().split()[0]
        for _ in range(20):
            _, frame = self.new(view, events, program="echo")
            self.assertEqual(frame["said"], [])
        view.do(events, "pause")
        with open(f"/proc/{session}/task/{session}/children", encoding="ascii") as file:
            self.assertLess(len(file.read().split()), 4)
        view.end()


class OnThePage(Browsed):
    """In a browser, by keyboard."""

    def choose(self, name, text, *keys):
        self.press(name, *(keys or text))
        self.browser.wait(f"return document.getElementById('{name}').selectedOptions[0].text === '{text}'", text)

    def begin(self):
        self.browser.run("document.querySelector('#new button').focus()")
        self.browser.press("Enter")

    def test_another_run(self):
        view = self.view("--uart0", "null", "--realtime", "1", "-P", "demodulation_samples=2000")
        self.open(view)
        self.assertFalse(self.browser.run("return document.getElementById('new').checkVisibility()"))
        self.browser.run("document.querySelector('#another summary').focus()")
        self.browser.press("Enter")
        self.assertEqual(self.text("now").split(";")[:2], ["story: none", " program: selfcal"])
        self.choose("new-program", "echo")
        self.begin()
        self.browser.wait("return document.getElementById('said').textContent", "a sentence")
        self.assertIn("echo.elf has no settings", self.text("said"))
        self.mode("running")
        title = "Why the arithmetic of the paper stops at 1e-4"
        self.choose("new-program", "selfcal", "Home")  # letters would continue the last word
        self.choose("new-story", title)
        self.choose("new-arithmetic", "paper")
        self.begin()
        self.browser.wait("return document.getElementById('chapter').textContent.includes('(1 of ')", "its beginning")
        self.assertIn(title, self.text("now"))
        self.assertIn("arithmetic: paper", self.text("now"))
        self.assertEqual(self.text("said"), "")
        self.mode("paused")
        samples = self.browser.run("return document.getElementById('line').textContent")
        self.assertIn("paused: ", samples)
        nodes = self.browser.accessibility_tree()
        names = [n["name"]["value"] for n in nodes if n.get("role", {}).get("value") == "combobox"]
        self.assertLessEqual({"Story", "Program", "Arithmetic"}, set(names))
        for dark in (False, True):
            for width in (400, 1400):
                self.browser.emulate(width=width, dark=dark)
                wide, outside = self.browser.run(
                    """
                    const parts = [...document.querySelectorAll('#another, #another *')];
                    const inside = (b) => !b.width || (b.left >= -0.5 && b.right <= innerWidth + 0.5);
                    const outside = parts.filter((e) => !inside(e.getBoundingClientRect()));
                    return [document.documentElement.scrollWidth, outside.map((e) => e.id || e.tagName)];
                    """
                )
                self.assertEqual((wide, outside), (width, []), (width, dark))
        self.check_clean(view)
        self.press("end", "Enter")
        self.mode("ended")
        self.assertTrue(self.browser.run("return document.querySelector('#new button').disabled"))
        view.process.communicate(timeout=60)

    def test_each_tab_has_the_new_run(self):
        view = self.view("--uart0", "null")
        self.open(view)
        self.mode("over")
        first = self.browser.do("GET", "/window")
        handle = self.browser.do("POST", "/window/new", {"type": "tab"})["handle"]
        self.browser.do("POST", "/window", {"handle": handle})
        self.open(view)
        self.mode("over")
        number = view.tell("new", program="echo")
        for each in (handle, first):
            self.browser.do("POST", "/window", {"handle": each})
            wanted = f"return document.documentElement.dataset.command === '{number}'"
            self.browser.wait(wanted, "the new run")
            self.mode("asleep")
            self.assertEqual(self.text("terminal"), "")
            self.assertIn("0 samples", self.text("line"))
        self.check_clean(view)


if __name__ == "__main__":
    unittest.main()
