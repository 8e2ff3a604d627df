#!/usr/bin/env python3
"""Failures that a report explains by itself: cause, line and call stack, compared with gdb-multiarch's."""

import json
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import CAPSOC, CLEAN, FIRMWARE, SOURCE

CTEST = {"name": "failures"}

FAILURES = FIRMWARE / "failures.elf"
(
    NULL_WRITE,
    OVERFLOW,
    SVC_PRIORITY,
    DEADLOCK,
    ASLEEP,
    LOST_WRITE,
    FAILED_CHECK,
    FAULT_IN_HANDLER,
    PRINTED_WARNING,
) = range(1, 10)


def capsoc(elf, *options, code=None):
    """`capsoc run`: exit code and stderr."""
    done = subprocess.run(
        [CAPSOC, "run", elf, "--simlimit", "0.2", *map(str, options)],
        capture_output=True,
        timeout=120,
        check=False,
        env=CLEAN,
    )
    text = done.stderr.decode()
    if code is not None and done.returncode != code:
        raise AssertionError(f"exit code {done.returncode}, not {code}:\n{text}")
    return text


def fail(number, *options, code=None):
    return capsoc(FAILURES, "-P", f"failure={number}", *options, code=code)


def marked(text):
    """The line of failures.c with that comment, as reports name it."""
    lines = (SOURCE / "firmware/tests/failures.c").read_text().splitlines()
    return "firmware/tests/failures.c:%d" % next(n for n, line in enumerate(lines, 1) if line.endswith(f"// {text}"))


def stack_of(report):
    """(function, file:line) of each frame of a report, "exception" for one that was entered."""
    frames = []
    for line in report.splitlines():
        frame = re.match(r"    #\d+ +0x[0-9a-f]{8}  ([\w.]+)(?:\+0x[0-9a-f]+)?(?:, (\S+:\d+))?", line)
        if frame:
            frames.append((frame.group(1), frame.group(2)))
        elif line.startswith("    -- exception"):
            frames.append("exception")
        elif "times more" in line:
            frames += [frames[-1]] * int(re.search(r"the same (\d+)", line).group(1))
    return frames


def gdb_stack(number, stop, *options):
    """The same by gdb-multiarch, where `stop` is reached."""
    run = subprocess.Popen(
        [CAPSOC, "run", FAILURES, "-P", f"failure={number}", "--gdb", "0", "--halt", *options],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        env=CLEAN,
    )
    try:
        port = re.search(r"127\.0\.0\.1:(\d+)", run.stderr.readline().decode()).group(1)
        text = subprocess.run(
            [
                "gdb-multiarch",
                "-nx",
                "-batch",
                "-ex",
                "set width 0",
                "-ex",
                "set backtrace past-main on",
                "-ex",
                f"target remote :{port}",
                "-ex",
                f"break {stop}",
                "-ex",
                "continue",
                "-ex",
                "backtrace",
                FAILURES,
            ],
            capture_output=True,
            timeout=60,
            check=False,
        ).stdout.decode()
    finally:
        run.kill()
        run.communicate()
    frames = []
    for line in text.splitlines():
        frame = re.match(r"#\d+ +(?:0x[0-9a-f]+ in )?(\w+) \(.*\) at (?:\./)?(\S+:\d+)", line)
        if frame:
            frames.append((frame.group(1), frame.group(2)))
        elif "<signal handler called>" in line:
            frames.append("exception")
    return frames


class Explained(unittest.TestCase):
    """The report alone says what happened."""

    def check(self, report, *parts):
        for part in parts:
            self.assertIn(part, report)

    def test_a_null_write_into_the_vector_table(self):
        report = fail(NULL_WRITE, code=5)
        self.check(
            report,
            "a null pointer?",
            "INVSTATE",
            "written into the vector table",
            "0x1234, 4 bytes, to 0x0000003c: the vector of exception 15 (SysTick), by",
            marked("null write"),
            "exception 15 (SysTick), its frame on MSP, interrupted",
            "UsageFault is not enabled (SHCSR)",
        )

    def test_a_stack_overflow(self):
        report = fail(OVERFLOW, code=5)
        self.check(report, "the stack has overflowed", "below data_sram", marked("overflow"))

    def test_a_stack_overflow_at_its_limit(self):
        report = fail(OVERFLOW, "-C", "cpu.stack_limit=0x2000fc00", code=5)
        self.check(
            report,
            "the firmware's stack overflowed: MSP is 0x2000f",
            "below cpu.stack_limit = 0x2000fc00",
            "times more",
            marked("overflow"),
            "the stacks so far:",
        )

    def test_a_wrong_interrupt_priority(self):
        report = fail(SVC_PRIORITY, code=5)
        self.check(
            report,
            "escalated from an SVC",
            marked("svc priority"),
            "SVCall has the priority 0x40, which does not preempt: exception 24 (timer0, line 8) runs, "
            "whose priority is 0x40",
        )

    def test_a_deadlock(self):
        report = fail(DEADLOCK, code=124)
        self.check(
            report,
            marked("deadlock"),
            "mode       exception 24 (timer0)",
            "exception 25 (timer1, line 9): its priority 0xa0 does not preempt: exception 24 (timer0, line 8) runs",
        )

    def test_a_sleep_without_end(self):
        report = fail(ASLEEP, code=124)
        self.check(report, "asleep", marked("asleep"), "exception 25 (timer1, line 9): it is disabled (NVIC_ISER)")

    def test_an_imprecise_fault_with_its_write(self):
        report = fail(LOST_WRITE, code=5)
        self.check(
            report,
            "IMPRECISERR",
            "write      0x0000abcd to 0x60000008, no memory and no device",
            "BusFault is not enabled",
        )
        self.assertRegex(report, r"by +0x[0-9a-f]{8}  lost_write\S*, " + re.escape(marked("lost write")))

    def test_who_printed_a_line(self):
        report = fail(FAILED_CHECK, "--fail-uart", "^FAIL", code=1)
        self.check(report, "uart0 printed: FAIL: one", marked("failed check"), "check, ", "run_checks, ")

    def test_a_warning_with_its_line_and_callers(self):
        report = fail(PRINTED_WARNING, code=0)
        self.check(
            report,
            "the rest is dropped",
            f"warn+0x4, {marked('printed warning')}; from main, firmware/tests/failures.c:",
        )

    def test_registers_with_what_they_point_at(self):
        report = fail(FAULT_IN_HANDLER, code=5)
        self.assertRegex(report, r"lr   0x[0-9a-f]{8}  TIMER0_Handler, firmware/tests/failures.c:\d+")
        self.assertRegex(report, r"r\d   0x40000000  timer0\+0x0\n")
        self.assertRegex(report, r"sp   0x2000ff[0-9a-f]{2}  data_sram\+0xff")
        self.assertRegex(fail(LOST_WRITE, code=5), r'r\d   0x[0-9a-f]{8}  "a label"\n')
        self.assertRegex(
            fail(NULL_WRITE, "-C", "cpu.stack_marks=true", code=5), r"MSP: \d+ bytes, 0x20010000 down to 0x2000ff"
        )

    def test_without_debug_information_by_symbols(self):
        with tempfile.TemporaryDirectory() as folder:
            elf = Path(folder) / "stripped.elf"
            subprocess.run(["arm-none-eabi-objcopy", "--strip-debug", FAILURES, elf], check=True)
            with_it, without = fail(FAULT_IN_HANDLER), capsoc(elf, "-P", f"failure={FAULT_IN_HANDLER}", code=5)
        self.assertIn("has no lines of source (compile with -g): names are of symbols", without)
        self.assertEqual(
            [f if f == "exception" else f[0].split(".")[0] for f in stack_of(without)][:5],
            [f if f == "exception" else f[0] for f in stack_of(with_it)][:5],
        )
        self.assertNotIn("has no", with_it)

    def test_executors_tell_the_same(self):
        for number in (NULL_WRITE, SVC_PRIORITY, DEADLOCK, LOST_WRITE, FAULT_IN_HANDLER, PRINTED_WARNING):
            reports = {
                re.sub(r"\n.* simulated s in .*", "", fail(number, "-C", f"cpu.executor={executor}"))
                for executor in ("blocks", "stepping", "translator")
            }
            self.assertEqual(len(reports), 1, reports)


class Debugger(unittest.TestCase):
    """The call stacks are those that gdb-multiarch shows."""

    def test_in_a_handler_that_faults_over_a_thread_of_its_own_stack(self):
        ours, theirs = stack_of(fail(FAULT_IN_HANDLER, code=5)), gdb_stack(FAULT_IN_HANDLER, "fault_lockup")
        self.assertEqual(theirs[:2], [("fault_lockup", theirs[0][1]), "exception"])
        self.assertEqual(ours, theirs[2:])
        self.assertEqual(
            [f if f == "exception" else f[0] for f in ours],
            ["TIMER0_Handler", "exception", "work", "thread", "run_thread", "main", "Reset_Handler"][: len(ours)],
        )

    def test_in_a_handler_with_a_wrong_priority(self):
        ours, theirs = stack_of(fail(SVC_PRIORITY, code=5)), gdb_stack(SVC_PRIORITY, "fault_lockup")
        self.assertEqual(ours[1:], theirs[3:])
        self.assertEqual(
            ours[0], ("call_kernel", marked("svc priority")), "the SVC itself; the frame returns behind it"
        )

    def test_in_a_deadlock(self):
        self.assertEqual(stack_of(fail(DEADLOCK, code=124)), gdb_stack(DEADLOCK, "wait_for_answer"))

    def test_behind_an_imprecise_fault(self):
        self.assertEqual(stack_of(fail(LOST_WRITE, code=5)), gdb_stack(LOST_WRITE, "fault_lockup")[2:])

    def test_in_a_recursion(self):
        report = fail(OVERFLOW, "-C", "cpu.stack_limit=0x2000fc00", code=5)
        depth = len(stack_of(report))
        self.assertEqual(stack_of(report)[1:], gdb_stack(OVERFLOW, f"descend if depth == {depth - 3}")[1:])


class Stacks(unittest.TestCase):
    """How deep the stacks have been."""

    def results(self, program, *options):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "r.json"
            capsoc(FIRMWARE / f"{program}.elf", "--json", path, *options)
            return json.loads(path.read_text())

    def test_each_stack_is_known_by_its_object(self):
        stacks = self.results("threads", "-C", "cpu.stack_marks=true")["stacks"]
        self.assertEqual(stacks[0]["name"], "MSP")
        self.assertEqual(len(stacks), 3)
        for stack in stacks[1:]:
            self.assertRegex(stack["name"], r"^PSP \(threads, \d+ bytes\)$")
            self.assertEqual(stack["bytes"], stack["top"] - stack["lowest"])
            self.assertTrue(0 < stack["bytes"] <= 1024, stack)

    def test_marks_are_what_the_instructions_show(self):
        with tempfile.TemporaryDirectory() as folder:
            trace = Path(folder) / "t.txt"
            lowest = self.results("newlib", "-C", "cpu.stack_marks=true", "--trace-instructions", trace)["stacks"][0][
                "lowest"
            ]
            shown = min(int(m, 16) for m in re.findall(r" msp=([0-9a-f]{8})", trace.read_text()))
        self.assertEqual(lowest, shown)

    def test_looking_changes_nothing(self):
        plain, marked_run = self.results("threads"), self.results("threads", "-C", "cpu.stack_marks=true")
        for key in ("instructions", "cycles"):
            self.assertEqual(plain["cpu"][key], marked_run["cpu"][key])
        self.assertNotIn("stacks", plain)

    def test_a_symbol_is_a_limit(self):
        report = capsoc(FIRMWARE / "newlib.elf", "-C", "cpu.stack_limit=stack_guard", code=0)
        self.assertNotIn("overflowed", report)

    def test_wrong_limits_are_refused(self):
        for limit in ("stack_gard", "0x", "0x123456789", "12", "main,nowhere"):
            report = capsoc(FAILURES, "-C", f"cpu.stack_limit={limit}", code=2)
            self.assertIn("is no symbol of the program; give one", report)
            self.assertEqual(report.count("\n"), 1)


class Schedule(unittest.TestCase):
    """Who had the processor, and how long interrupts waited, against the traces."""

    def run_traced(self, *options):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        places = [Path(folder.name) / name for name in ("r.json", "i.txt", "b.txt")]
        capsoc(
            FIRMWARE / "threads.elf",
            "--json",
            places[0],
            "--trace-instructions",
            places[1],
            "--trace-bus",
            places[2],
            *options,
            code=0,
        )
        return json.loads(places[0].read_text()), places[1].read_text().splitlines(), places[2].read_text().splitlines()

    def test_latencies_are_from_the_write_that_pends_to_the_first_instruction(self):
        result, instructions, bus = self.run_traced("--latencies")
        pends = [int(line.split()[0]) for line in bus if " ppb " in line and " write " in line and " e000ed04 " in line]
        firsts = [
            int(after.split()[0]) for line, after in zip(instructions, instructions[1:]) if "--> exception 14" in line
        ]
        waits = [first - max(pend for pend in pends if pend < first) for first in firsts]
        self.assertGreater(len(waits), 5)
        (pend_sv,) = (entry for entry in result["interrupts"] if entry["exception"] == 14)
        self.assertEqual(pend_sv["name"], "PendSV")
        self.assertEqual(pend_sv["count"], len(waits))
        self.assertEqual(
            pend_sv["latency_cycles"], {"least": min(waits), "mean": sum(waits) / len(waits), "most": max(waits)}
        )
        for entry in pend_sv["histogram"]:
            self.assertEqual(entry["count"], sum(entry["from"] <= wait <= entry["to"] for wait in waits))
        self.assertEqual(sum(entry["count"] for entry in pend_sv["histogram"]), len(waits))

    def test_the_time_of_a_task_is_that_between_its_exceptions(self):
        result, instructions, _ = self.run_traced("-C", "tasks.current=current")
        spent, running, since = {}, None, 0
        for line, after in zip(instructions, instructions[1:]):
            if "--> exception" in line and running is not None:
                spent[running] = spent.get(running, 0) + int(line.split()[0]) - since
                running = None
            elif "<-- exception" in line and ", back to " in line:
                place = line.rsplit(" ", 1)[1].split("+")[0]
                running, since = ("trespass" if "trespass" in place else "count"), int(after.split()[0])
        tasks = {task["address"]: task for task in result["tasks"]}
        self.assertEqual(sum(task["cycles"] for task in tasks.values()), result["cpu"]["cycles"])
        self.assertEqual(len(tasks), 3)
        del tasks[0]
        # The thread that trespasses calls nothing but itself; what the other one calls is its.
        self.assertEqual(sorted(task["cycles"] for task in tasks.values()), sorted(spent.values()))

    def test_they_change_nothing_and_are_not_there_unasked(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "r.json"
            results = []
            for options in ([], ["--latencies", "-C", "tasks.current=current"]):
                capsoc(FIRMWARE / "threads.elf", "--json", path, *options, code=0)
                results.append(json.loads(path.read_text()))
            self.assertEqual(results[0]["cpu"]["cycles"], results[1]["cpu"]["cycles"])
            self.assertEqual(results[0]["uart0"], results[1]["uart0"])
            self.assertFalse({"tasks", "interrupts"} & set(results[0]))

    def test_a_task_pointer_that_is_no_symbol_is_refused(self):
        report = capsoc(FIRMWARE / "threads.elf", "-C", "tasks.current=curent", code=2)
        self.assertIn("tasks.current = curent: is no symbol of the program; give one (did you mean current", report)


if __name__ == "__main__":
    unittest.main()
