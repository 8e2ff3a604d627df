#!/usr/bin/python3
"""The stories of the live page: each has its end, is an ordinary run, and says figures that the run shows."""

import re
import tomllib
import unittest

from harness import SOURCE
from view_case import Events, ViewCase

CTEST = {"name": "view: stories", "timeout": 200}

STORIES = {
    story["name"]: story
    for story in tomllib.loads((SOURCE / "platform/view/stories.toml").read_text(encoding="utf-8"))["story"]
}
FAST = ("--realtime", "0")


def stands(frame):
    return frame["mode"] in ("paused", "over")


class Stories(ViewCase):
    def tell(self, name, *words):
        view = self.view("--story", name, *FAST, *words, command="view")
        events = Events(view)
        return view, events, events.until(lambda frame: stands(frame))[-1]

    def all_to_next(self, view, events):
        """The frames up to the next step."""
        number = view.tell("run")
        return events.until(lambda frame: frame["command"] >= number and stands(frame))

    def go_on(self, view, events):
        """The frame at the next step."""
        return self.all_to_next(view, events)[-1]

    def goto(self, view, events, time_s):
        return view.do(events, "goto", time_s=time_s)

    def errors(self, frames):
        return [error for frame in frames for error in frame["samples"].get("error_deg", []) if error is not None]

    def test_each_is_told_to_its_end(self):
        for name, story in STORIES.items():
            with self.subTest(name):
                view, events, frame = self.tell(name)
                for number, step in enumerate(story["step"], 1):
                    if frame["story"]["step"] < number:
                        frame = self.go_on(view, events)
                    told = frame["story"]
                    self.assertEqual((told["step"], told["steps"]), (number, len(story["step"])))
                    self.assertEqual(told["title"], story["title"])
                    self.assertEqual(told["text"], step["text"].strip().replace("\n", " "))
                    self.assertAlmostEqual(frame["state"]["time_s"], step["at_s"], delta=0.001)
                    done = sum("do" in each for each in story["step"][:number])
                    self.assertEqual(frame["history"]["inputs"], done)
                    self.assertEqual(frame["said"], [])
                self.assertEqual(view.end()[0], 0)

    def test_back_and_forward_again(self):
        view, events, first = self.tell("flipped-bit")
        self.assertEqual(first["story"]["step"], 1)
        self.go_on(view, events)
        third = self.go_on(view, events)
        self.assertEqual((third["story"]["step"], third["history"]["inputs"]), (3, 1))
        self.assertEqual(self.goto(view, events, 403.1)["story"]["step"], 1)
        second = self.go_on(view, events)
        self.assertEqual((second["story"]["step"], second["history"]["inputs"]), (2, 1))
        again = self.go_on(view, events)
        self.assertEqual(again["coprocessor"], third["coprocessor"])
        # Another future has the fault, too.
        self.goto(view, events, 403.1)
        view.do(events, "sensor", parameters={"b1": 0.15})
        self.assertEqual(self.go_on(view, events)["history"]["inputs"], 2)
        other = self.go_on(view, events)
        self.assertEqual(other["story"]["step"], 3)
        self.assertNotEqual(other["coprocessor"], third["coprocessor"])
        self.assertEqual(view.end()[0], 0)

    def test_it_is_recorded_like_any_run(self):
        view, events, _ = self.tell("parameters", "--record-session", "a.session")
        self.go_on(view, events)
        last = self.go_on(view, events)
        self.assertAlmostEqual(last["state"]["time_s"], 422, delta=0.001)
        code, _, said = view.end()
        self.assertEqual(code, 0, said)
        _, said = self.run_plain("replay", "a.session")
        self.assertRegex(said, r"the same until 422\S* s: 2 inputs")

    def test_what_the_texts_say(self):
        for name, number, said, low, high in (
            ("flipped-bit", 3, "0.7 degrees", 0.65, 0.75),
            ("dead-channel", 3, "1.8 degrees", 1.75, 1.85),
        ):
            with self.subTest(name):
                view, events, frame = self.tell(name)
                frames = [frame]
                while frames[-1]["story"]["step"] < number:
                    frames = self.all_to_next(view, events)
                self.assertIn(said, frames[-1]["story"]["text"])
                error = abs(self.errors(frames)[-1])
                self.assertTrue(low < error < high, error)
                view.end()
        view, events, frame = self.tell("dead-channel")
        while frame["story"]["step"] < 4:
            frame = self.go_on(view, events)
        self.assertEqual((frame["status"]["fields"]["ALARM"], frame["status"]["fields"]["LOCK"]), (1, 0))
        self.assertEqual(self.goto(view, events, 407.1)["status"]["fields"]["ALARM"], 0)
        view.end()

    def test_a_turn_tells_what_changed(self):
        view, events, frame = self.tell("parameters")
        spans = {}
        while frame["story"]["step"] < 5:
            frames = self.all_to_next(view, events)
            frame, errors = frames[-1], self.errors(frames)
            spans[frame["story"]["step"]] = (min(errors), max(errors))
        for step, low, high in ((3, -4.73, 4.73), (4, -2.91, 2.57), (5, -0.01, 2.88)):
            self.assertAlmostEqual(spans[step][0], low, delta=0.3, msg=step)
            self.assertAlmostEqual(spans[step][1], high, delta=0.3, msg=step)
        view.end()

    def test_texts_are_readable(self):
        for name, story in STORIES.items():
            times = [step["at_s"] for step in story["step"]]
            self.assertEqual(times, sorted(set(times)), name)
            for step in story["step"]:
                for sentence in re.split(r"(?<=[.:?]) ", step["text"].replace("\n", " ")):
                    self.assertLess(len(sentence.split()), 36, sentence)

    def test_refusals(self):
        self.run_plain("view", "--story", "nothing", code=2)
        _, said = self.run_plain("view", "--story", "flipped", code=2)
        self.assertIn("there is no story 'flipped'; did you mean flipped-bit", said)
        _, said = self.run_plain("run", "--story", "learning", code=2)
        self.assertIn("--story", said)


if __name__ == "__main__":
    unittest.main()
