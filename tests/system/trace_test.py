#!/usr/bin/env python3
"""Traces of `capsoc run`: what is in them, and that they change nothing else."""

import json
import re
import struct
import subprocess
import unittest
from collections import Counter
from pathlib import Path
from random import Random

from harness import CAPSOC, CLEAN, Case, FIRMWARE, is_firmware_of_the_pages

CTEST = {"name": "trace"}


def capsoc(*arguments):
    return subprocess.run(
        [CAPSOC, "run", *map(str, arguments)], capture_output=True, timeout=300, check=False, env=CLEAN
    )


class Traced(Case):
    def run_with(self, program, *options):
        """Exit code, UART bytes, results without what the host's clock says, stderr."""
        path = self.folder / "r.json"
        done = capsoc(FIRMWARE / f"{program}.elf", "--json", path, *options)
        self.assertTrue(path.exists(), done.stderr.decode())
        result = json.loads(path.read_text())
        result["time"].pop("wall_s")
        result["cpu"].pop("mips")
        result.pop("translator", None)
        result.pop("profile", None)  # there with --profile only
        return done.returncode, done.stdout, result

    def text(self, option, program, *options):
        """Lines of a text trace without its heading, and the results."""
        place = self.folder / "trace.txt"
        _, _, result = self.run_with(program, option, place, *options)
        return place.read_text().splitlines()[1:], result


class Unchanged(Traced):
    """Tracing changes speed, nothing else."""

    def check(self, program, *more):
        for executor in ("blocks", "translator", "stepping"):
            common = ("-C", f"cpu.executor={executor}", *more)
            plain = self.run_with(program, *common)
            traces = {
                "--trace-instructions": "i.txt",
                "--trace-bus": "b.txt",
                "--profile": "p.out",
                "--trace-waves": "w.fst",
                "--trace-translation": "t.txt",
                "--timeline": "l.json",
            }
            every = [part for option, name in traces.items() for part in (option, self.folder / name)]
            for options in (
                [every[i : i + 2] for i in range(0, len(every), 2)]
                + [every]
                + [every[2:4] + ["-C", "trace.fetches=true"]]
                + [every + ["-C", "trace.start=main", "-C", "trace.stop=1"]]
            ):
                self.assertEqual(self.run_with(program, *common, *options), plain, options)
                for name in options[1:8:2]:
                    if Path(name).name == "t.txt":  # empty where nothing is translated
                        Path(name).unlink()
                    elif not str(name).startswith("trace."):
                        self.assertGreater(Path(name).stat().st_size, 0, name)
                        Path(name).unlink()

    def test_interrupts(self):
        self.check("debuggee")

    def test_threads_and_longjmp(self):
        self.check("profiled")

    def test_crash(self):
        self.check("divzero")

    def test_coprocessor_and_sleep(self):
        self.check("selfcal", "--simlimit", "0.3")

    def test_random_programs(self):
        """Wild jumps, returns without calls, nested faults: the same cycles, and every one of them in the profile."""
        codes = Counter()
        for seed in range(12):
            random = Random(seed)

            def halfword():
                if random.random() < 0.9:
                    return random.randrange(0x10000)
                return random.choice(
                    [
                        0x4770,
                        0x4700 | random.randrange(16) << 3,
                        0x4780 | random.randrange(15) << 3,
                        0xBD00 | random.randrange(256),
                        0xB500 | random.randrange(256),
                        0xDF00,
                        0xE000 | random.randrange(2048),
                        0xD000 | random.randrange(0xE00),
                    ]
                )

            vectors = [0x20010000] + [0x201 + 2 * random.randrange(0x1800) for _ in range(47)]
            program = struct.pack("<48I", *vectors).ljust(0x200, b"\0")
            program += b"".join(struct.pack("<H", halfword()) for _ in range(0x1800))
            image = self.folder / "random.bin"
            image.write_bytes(program)
            common = ("--load", f"{image}@0", "--simlimit", "0.002", "--log-level", "off")
            plain = self.run_with("hello", *common)
            codes[plain[0]] += 1
            self.assertEqual(
                self.run_with(
                    "hello",
                    *common,
                    "--trace-instructions",
                    self.folder / "i",
                    "--trace-bus",
                    self.folder / "b",
                    "--trace-waves",
                    self.folder / "w.fst",
                    "--profile",
                    self.folder / "p",
                    "-C",
                    "trace.depth=9",
                ),
                plain,
                seed,
            )
            self.assertIn(f"totals: {plain[2]['cpu']['cycles']} ", (self.folder / "p").read_text(), seed)
        self.assertEqual(set(codes), {5, 124}, "crashes, and programs that run on")

    def test_nothing_is_left_behind(self):
        self.run_with(
            "hello",
            "--trace-instructions",
            self.folder / "i",
            "--trace-bus",
            self.folder / "b",
            "--profile",
            self.folder / "p",
            "--trace-waves",
            self.folder / "w.fst",
            "--timeline",
            self.folder / "l",
        )
        self.assertEqual({p.name for p in self.folder.iterdir()}, {"i", "b", "p", "w.fst", "w.gtkw", "l", "r.json"})

    def test_a_device_stays_one(self):
        null = self.folder / "null"
        null.symlink_to("/dev/null")
        self.run_with("hello", "--trace-instructions", null, "--trace-bus", null, "--profile", null)
        self.assertTrue(null.is_char_device())

    def test_same_bytes_every_time(self):
        for option, name in (
            ("--trace-instructions", "i"),
            ("--trace-bus", "b"),
            ("--profile", "p"),
            ("--trace-waves", "w.fst"),
            ("--timeline", "l.json"),
        ):
            contents = set()
            for _ in range(2):
                self.run_with("debuggee", option, self.folder / name)
                contents.add((self.folder / name).read_bytes())
            self.assertEqual(len(contents), 1, option)


class Refusals(Traced):
    def refuse(self, expected, *options):
        done = capsoc(FIRMWARE / "hello.elf", *options)
        text = done.stderr.decode()
        self.assertEqual((done.returncode, done.stdout), (2, b""), text)
        self.assertEqual(len(text.strip().splitlines()), 1, text)
        self.assertIn(expected, text)

    def test_places_that_cannot_be_written(self):
        for option in ("--trace-instructions", "--trace-bus", "--profile", "--trace-waves", "--timeline"):
            self.refuse("/nonexistent/x: cannot be written", option, "/nonexistent/x")
        (self.folder / "null").symlink_to("/dev/null")
        self.refuse("null: is no file", "--trace-waves", self.folder / "null")
        self.refuse("call the waves .fst", "--trace-waves", self.folder / "w.gtkw")
        for option in (
            ["--trace-waves"],
            ["--waves"],
            ["--coprocessor", "lockstep", "--waves"],
            ["--coprocessor", "rtl", "--waves"],
        ):
            for name in ("w.vcd", "W.VCD", "w.ghw"):
                self.refuse("waves are written in FST alone; name the file ", *option, self.folder / name)

    def test_bounds_that_mean_nothing(self):
        trace = ("--trace-bus", self.folder / "b")
        self.refuse("did you mean main", *trace, "-C", "trace.start=mian")
        self.refuse("trace.stop = -1 is out of range", *trace, "-C", "trace.stop=-1")
        self.refuse("trace.stop = 0x", *trace, "-C", "trace.stop=0x")
        self.assertEqual(list(self.folder.iterdir()), [])


class Instructions(Traced):
    LINE = re.compile(r" *(\d+) +([\d.]+)  (.*)$")

    def test_every_instruction_is_there(self):
        lines, result = self.text("--trace-instructions", "debuggee")
        steps = [line for line in lines if re.match(r"[0-9a-f]{8} ", self.LINE.match(line).group(3))]
        self.assertEqual(len(steps), result["cpu"]["instructions"])
        cycles = [int(self.LINE.match(line).group(1)) for line in lines]
        self.assertEqual(cycles, sorted(cycles))
        self.assertIn("--- reset", lines[0])
        begins = r"ldr r\d, .* r\d=" if is_firmware_of_the_pages() else r"push {.* msp="
        self.assertRegex(lines[1], f"Reset_Handler +{begins}")
        entries = [line for line in lines if "--> exception 15 SysTick" in line]
        returns = [line for line in lines if "<-- exception 15 SysTick, back to " in line]
        self.assertGreater(len(entries), 3)
        self.assertEqual(len(entries), len(returns))

    def test_changed_registers_are_shown(self):
        lines, _ = self.text(
            "--trace-instructions", "debuggee", "-C", "trace.start=work", "-C", "trace.stop=SysTick_Handler"
        )
        first = next(line for line in lines if " work " in line)
        self.assertIn("work", first)
        pushes = [line for line in lines if re.search(r"  push ", line)]
        for line in pushes:
            self.assertRegex(line, r" msp=[0-9a-f]{8}$")
        compares = [line for line in lines if re.search(r"  cmp ", line)]
        for line in compares:
            self.assertNotRegex(line, r" r\d+=[0-9a-f]{8}")

    def test_depth_keeps_the_last_lines_of_a_crash(self):
        lines, result = self.text("--trace-instructions", "divzero", "-C", "trace.depth=6")
        self.assertEqual(result["exit"]["code"], 5)
        self.assertEqual(len(lines), 6)
        self.assertIn("--- lockup", lines[-1])
        self.assertTrue(any("udiv" in line or "sdiv" in line for line in lines), lines)
        self.assertTrue(any("--> exception 3 HardFault" in line for line in lines), lines)

    def test_window_of_time(self):
        lines, _ = self.text("--trace-instructions", "debuggee", "-C", "trace.start=0.0001", "-C", "trace.stop=0.00012")
        times = [float(self.LINE.match(line).group(2)) for line in lines]
        self.assertGreater(len(times), 100)
        self.assertGreaterEqual(times[0], 0.0001)
        self.assertLess(times[-1], 0.00012)


class Bus(Traced):
    @staticmethod
    def accesses(lines):
        names = ("cycle", "time", "initiator", "what", "size", "address", "data", "cycles", "status", "target")
        return [dict(zip(names, line.split())) for line in lines]

    def test_what_the_uart_gets(self):
        lines, _ = self.text("--trace-bus", "hello")
        code, uart, _ = self.run_with("hello")
        sent = [a for a in self.accesses(lines) if a.get("target") == "uart0+0x0" and a["what"] == "write"]
        self.assertEqual(bytes(int(a["data"], 16) & 0xFF for a in sent), uart)
        self.assertEqual({a["initiator"] for a in sent}, {"system"})
        self.assertTrue(all(int(a["cycles"]) >= 2 for a in sent), "an APB transfer")
        self.assertEqual(code, 0)

    def test_memory_and_private_bus(self):
        lines, _ = self.text("--trace-bus", "debuggee")
        seen = self.accesses(lines)
        self.assertEqual((seen[0]["address"], seen[1]["address"]), ("00000000", "00000004"), "the vector table")
        symbols = subprocess.run(
            ["arm-none-eabi-nm", FIRMWARE / "debuggee.elf"], capture_output=True, text=True, check=True
        ).stdout
        address = {name: a for a, _, name in (line.split() for line in symbols.splitlines())}
        written = [int(a["data"], 16) for a in seen if a["address"] == address["written"] and a["what"] == "write"]
        self.assertEqual([w for w in written if w], list(range(1, 401)))
        self.assertTrue(any(a["initiator"] == "ppb" and a["address"] == "e000e010" for a in seen))
        self.assertTrue(any(a["initiator"] == "d-code" for a in seen))

    def test_errors_are_marked(self):
        lines, result = self.text("--trace-bus", "badread")
        self.assertEqual(result["exit"]["code"], 5)
        self.assertIn("address-error", {a["status"] for a in self.accesses(lines)})

    def test_fetches_on_request(self):
        lines, result = self.text("--trace-bus", "hello", "-C", "trace.fetches=true")
        fetches = [a for a in self.accesses(lines) if a["initiator"] == "i-code"]
        self.assertEqual(len(fetches), result["cpu"]["instructions"])
        without, _ = self.text("--trace-bus", "hello")
        self.assertEqual(len(lines), len(without) + len(fetches))


def read_callgrind(text):
    """Cycles by function (and all instructions), and by (caller, callee) how many calls, with their cycles."""
    names, own, calls, function, callee, count = {}, Counter(), {}, None, None, None

    def name(text):
        number, _, rest = text.partition(" ")
        return names.setdefault(number, rest)

    for line in text.splitlines():
        if line.startswith("fn="):
            function = name(line[3:])
        elif line.startswith("cfn="):
            callee = name(line[4:])
        elif line.startswith("calls="):
            count = int(line[6:].split()[0])
        elif line.startswith("0x"):
            _, _, cycles, instructions = line.split()
            if count is None:
                own[function] += int(cycles)
                own["instructions"] += int(instructions)
            else:
                before = calls.get((function, callee), (0, 0))
                calls[function, callee] = (before[0] + count, before[1] + int(cycles))
                count = None
    return own, calls


class Profile(Traced):
    def callgrind(self, program):
        """Self costs by function, calls by (caller, callee), and the results."""
        place = self.folder / "p.out"
        _, _, result = self.run_with(program, "--profile", place)
        return *read_callgrind(place.read_text()), result

    def test_every_cycle_is_somebodys(self):
        for program in ("debuggee", "profiled", "hello", "divzero"):
            own, _, result = self.callgrind(program)
            self.assertEqual(own.pop("instructions"), result["cpu"]["instructions"], program)
            self.assertEqual(sum(own.values()), result["cpu"]["cycles"], program)

    def test_calls_of_every_kind(self):
        own, calls, _ = self.callgrind("profiled")
        for caller, callee, count in (
            ("main", "plain", 3),
            ("plain", "leaf", 3),
            ("main", "tail", 2),
            ("tail", "leaf", 2),
            ("main", "recursive", 1),
            ("recursive", "recursive", 4),
            ("main", "outer", 1),
            ("outer", "thrower", 1),
            ("thrower", "leaf", 1),
            ("thrower", "longjmp", 1),
            ("[SVCall]", "SVC_Handler", 1),
            ("SVC_Handler", "leaf", 1),
            ("main", "run_on", 1),
            ("run_on", "thread_a", 1),
            ("thread_a", "work_a", 5),
            ("thread_b", "work_b", 5),
            ("work_a", "leaf", 5),
            ("work_b", "leaf", 5),
            ("Reset_Handler", "main", 1),
        ):
            self.assertEqual(calls.get((caller, callee), (0,))[0], count, (caller, callee))
        # Inclusive cost: one's own and that of what one calls.
        for function in ("plain", "tail", "outer", "thrower", "work_a", "work_b", "SVC_Handler", "main"):
            into = sum(cost for (_, callee), (_, cost) in calls.items() if callee == function)
            out = sum(cost for (caller, _), (_, cost) in calls.items() if caller == function)
            self.assertEqual(into, own[function] + out, function)
        self.assertGreater(calls["work_b", "leaf"][1], 1.9 * calls["work_a", "leaf"][1])
        self.assertLess(calls["work_b", "leaf"][1], 2.1 * calls["work_a", "leaf"][1])

    def test_handlers_do_not_count_for_what_they_interrupt(self):
        own, calls, _ = self.callgrind("debuggee")
        self.assertEqual(calls["main", "work"][0], 400)
        self.assertEqual(calls["main", "work"][1], own["work"])
        self.assertGreater(calls["[SysTick]", "SysTick_Handler"][0], 3)
        self.assertGreaterEqual(own["[SysTick]"], 12 * calls["[SysTick]", "SysTick_Handler"][0])

    def test_costs_have_the_lines_that_addr2line_names(self):
        place = self.folder / "p.out"
        self.run_with("profiled", "--profile", place)
        files, now, compared = {}, None, Counter()
        for line in place.read_text().splitlines():
            if found := re.match(r"(fl|fi|cfi)=(\(\d+\))(?: (.*))?", line):
                file = files.setdefault(found.group(2), found.group(3))
                now = now if found.group(1) == "cfi" else file
            elif re.match(r"0x[1-9a-f]", line) and now != "???":
                address, number, _, _ = line.split()
                compared[address, f"{now.rsplit('/', 1)[-1]}:{number}"] += 1
        addresses = sorted({address for address, _ in compared}, key=lambda a: int(a, 16))
        elf = FIRMWARE / "profiled.elf"
        told = subprocess.run(
            ["arm-none-eabi-addr2line", "-e", elf, *addresses], capture_output=True, text=True, check=True
        ).stdout
        expected = {(a, re.sub(r" .*", "", t.rsplit("/", 1)[-1])) for a, t in zip(addresses, told.splitlines())}
        self.assertGreater(len(expected), 300 if is_firmware_of_the_pages() else 200)
        unknown = {a for a, t in expected if "?" in t}  # without a line
        self.assertEqual({c for c in compared if c not in expected and c[0] not in unknown}, set())

    def test_sleep_is_waiting(self):
        place = self.folder / "p.out"
        _, _, result = self.run_with("selfcal", "--profile", place, "--simlimit", "0.2")
        waiting = re.search(r"fn=\(\d+\) \[waiting\]\n0x0 0 (\d+) 0", place.read_text())
        self.assertGreater(int(waiting.group(1)), result["cpu"]["cycles"] // 2)

    def test_folded_stacks(self):
        place = self.folder / "p.folded"
        _, _, result = self.run_with("profiled", "--profile", place)
        stacks = {
            path: int(cycles) for path, cycles in (line.rsplit(" ", 1) for line in place.read_text().splitlines())
        }
        self.assertEqual(sum(stacks.values()), result["cpu"]["cycles"])
        for path in (
            "Reset_Handler;main;plain;leaf",
            "Reset_Handler;main;tail;leaf",
            "[SVCall];SVC_Handler;leaf",
            "Reset_Handler;main;recursive;recursive;recursive;recursive;recursive",
            "thread_b;work_b;leaf",
            "Reset_Handler;main;run_on;thread_a;work_a;leaf",
        ):
            self.assertIn(path, stacks)

    def test_callgrind_annotate_reads_it(self):
        place = self.folder / "p.out"
        _, _, result = self.run_with("profiled", "--profile", place)
        done = subprocess.run(["callgrind_annotate", place], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        total = re.search(r"^ *([\d,]+).*PROGRAM TOTALS", done.stdout, re.MULTILINE)
        self.assertEqual(int(total.group(1).replace(",", "")), result["cpu"]["cycles"], done.stdout)
        self.assertRegex(done.stdout, r"(?m)^.*:leaf\b")


class Waves(Traced):
    def test_save_file_names_signals_of_the_waves(self):
        waves = self.folder / "w.fst"
        self.run_with("selfcal", "--trace-waves", waves, "--simlimit", "0.1")
        save = (self.folder / "w.gtkw").read_text()
        self.assertIn('[dumpfile] "w.fst"', save)
        for signal in (
            "soc.interrupts.coprocessor_interrupt",
            "soc.bus.address[31:0]",
            "soc.cpu.exception_name",
            "soc.coprocessor.registers.a1_value",
            "soc.coprocessor.registers.angle_degrees",
            "soc.coprocessor.t0.u_value",
        ):
            self.assertIn(signal + "\n", save)

    def test_every_backend(self):
        for backend in ("tlm", "rtl", "lockstep"):
            waves = self.folder / f"{backend}.fst"
            self.run_with("selfcal", "--trace-waves", waves, "--simlimit", "0.05", "--coprocessor", backend)
        self.assertEqual((self.folder / "tlm.fst").read_bytes(), (self.folder / "rtl.fst").read_bytes())
        self.assertEqual((self.folder / "tlm.fst").read_bytes(), (self.folder / "lockstep.fst").read_bytes())

    def test_waves_of_a_run_with_the_model_are_the_socs(self):
        for option in ("--waves", "--trace-waves"):
            self.run_with("debuggee", option, self.folder / (option + ".fst"))
        self.assertEqual((self.folder / "--waves.fst").read_bytes(), (self.folder / "--trace-waves.fst").read_bytes())

    def test_gtkwaves_own_reader_takes_it(self):
        waves = self.folder / "w.fst"
        _, _, result = self.run_with("selfcal", "--trace-waves", waves, "--simlimit", "0.5")
        text = subprocess.run(["fst2vcd", waves], capture_output=True, text=True, check=True).stdout
        self.assertIn("$timescale\n\t1ps\n$end", text)
        self.assertRegex(text, r"\$var wire 1 \S+ uart0_tx \$end")
        for name, parameter in result["parameters"].items():
            if name.startswith(("a", "b")) and name != "beta":
                number = re.search(rf"\$var real 64 (\S+) {name}_value ", text).group(1)
                values = re.findall(rf"(?m)^r(\S+) {re.escape(number)}$", text)
                self.assertAlmostEqual(float(values[-1]), parameter["value"], places=14, msg=name)
        commits = re.search(r"\$var wire 32 (\S+) commits ", text).group(1)
        counts = re.findall(rf"(?m)^b([01]+) {re.escape(commits)}$", text)
        self.assertEqual([int(count, 2) for count in counts], list(range(1, result["samples"] + 1)))


if __name__ == "__main__":
    unittest.main()
