#!/usr/bin/env python3
"""The live page's server over plain sockets: who is let in, what a page receives, what it can do, and what it cannot.

The oracle is the same run without a page, and `capsoc replay` of what was recorded.
"""

import json
import os
import socket
import time
import unittest
from pathlib import Path

from harness import FIRMWARE, without_host_times
from view_case import SHORT, Events, ViewCase

CTEST = {"name": "view", "timeout": 300}


class Door(ViewCase):
    """Only the page that was printed gets in, and what does not changes nothing."""

    def refused(self, view):
        """Requests of which each is to get 403."""
        token, right = view.token, {"X-Capsoc-Token": view.token}
        here = f"127.0.0.1:{view.port}"
        other = token[:-1] + ("0" if token[-1] != "0" else "1")
        yield "GET", "/", {}
        yield "GET", "/?token=", {}
        yield "GET", f"/?token={other}", {}
        yield "GET", f"/?token={token}0", {}
        yield "GET", "/events", {}
        yield "GET", f"/events?token={token[:16]}", {}
        yield "GET", "/nowhere", {}
        yield "POST", "/do", {}
        yield "POST", f"/do?token={token}", {}
        yield "POST", "/do", {"X-Capsoc-Token": other}
        for origin in (
            "http://example.org",
            f"https://{here}",
            "null",
            "http://127.0.0.1:1",
            f"http://{here}.example.org",
        ):
            yield "POST", "/do", {**right, "Origin": origin}
            yield "GET", f"/events?token={token}", {"Origin": origin}
        for host in ("example.org", f"example.org:{view.port}", "127.0.0.1", "127.0.0.1:1", f"{here}.example.org"):
            yield "POST", "/do", {**right, "Host": host}
            yield "GET", f"/?token={token}", {"Host": host}

    def test_no_token_or_another_site(self):
        view = self.view("--uart0", "null", "--json", "r.json")
        for method, path, headers in self.refused(view):
            with self.subTest(path=path, headers=headers):
                body = '{"do": "end"}' if method == "POST" else None
                status, text, answered = view.ask(method, path, body, headers)
                self.assertEqual(status, 403, text)
                self.assertNotIn(view.token, text)
                self.assertIsNone(answered["Access-Control-Allow-Origin"])
        self.assertIsNone(view.process.poll())
        events = Events(view)
        kind, frame = events.next()
        self.assertEqual((kind, frame["command"]), ("full", 0))
        events.until(lambda frame: frame["mode"] == "over")
        self.assertEqual(view.end()[0], 0)
        self.run_plain("run", "--uart0", "null", "--json", "plain.json")
        mine, plain = (without_host_times(self.result(name)) for name in ("r.json", "plain.json"))
        for result in (mine, plain):
            result.pop("command")
            result.pop("configuration")
        self.assertEqual(mine, plain)

    def test_the_page_and_its_policy(self):
        view = self.view()
        for name in ("127.0.0.1", "localhost"):
            host = f"{name}:{view.port}"
            status, text, headers = view.ask(
                "GET", f"/?token={view.token}", None, {"Host": host, "Origin": f"http://{host}"}
            )
            self.assertEqual(status, 200)
            self.assertNotIn(view.token, text)
            self.assertNotRegex(text, r"https?://")
            policy = headers["Content-Security-Policy"]
            self.assertIn("default-src 'none'; script-src 'sha256-", policy)
            self.assertNotIn("unsafe", policy)
            self.assertEqual((headers["Cache-Control"], headers["Referrer-Policy"]), ("no-store", "no-referrer"))
        self.assertEqual(view.ask("GET", f"/nowhere?token={view.token}")[0], 404)
        self.assertEqual(view.ask("GET", f"/do?token={view.token}")[0], 404)
        with socket.socket() as outside:
            # Loopback alone: not on the addresses that others reach.
            self.assertNotEqual(outside.connect_ex((socket.gethostbyname(socket.gethostname()), 1)), 0)
        table = Path("/proc/net/tcp").read_text(encoding="ascii")
        listening = [line.split()[1] for line in table.splitlines()[1:]]
        self.assertIn(f"0100007F:{view.port:04X}", listening)
        self.assertNotIn(f"00000000:{view.port:04X}", listening)
        self.assertIn("closed at 0 simulated s", view.end()[2])

    def test_tokens_differ(self):
        tokens = [self.view().token for _ in range(2)]
        self.assertNotEqual(*tokens)
        self.assertRegex(tokens[0], r"\A[0-9a-f]{32}\Z")

    def test_rubbish(self):
        view = self.view(*SHORT, "--uart0", "null")
        for body in ("", "no JSON", "[]", "1", '{"do": 1}', '{"what": "end"}', "[" * 60_000, '{"do": "\xff'):
            with self.subTest(body=body[:20]):
                self.assertEqual(view.post(body.encode("latin-1"))[0], 400)
        self.assertIn(view.post(b"x" * 100_000)[0], (400, 413))
        for rubbish in (
            b"\0" * 5000,
            b"GET / HTTP/9.9\r\n\r\n",
            os.urandom(5000),
            b"GET /" + b"a" * 100_000,
            b"\r\n" * 1000,
        ):
            with socket.create_connection(("127.0.0.1", view.port)) as raw:
                try:
                    raw.sendall(rubbish)
                except OSError:
                    pass  # it hung up first
        held = [socket.create_connection(("127.0.0.1", view.port)) for _ in range(100)]
        events = Events(view)
        for what, more, words in (
            ("nonsense", {}, "no command 'nonsense'"),
            ("goto", {"time_s": "x"}, "goto: give"),
            ("goto", {"time_s": -1}, ""),
            ("speed", {"factor": -1}, "speed: give"),
            ("sensor", {"parameters": {"a1": "x"}}, "a1"),
            ("sensor", {"parameters": 5}, "sensor: give"),
            ("sensor", {"parameters": {"motion.kind": "walk"}}, "motion"),
            ("sensor", {"parameters": {"speed": -1}}, "from 0 to 1000"),
            ("fault", {"fault": "flip cpu.r99[1]"}, "no register 'r99'"),
            ("fault", {"fault": "flip mem:x[1]"}, "no variable"),
            ("fault", {"fault": "flip cpu.r1[32]"}, "its bits are 0 to 31"),
            ("fault", {"fault": "flip UART9.DATA[3]"}, "UART9"),
            ("fault", {"fault": "flip cpu.r1[3] at 0s"}, "its time is past"),
            ("fault", {}, "fault"),
            ("uart", {"uart": 9, "text": "x"}, "uart"),
            ("uart", {}, "uart"),
            ("button", {}, "button"),
            ("registers", {"peripheral": []}, "no such peripheral"),
            ("activity", {}, "activity: give"),
            ("activity", {"window_s": 0}, "activity: give"),
            ("activity", {"window_s": 0.5}, "window_s is 0.001, 0.01"),
        ):
            with self.subTest(what=what, more=more):
                said = view.do(events, what, **more)["said"]
                self.assertEqual(len(said), 1, said)
                self.assertIn(words, said[0])
        for each in held:
            each.close()
        self.assertEqual(view.do(events, "pause")["history"]["inputs"], 0)

    def test_what_is_refused(self):
        for options, sentence in (
            (["--view", "--gdb", "0"], "--view: a debugger cannot steer the same run"),
            (["--view", "--trace-bus", "t"], "--view: there is no history: trace.bus"),
            (["--view=65536"], "65535"),
        ):
            with self.subTest(options=options):
                said = self.run_plain("run", *options, code=2)[1]
                self.assertIn(sentence, said)


class Told(ViewCase):
    """What a page receives."""

    def test_the_run_begins_with_the_page_and_is_told_whole(self):
        view = self.view("--json", "r.json")
        time.sleep(0.3)
        events = Events(view)
        frames = events.until(lambda frame: frame["mode"] == "over")
        self.assertEqual(frames[0]["mode"], "waiting")
        self.assertEqual(frames[0]["state"]["time_s"], 0)
        self.assertIn("COPROCESSOR", frames[0]["peripherals"])
        last = frames[-1]
        self.assertEqual((last["flags"]["fields"]["LOCKCHG"], last["status"]["fields"]["VALID"]), (1, 1))
        self.assertAlmostEqual(last["sensor"]["parameters"]["a1"], 0.6079)
        found = [a1 for frame in frames for a1 in frame["samples"]["a1"]]  # the last frame may have no sample
        self.assertAlmostEqual(found[-1], 0.6079, 4)
        times = [t for frame in frames for t in frame["samples"]["t"]]
        self.assertEqual(times, sorted(set(times)))
        self.assertGreater(times[-1], 419)
        for frame in frames:
            self.assertEqual({len(column) for column in frame["samples"].values()}, {len(frame["samples"]["t"])})
            self.assertLessEqual(len(frame["samples"]["t"]), 241)
        names = [each["name"] for each in last["registers"]]
        self.assertIn("STATUS", names)
        code, out, said = view.end()
        finished = events.until(lambda frame: frame["mode"] == "ended")[-1]["finished"]
        self.assertEqual((code, finished["code"]), (0, 0))
        self.assertIn(finished["table"], said)
        self.assertEqual("".join(frame["text"].get("uart0", "") for frame in frames), out)
        self.assertEqual(out, self.run_plain("run")[0])

    def test_a_frame_is_of_one_instant(self):
        """Although the run continues while the frame is made, and what is asked for comes in between."""
        view = self.view("--uart0", "null", "-P", "demodulation_samples=300000")
        events = Events(view)
        frames = [events.next()[1] for _ in range(8)]
        view.tell("fault", fault="flip COPROCESSOR.STEP_AU[3]")
        frames += events.until(lambda frame: frame["command"] == 1)
        frames += events.until(lambda frame: frame["mode"] == "over")
        self.assertGreater(sum(frame["mode"] == "running" for frame in frames), 5)
        for frame in frames:
            state, times = frame["state"], frame["samples"]["t"]
            self.assertEqual(frame["activity"]["end_ps"], state["time_ps"])
            self.assertAlmostEqual(frame["history"]["end_s"], state["time_s"], 9)
            self.assertTrue(all(t <= state["time_s"] for t in times))
        self.assertEqual((frames[-1]["history"]["inputs"], frames[-1]["said"]), (1, []))
        view.end()

    def test_a_later_page_is_told_what_was_before(self):
        view = self.view("--uart0", "null")
        Events(view).until(lambda frame: frame["mode"] == "over")
        kind, frame = Events(view).next()
        self.assertEqual((kind, frame["mode"]), ("full", "over"))
        self.assertGreater(len(frame["samples"]["t"]), 300)
        self.assertLess(frame["samples"]["t"][0], 1)
        self.assertIn("self-calibration", frame["text"]["uart0"])

    def test_the_pace(self):
        view = self.view("--realtime", "20")
        events = Events(view)
        frames = [events.next()[1] for _ in range(30)]
        begin, first = time.monotonic(), frames[-1]["state"]["time_s"]
        frames = events.until(lambda frame: frame["state"]["time_s"] > first + 20)
        pace = (frames[-1]["state"]["time_s"] - first) / (time.monotonic() - begin)
        self.assertTrue(10 < pace < 30, pace)
        self.assertGreater(len(frames), 5)

    def test_the_time_line_is_bounded(self):
        """Of a program with thousands of handlers a millisecond, in windows of any length."""
        view = self.view(FIRMWARE / "bench_interrupts.elf", "--simlimit", "0.3")
        events = Events(view)
        for window in (0.001, 0.01, 0.1, 1, 10, 100):
            frame = view.do(events, "activity", window_s=window)
            self.assertEqual((frame["said"], frame["activity"]["window_s"]), ([], window))
            self.assertLess(len(json.dumps(frame["activity"], separators=(",", ":"))), 64 * 1024)
        if frame["mode"] != "over":
            events.until(lambda frame: frame["mode"] == "over")
        for window in (100, 0.1, 0.001):
            activity = view.do(events, "activity", window_s=window)["activity"]
            self.assertLess(len(json.dumps(activity, separators=(",", ":"))), 64 * 1024)
            self.assertEqual(activity["end_ps"], 300_000_000_000)
            self.assertGreater(len(activity["rows"]), 30)
            self.assertEqual("shares" in activity["rows"][0], window > 0.001)
        view.end()

    def test_the_time_line_after_going_back(self):
        """What was before is there although it was recorded nowhere; what was after is not."""
        view = self.view("--uart0", "null")
        events = Events(view)
        frame = events.until(lambda frame: frame["mode"] == "over")[-1]
        self.assertEqual([row["name"] for row in frame["activity"]["rows"]][-1], "coprocessor")
        frame = view.do(events, "activity", window_s=100)
        self.assertEqual((frame["mode"], frame["said"]), ("over", []))
        for time_s, window in ((200, 10), (100.0005, 0.1), (0.009, 1), (150, 1)):
            view.do(events, "goto", time_s=time_s)
            frame = view.do(events, "activity", window_s=window)
            activity = frame["activity"]
            self.assertEqual((frame["mode"], activity["end_ps"]), ("paused", frame["state"]["time_ps"]))
            self.assertEqual(activity["known_ps"], activity["begin_ps"])
            begun = {row["name"]: row["begun"] for row in activity["rows"]}
            if time_s < 1:
                self.assertEqual(list(begun), ["thread"])
            else:
                samples = (activity["end_ps"] - activity["begin_ps"]) / 4e9
                self.assertAlmostEqual(begun["coprocessor"], samples, delta=1.1)
        view.end()

    def test_a_page_that_does_not_read(self):
        view = self.view("--uart0", "null", "--realtime", "100000")
        slow = [Events(view, receive_buffer=4096) for _ in range(3)]
        fast = Events(view)
        fast.until(lambda frame: frame["mode"] == "over")
        for factor in range(1, 801):
            view.tell("speed", factor=factor)
            if factor % 100 == 0:
                fast.until(lambda frame, wanted=factor: frame["command"] >= wanted)
        last = view.do(fast, "speed", factor=1000)["command"]
        status = Path(f"/proc/{view.process.pid}/status").read_text(encoding="ascii")
        resident = next(int(line.split()[1]) for line in status.splitlines() if line.startswith("VmHWM"))
        self.assertLess(resident, 200_000)
        # It reads again and gets the complete state.
        frames = []
        while not frames or frames[-1][1]["command"] != last:
            frames.append(slow[0].next())
        self.assertEqual([kind for kind, _ in frames[1:]], ["update"] * (len(frames) - 2) + ["full"])
        self.assertGreater(len(frames[-1][1]["samples"]["t"]), 300)

    def test_pages_that_come_and_go(self):
        view = self.view("--uart0", "null", "--realtime", "50")
        pages = [Events(view) for _ in range(10)]
        for page in pages:
            page.next()
        for page in pages[1:]:
            page.close()
        frames = pages[0].until(lambda frame: frame["state"]["time_s"] > 20)
        self.assertEqual(frames[-1]["mode"], "running")
        pages[0].close()
        time.sleep(0.5)
        events = Events(view)
        self.assertGreater(events.next()[1]["state"]["time_s"], 20)
        many = [Events(view) for _ in range(31)]
        self.assertEqual(view.ask("GET", f"/events?token={view.token}")[0], 503)
        for page in many:
            page.close()
        view.do(events, "speed", factor=0)
        events.until(lambda frame: frame["mode"] == "over")
        self.assertEqual(view.end()[0], 0)


class Hands(ViewCase):
    """What a page can do, and that it can be replayed."""

    def replay(self):
        out, said = self.run_plain("replay", "a.session")
        self.assertIn("the same until", said)
        return out, said

    def test_steps(self):
        view = self.view("--uart0", "null")
        events = Events(view)
        paused = view.do(events, "pause")
        self.assertEqual(paused["mode"], "paused")
        at = view.do(events, "goto", time_s=100)["state"]
        self.assertAlmostEqual(at["time_s"], 100, 5)
        one = view.do(events, "sample")["state"]
        self.assertEqual(one["samples"], at["samples"] + 1)
        turn = view.do(events, "turn")
        self.assertAlmostEqual(turn["state"]["time_s"] - one["time_s"], 20, 6)
        self.assertIn("sampling_wait", turn["place"])
        back = view.do(events, "goto", time_s=50)
        self.assertAlmostEqual(back["state"]["time_s"], 50, 5)
        self.assertGreaterEqual(back["history"]["end_s"], 120)
        registers = view.do(events, "registers", peripheral="UART0")["registers"]
        self.assertIn("BAUDDIV", [each["name"] for each in registers])
        view.do(events, "speed", factor=0)
        view.do(events, "run")
        events.until(lambda frame: frame["mode"] == "over")
        self.assertIn("over", view.do(events, "run")["said"][0])
        self.assertEqual(view.do(events, "goto", time_s=1)["mode"], "paused")
        view.tell("run")
        events.until(lambda frame: frame["mode"] == "over")
        self.assertEqual(view.end()[0], 0)

    def test_what_was_done_is_replayed(self):
        view = self.view("--record-session", "a.session", "--realtime", "50")
        events = Events(view)
        events.until(lambda frame: frame["state"]["time_s"] > 2)
        view.do(events, "pause")
        one = view.do(events, "sensor", parameters={"a1": 0.5, "harmonics.u3_amplitude": 0.002})
        view.do(events, "run")
        events.until(lambda frame: frame["state"]["time_s"] > one["state"]["time_s"] + 2)
        frame = view.do(events, "sensor", parameters={"speed": 1.5})
        self.assertAlmostEqual(frame["sensor"]["parameters"]["frequency_hz"], 0.075)
        view.do(events, "pause")
        before = view.do(events, "registers", peripheral="COPROCESSOR")["registers"]
        view.do(events, "fault", fault="flip COPROCESSOR.STEP_AU[3]")
        after = view.do(events, "sample")["registers"]
        changed = {a["name"]: a["value"] ^ b["value"] for a, b in zip(before, after)}
        self.assertEqual((changed["STEP_AU"], changed["STEP_BU"]), (8, 0))
        view.do(events, "fault", fault="flip mem:0x20300000[9]")
        view.do(events, "fault", fault="flip cpu.r12[31]")
        view.do(events, "button", button=1, pressed=True)
        frame = view.do(events, "sample")
        self.assertEqual(frame["history"]["inputs"], 6)
        view.do(events, "goto", time_s=one["state"]["time_s"] + 1)
        view.do(events, "sensor", parameters={"b1": 0.1})
        frame = view.do(events, "turn")
        self.assertEqual(frame["history"]["inputs"], 2)
        code, out, said = view.end()
        self.assertNotEqual(code, 70, said)
        replayed, about = self.replay()
        self.assertEqual(replayed, out)
        self.assertIn("2 inputs", about)

    def test_a_recorded_session(self):
        """The page of one: what was changed changes again, on the way there and back."""
        view = self.view("--uart0", "null", "--record-session", "a.session", "--realtime", "50")
        events = Events(view)
        view.do(events, "pause")
        view.do(events, "goto", time_s=20)
        changed = view.do(events, "sensor", parameters={"a1": 0.5})["state"]["time_s"]
        view.do(events, "goto", time_s=40)
        view.end()
        again = self.view("a.session", "--view", "0", command="replay")
        events = Events(again)
        again.do(events, "pause")
        for time_s, a1 in ((30, 0.5), (15, 0.6079), (39, 0.5), (5, 0.6079)):
            frame = again.do(events, "goto", time_s=time_s)
            self.assertAlmostEqual(frame["sensor"]["parameters"]["a1"], a1)
        self.assertAlmostEqual(changed, 20, 3)
        self.assertEqual(frame["history"]["inputs"], 1)
        again.end()
        _, said = self.run_plain("replay", "a.session", "--view", "0", "--gdb", "0", code=2)
        self.assertIn("--view: a debugger cannot steer the same run", said)
        for option in ("--view", "--gdb"):
            _, said = self.run_plain("replay", "a.session", option, "-1", code=2)
            self.assertIn(f"{option}: a port is 0 (a free one) to 65535", said)

    def test_a_terminal(self):
        view = self.view(FIRMWARE / "echo.elf", "--record-session", "a.session")
        events = Events(view)
        events.until(lambda frame: frame["mode"] == "asleep")
        view.tell("uart", uart=0, text="\x03\0\0\0abc")
        frames = events.until(lambda frame: frame["mode"] == "over")
        self.assertEqual("".join(frame["text"].get("uart0", "") for frame in frames), "\x03\0\0\0abc")
        code, out, _ = view.end()
        self.assertEqual((code, out), (0, "\x03\0\0\0abc"))
        self.assertEqual(self.replay()[0], out)

    def test_a_signal_ends_it(self):
        view = self.view(*SHORT, "--json", "r.json")
        events = Events(view)
        events.until(lambda frame: frame["mode"] == "over")
        view.process.terminate()
        self.assertEqual(events.until(lambda frame: frame["mode"] == "ended")[-1]["mode"], "ended")
        view.process.communicate(timeout=60)
        self.assertEqual((view.process.returncode, self.result()["exit"]["code"]), (143, 143))

    def test_the_command_view(self):
        view = self.view("--uart0", "null", command="view")
        self.assertEqual(Events(view).next()[1]["speed"], 10)
        view = self.view("--uart0", "null", "--realtime", "3", command="view")
        self.assertEqual(Events(view).next()[1]["speed"], 3)


if __name__ == "__main__":
    unittest.main()
