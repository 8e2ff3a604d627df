#!/usr/bin/env python3
"""`capsoc run --gdb` with the real client, gdb-multiarch, and with bare packets where the client hides what is
asked.
"""

import json
import re
import socket
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

from harness import CAPSOC, CLEAN, FIRMWARE, SOURCE

CTEST = {"name": "gdb"}

DEBUGGEE = FIRMWARE / "debuggee.elf"
FOREVER = FIRMWARE / "forever.elf"


class Run:
    """A `capsoc run --gdb` and, at the end, what it left."""

    options = ()  # of all of them

    def __init__(self, elf, *options):
        self.folder = tempfile.TemporaryDirectory()
        self.json = Path(self.folder.name) / "r.json"
        self.process = subprocess.Popen(
            [CAPSOC, "run", elf, "--gdb", "0", "--json", self.json, *self.options, *map(str, options)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=CLEAN,
        )
        line = self.process.stderr.readline().decode()
        self.port = int(re.search(r"127\.0\.0\.1:(\d+)", line).group(1))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()
        self.folder.cleanup()

    def end(self, timeout=60):
        """Exit code, UART bytes and results."""
        out, _ = self.process.communicate(timeout=timeout)
        return self.process.returncode, out, json.loads(self.json.read_text())


class Packets:
    """The protocol by hand."""

    def __init__(self, run):
        self.socket = socket.create_connection(("127.0.0.1", run.port), timeout=30)
        self.buffer = b""
        self.ask("QStartNoAckMode")
        self.send(b"+")
        self.ask("qSupported:swbreak+;hwbreak+")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def send(self, data):
        self.socket.sendall(data)

    def packet(self, text):
        data = text.encode()
        self.send(b"$" + data + b"#%02x" % (sum(data) & 0xFF))

    def answer(self):
        while True:
            found = re.search(rb"\$([^#]*)#..", self.buffer)
            if found:
                self.buffer = self.buffer[found.end() :]
                return found.group(1).decode()
            received = self.socket.recv(65536)
            if not received:
                raise ConnectionError("the server closed the connection")
            self.buffer += received

    def ask(self, text):
        self.packet(text)
        return self.answer()

    def word(self, address):
        return int.from_bytes(bytes.fromhex(self.ask(f"m{address:x},4")), "little")

    def register(self, number):
        return int.from_bytes(bytes.fromhex(self.ask(f"p{number:x}")), "little")

    def run_to(self, address):
        self.ask(f"Z0,{address:x},2")
        self.ask("vCont;c")
        self.ask(f"z0,{address:x},2")


def symbols():
    """Addresses of the debuggee's symbols."""
    text = subprocess.run(["arm-none-eabi-nm", DEBUGGEE], capture_output=True, text=True, check=True).stdout
    return {name: int(address, 16) for address, _, name in (line.split() for line in text.splitlines())}


def gdb(run, script, elf=DEBUGGEE, target="remote"):
    """Runs gdb-multiarch with the lines of a script; its output."""
    with tempfile.NamedTemporaryFile("w", suffix=".gdb") as file:
        file.write(
            f"set pagination off\nset confirm off\nset width 0\ntarget {target} 127.0.0.1:{run.port}\n{script}\n"
        )
        file.flush()
        done = subprocess.run(
            ["gdb-multiarch", "-nx", "-q", "-batch", "-x", file.name, elf],
            capture_output=True,
            text=True,
            timeout=120,
            cwd=SOURCE,
            check=False,
        )
    return done.stdout + done.stderr


class Session(unittest.TestCase):
    """What a firmware engineer does with gdb-multiarch."""

    def test_load_break_step_watch_and_run_again(self):
        with Run(DEBUGGEE, "--halt") as run:
            out = gdb(
                run,
                """
load
compare-sections
monitor reset halt
maintenance flush register-cache
break main
continue
next
step
watch written
continue
continue
info watchpoints
delete
rwatch settings
continue
delete
awatch seen
continue
delete
hbreak SysTick_Handler
continue
backtrace
print ticks
next
print ticks
delete
finish
info registers control msp psp primask basepri faultmask xpsr
monitor something that nobody knows
monitor reset halt
maintenance flush register-cache
print written
info registers pc
break main
continue
print/x $sp
delete
continue
""",
            )
            code, uart, result = run.end()
        for text in (
            "Loading section .text",
            "matched.",
            "Breakpoint 1, main ()",
            "Hardware watchpoint 2: written",
            "New value = 1",
            "New value = 2",
            "Value = 7",
            "Hardware access (read/write) watchpoint",
            "SysTick_Handler ()",
            "$1 = 0",
            "$2 = 1",
            "<signal handler called>",
            "is not known here",
            "exited normally",
        ):
            self.assertIn(text, out)
        self.assertNotIn("MIS-MATCHED", out)
        self.assertEqual(out.count("main () at"), 2 + out.count(" in main () at"), out)
        for name in ("control", "msp", "psp", "primask", "basepri", "faultmask", "xpsr"):
            self.assertRegex(out, rf"(?m)^{name} +0x")
        self.assertEqual((code, uart), (0, b"debuggee: right\n"))

    def test_backtrace_out_of_a_hard_fault(self):
        with Run(DEBUGGEE, "--halt") as run:
            out = gdb(
                run,
                """
break main
continue
set var crash_wanted = 1
break HardFault_Handler
continue
backtrace
print/x *(unsigned*)0xE000ED38
kill
""",
            )
            code, _, result = run.end()
        trace = out[out.index("#0  HardFault_Handler") :]
        for frame in ("<signal handler called>", "fetch (", " in crash (", " in work (", " in main ()"):
            self.assertIn(frame, trace)
            trace = trace[trace.index(frame) :]
        self.assertIn("$1 = 0x60000000", out)
        self.assertEqual((code, result["exit"]["reason"]), (0, "ended by the debugger"))

    def test_extended_client_runs_it_again(self):
        with Run(DEBUGGEE, "--halt") as run:
            out = gdb(
                run,
                """
break main
continue
run
continue
delete
continue
""",
                target="extended-remote",
            )
            code, uart, _ = run.end()
        self.assertGreaterEqual(out.count(", main ()"), 2, out)
        self.assertEqual((code, uart), (0, b"debuggee: right\n"))


class Registers(unittest.TestCase):
    """Peripheral registers by the names of the SVD description (scripts/debugger/svd.py)."""

    def test_coprocessor_registers_by_name(self):
        with Run(FIRMWARE / "selfcal.elf", "--halt", "--simlimit", "2") as run:
            out = gdb(
                run,
                """
source scripts/debugger/svd.py
svd list
svd list ADC
tbreak main
continue
print/x $svd("COPROCESSOR.ID")
print $svd("coprocessor.latency")
print $svd("COPROCESSOR.CTRL.CALIB")
tbreak sampling_wait
continue
svd COPROCESSOR.CTRL
svd COPROCESSOR.A1
svd CLOCKCTRL
svd COPROCESSOR.STATUS.LOCK
complete svd COPROCESSOR.ST
complete svd COPROCESSOR.STATUS.LO
complete svd lo
python
try:
  gdb.execute("svd COPROCESSOR.NONE")
except gdb.error as error:
  print("refused:", error)
end
print $svd("ADC.COUNT") == *(unsigned*)0x4000d020
kill
""",
                elf=FIRMWARE / "selfcal.elf",
            )
            run.end()
        for text in (
            "COPROCESSOR          0x4000c000",
            "CLOCKCTRL            0x4000e000",
            "PERIOD               0x4000d010",
            "$1 = 0x43415053",
            "$2 = 161",
            "$3 = 0",
            "CTRL                 0x4000c008",
            "A1                   0x4000c080",
            "FREQ                 0x4000e014  0x017d7840",
            "STATUS.LOCK = 0x",
            "svd COPROCESSOR.STATUS\n",
            "svd COPROCESSOR.STEP_AU\n",
            "svd COPROCESSOR.STATUS.LOCK\n",
            "svd load\n",
            "refused: COPROCESSOR has no register NONE",
            "$4 = 1",
        ):
            self.assertIn(text, out)
        self.assertRegex(out, r"\[3:2\] +REF +0x[012] (NUMERIC|TRACKING|ANGLE)")

    def test_every_register_of_the_board_by_name_from_a_sourced_script(self):
        """`svd` reads what GDB reads there itself; the command comes by a script that another script sources."""
        script = """
import re
gdb.execute("source %s")
for name in [line.split()[0] for line in gdb.execute("svd list", to_string=True).splitlines()]:
  for line in gdb.execute("svd list " + name, to_string=True).splitlines():
    register, address, access = line.split()[:3]
    if access == "write-only":
      continue
    shown = int(gdb.parse_and_eval('$svd("%%s.%%s")' %% (name, register)))
    word = int.from_bytes(bytes(gdb.selected_inferior().read_memory(int(address, 16), 4)), "little")
    print("register", name, register, "same" if shown == word else "differs")
""" % (
            SOURCE / "scripts/debugger/svd.py"
        )
        with tempfile.NamedTemporaryFile("w", suffix=".py") as file, Run(FIRMWARE / "hello.elf", "--halt") as run:
            file.write(script)
            file.flush()
            out = gdb(run, f"\nsource {file.name}\nkill\n", elf=FIRMWARE / "hello.elf")
            run.end()
        found = re.findall(r"^register (\w+) (\w+) (same|differs)$", out, re.MULTILINE)
        self.assertGreater(len(found), 400)
        self.assertEqual([each for each in found if each[2] != "same"], [])
        self.assertEqual(len({name for name, _, _ in found}), 26)


class Bringup(unittest.TestCase):
    """The whole session in one go, alone and at the same time as a second client."""

    SCRIPT = """
load
monitor reset halt
maintenance flush register-cache
source scripts/debugger/svd.py
break main
continue
delete
break SysTick_Handler
continue
backtrace
stepi
stepi
next
finish
delete
watch written
continue
delete
print/x $svd("COPROCESSOR.ID")
svd COPROCESSOR.STATUS
set var crash_wanted = 1
break HardFault_Handler
continue
backtrace
delete
monitor reset halt
maintenance flush register-cache
break main
continue
print crash_wanted
delete
continue
"""

    def check(self, out, result):
        for text in (
            "Loading section .text",
            "Breakpoint 1, main ()",
            "SysTick_Handler ()",
            "<signal handler called>",
            "Hardware watchpoint 3: written",
            "New value = ",
            "= 0x43415053",
            "VALID",
            "HardFault_Handler ()",
            " in crash (",
            "$3 = 0",
            "exited normally",
        ):
            self.assertIn(text, out)
        self.assertEqual(result[:2], (0, b"debuggee: right\n"))

    def test_alone(self):
        with Run(DEBUGGEE, "--halt") as run:
            out = gdb(run, self.SCRIPT)
            self.check(out, run.end())

    def test_with_two_clients(self):
        with Run(DEBUGGEE, "--halt") as run, Packets(run) as second:
            looks = []

            def look():
                # Until the first client ends the run, and the server with it.
                try:
                    while True:
                        looks.append((second.word(0x4000C000), second.word(0xE000ED00)))
                except (ConnectionError, OSError):
                    pass

            watcher = threading.Thread(target=look)
            watcher.start()
            out = gdb(run, self.SCRIPT)
            result = run.end()
            watcher.join(timeout=30)
            self.assertFalse(watcher.is_alive())
        self.check(out, result)
        self.assertGreater(len(looks), 100)
        self.assertEqual(set(looks), {(0x43415053, 0x412FC231)})


class Comparison:
    """With a run of the debuggee without a debugger."""

    def plain(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "r.json"
            done = subprocess.run(
                [CAPSOC, "run", DEBUGGEE, "--json", path], capture_output=True, timeout=60, check=True, env=CLEAN
            )
            return done.stdout, json.loads(path.read_text())

    def check_same(self, run):
        uart, expected = self.plain()
        code, out, result = run.end()
        self.assertEqual((code, out), (0, uart))
        for key in ("instructions", "cycles"):
            self.assertEqual(result["cpu"][key], expected["cpu"][key], key)
        self.assertEqual(result["time"]["simulated_s"], expected["time"]["simulated_s"])
        self.assertEqual(result["configuration"], expected["configuration"])


class Protocol(Comparison, unittest.TestCase):
    """What the client hides."""

    def test_looking_changes_nothing(self):
        at = symbols()
        with Run(DEBUGGEE, "--halt") as run, Packets(run) as gdb_client:
            for address in (0, 0x20000000, 0x40004000, 0x40000000, 0xE000E010, 0xE000ED00, 0x4000C000):
                gdb_client.ask(f"m{address:x},40")
            gdb_client.ask(f"Z0,{at['work']:x},2")
            gdb_client.ask(f"Z2,{at['written']:x},4")
            gdb_client.ask(f"Z3,{at['settings']:x},4")
            for _ in range(90):
                gdb_client.ask("g")
                self.assertRegex(gdb_client.ask("vCont;c"), "^T05(swbreak|watch|rwatch):")
            gdb_client.ask(f"z0,{at['work']:x},2")
            gdb_client.ask(f"z2,{at['written']:x},4")
            gdb_client.ask(f"z3,{at['settings']:x},4")
            self.assertEqual(gdb_client.ask("vCont;c"), "W00")
            self.check_same(run)

    def test_stepping_neither_skips_nor_invents_interrupts(self):
        at = symbols()
        with Run(DEBUGGEE, "--halt") as run, Packets(run) as gdb_client:
            gdb_client.run_to(at["main"])
            handler = 0
            for _ in range(3000):
                self.assertTrue(gdb_client.ask("vCont;s:1").startswith("T05"))
                handler += gdb_client.register(15) == at["SysTick_Handler"] & ~1
            self.assertGreater(handler, 2)
            self.assertAlmostEqual(gdb_client.word(at["ticks"]), handler, delta=1)
            self.assertEqual(gdb_client.ask("vCont;c"), "W00")
            self.check_same(run)

    def test_stop_reasons(self):
        at = symbols()
        with Run(DEBUGGEE, "--halt") as run, Packets(run) as gdb_client:
            for kind, name, expected in (
                (0, "work", "swbreak:"),
                (1, "work", "hwbreak:"),
                (2, "written", f"watch:{at['written']:x}"),
                (3, "settings", f"rwatch:{at['settings']:x}"),
                (4, "seen", f"awatch:{at['seen']:x}"),
            ):
                point = f"{kind},{at[name]:x},{2 if kind < 2 else 4}"
                self.assertEqual(gdb_client.ask("Z" + point), "OK")
                self.assertTrue(gdb_client.ask("vCont;c").startswith("T05" + expected), expected)
                self.assertEqual(gdb_client.ask("z" + point), "OK")
            start = gdb_client.register(15)
            self.assertTrue(gdb_client.ask(f"vCont;r{start:x},{start + 4:x}:1").startswith("T05thread"))
            self.assertNotIn(gdb_client.register(15), range(start, start + 4))

    def test_second_client_reads_while_the_first_runs(self):
        with Run(FOREVER, "--uart0", "null") as run, Packets(run) as first:
            first.packet("vCont;c")
            with Packets(run) as second:
                self.assertTrue(second.ask("?").startswith("T05"))
                stacks = {second.ask(f"m{second.register(13):x},10") for _ in range(200)}
                self.assertGreater(len(stacks), 2, "the processor runs")
                self.assertEqual(second.ask("D"), "OK")
            first.send(b"\x03")
            self.assertTrue(first.answer().startswith("T02"))
            pc = first.register(15)
            time.sleep(0.05)
            self.assertEqual(first.register(15), pc)
            out = gdb(run, "print/x $pc\ndetach\n", FOREVER)
            self.assertIn(f"= {pc:#x}", out)
            first.packet("k")
            self.assertEqual(run.end()[2]["exit"]["reason"], "ended by the debugger")

    def test_client_that_vanishes_does_not_end_the_run(self):
        at = symbols()
        with Run(DEBUGGEE, "--halt") as run:
            with Packets(run) as client:
                client.ask(f"Z0,{at['work']:x},2")
                self.assertTrue(client.ask("vCont;c").startswith("T05swbreak"))
            self.check_same(run)

    def test_sleeping_processor_is_interrupted_stepped_and_reset(self):
        at = symbols()
        with Run(DEBUGGEE, "--halt") as run, Packets(run) as client:
            client.run_to(at["main"])
            client.ask(f"M{at['sleep_wanted']:x},1:01")
            client.packet("vCont;c")
            for _ in range(20):
                time.sleep(0.005)
                client.send(b"\x03")
                self.assertTrue(client.answer().startswith("T02"))
                before = client.word(at["ticks"])
                for _ in range(40):
                    self.assertTrue(client.ask("vCont;s:1").startswith("T05"))
                self.assertGreater(client.word(at["ticks"]), before)
                client.packet("vCont;c")
            client.send(b"\x03")
            client.answer()
            # Without SysTick nothing wakes it any more; it is still the debugger's.
            self.assertEqual(client.ask("Me000e010,4:00000000"), "OK")
            client.packet("vCont;c")
            time.sleep(0.2)
            client.send(b"\x03")
            self.assertTrue(client.answer().startswith("T02"))
            self.assertIn("asleep", bytes.fromhex(client.ask("qThreadExtraInfo,1")).decode())
            self.assertEqual(client.ask("qRcmd," + b"reset halt".hex()), "OK")
            self.assertEqual(client.register(15), client.word(4) & ~1)
            self.assertEqual(client.register(26), client.word(0))
            self.assertEqual(client.ask("vCont;c"), "W00", "start-up cleared the request to sleep")
            self.assertEqual(run.end()[:2], (0, b"debuggee: right\n"))

    def test_lockup_and_bkpt_stop_instead_of_ending(self):
        at = symbols()
        with Run(DEBUGGEE, "--halt") as run, Packets(run) as client:
            client.run_to(at["work"])
            self.assertEqual(client.ask(f"M{at['work']:x},2:01be"), "OK")  # bkpt #1
            self.assertTrue(client.ask("vCont;c").startswith("T05thread"))
            self.assertEqual(client.register(15), at["work"] & ~1)
            # No fault handler in reach: the vector table is where nothing answers.
            self.assertEqual(client.ask("Me000ed08,4:00000010"), "OK")
            self.assertEqual(client.ask(f"M{at['work']:x},2:00de"), "OK")  # udf
            self.assertTrue(client.ask("vCont;c").startswith("T0b"))
            self.assertIn("lockup", bytes.fromhex(client.ask("qThreadExtraInfo,1")).decode())
            self.assertEqual(client.ask("qRcmd," + b"reset halt".hex()), "OK")
            self.assertEqual(client.register(15), client.word(4) & ~1)

    def test_a_fault_handler_that_branches_to_itself_stops(self):
        with Run(FIRMWARE / "spin.elf", "--halt") as run, Packets(run) as client:
            for _ in range(2):
                self.assertTrue(client.ask("vCont;c").startswith("T0b"))
                self.assertEqual(client.register(25) & 0x1FF, 3, "in the HardFault handler")
                self.assertEqual(client.word(0xE000ED38), 0x60000000)
                self.assertTrue(client.ask("vCont;s:1").startswith("T0"))
                self.assertEqual(client.ask("qRcmd," + b"reset halt".hex()), "OK")
            self.assertEqual(client.ask("D"), "OK")
            self.assertEqual(run.end()[0], 5, "without a debugger it is a crash")

    def test_halt_without_gdb_and_a_taken_port_are_refused(self):
        done = subprocess.run(
            [CAPSOC, "run", DEBUGGEE, "--halt"], capture_output=True, timeout=60, check=False, env=CLEAN
        )
        self.assertEqual(done.returncode, 2)
        self.assertIn(b"--gdb", done.stderr)
        with Run(DEBUGGEE, "--halt") as run:
            done = subprocess.run(
                [CAPSOC, "run", DEBUGGEE, "--gdb", str(run.port)],
                capture_output=True,
                timeout=60,
                check=False,
                env=CLEAN,
            )
            self.assertEqual(done.returncode, 2)
            self.assertIn(b"choose another port", done.stderr)

    def test_listens_on_the_loopback_interface_only(self):
        with Run(DEBUGGEE, "--halt") as run:
            table = Path("/proc/net/tcp").read_text().splitlines()
            local = [line.split()[1] for line in table if line.split()[3] == "0A"]
            mine = [address for address in local if address.endswith(f":{run.port:04X}")]
            self.assertEqual(mine, [f"0100007F:{run.port:04X}"])


class Probes(Comparison, unittest.TestCase):
    """A client that sends no packet is no debugger: it changes neither a halt nor a run."""

    #: What scripts, scanners and browsers send; no packet among it.
    WORDS = {
        "nothing": b"",
        "an acknowledgement": b"+",
        "a repeat": b"-",
        "a HTTP request": b"GET / HTTP/1.1\r\nHost: localhost:3333\r\n\r\n",
        "a greeting of TLS": bytes.fromhex("16030100c8010000c40303") + bytes(range(0x40, 0x60)),
        "an interrupt": b"\x03",
        "noise": bytes(range(256)).replace(b"$", b"") * 40,
        "half a packet": b"$qSuppor",
        "a packet without its checksum": b"+$qSupported#",
        "a packet with a wrong checksum": b"$?#00",
        "a packet without an end": b"$" + b"0" * 100_000,
    }

    @staticmethod
    def probe(run, data, wait=0.05):
        with socket.create_connection(("127.0.0.1", run.port), timeout=30) as client:
            client.sendall(data)
            time.sleep(wait)

    def check_stands(self, run):
        """Nothing was executed, and a real debugger finds it so."""
        time.sleep(0.2)
        self.assertIsNone(run.process.poll(), "it ran off")
        with Packets(run) as client:
            self.assertEqual(client.word(0), client.register(13), "the stack pointer out of the vector table")
            self.assertEqual(client.word(4) & ~1, client.register(15), "before the first instruction")
            self.assertEqual(client.ask("vCont;c"), "W00")

    def test_a_halt_stands(self):
        for what, data in self.WORDS.items():
            with self.subTest(what), Run(DEBUGGEE, "--halt") as run:
                self.probe(run, data)
                self.check_stands(run)
                self.check_same(run)

    def test_a_halt_stands_after_two_in_a_row_and_twenty_at_once(self):
        with Run(DEBUGGEE, "--halt") as run:
            self.probe(run, b"")
            self.probe(run, b"")
            clients = [socket.create_connection(("127.0.0.1", run.port), timeout=30) for _ in range(20)]
            for client in clients:
                client.close()
            self.check_stands(run)
            self.check_same(run)

    def test_a_run_goes_on_while_silent_clients_are_there(self):
        for what, data in self.WORDS.items():
            with self.subTest(what), Run(DEBUGGEE, "--halt") as run, socket.create_connection(
                ("127.0.0.1", run.port), timeout=30
            ) as client:
                client.sendall(data)
                with Packets(run) as debugger:
                    self.assertEqual(debugger.ask("D"), "OK")
                self.check_same(run)

    def test_a_run_is_not_halted_by_one_that_comes(self):
        for data in (b"", b"\x03"):
            with Run(FOREVER, "--uart0", "null", "--simlimit", 15) as run, socket.create_connection(
                ("127.0.0.1", run.port), timeout=30
            ) as client:
                client.sendall(data)
                self.assertEqual(run.end()[2]["exit"]["reason"], "the limit of 15 simulated s was hit")

    def test_a_crash_ends_the_run_though_a_silent_client_is_there(self):
        for program, code in (("divzero", 5), ("evenjump", 5)):
            with Run(FIRMWARE / f"{program}.elf", "--halt") as run, socket.create_connection(
                ("127.0.0.1", run.port), timeout=30
            ):
                with Packets(run) as client:
                    self.assertEqual(client.ask("D"), "OK")
                self.assertEqual(run.end()[0], code)

    def test_a_session_of_another_client_is_not_disturbed(self):
        at = symbols()
        with Run(DEBUGGEE, "--halt") as run, Packets(run) as client:
            client.run_to(at["main"])
            pc = client.register(15)
            for data in self.WORDS.values():
                self.probe(run, data, wait=0.02)
                self.assertEqual(client.register(15), pc)
            self.assertEqual(client.ask("vCont;c"), "W00")
            self.check_same(run)

    def test_a_session_that_runs_is_not_halted_by_another_client(self):
        with Run(FOREVER, "--uart0", "null") as run, Packets(run) as client:
            client.packet("c")
            for data in self.WORDS.values():
                self.probe(run, data, wait=0.02)
            client.socket.settimeout(0.2)
            with self.assertRaises(TimeoutError):
                client.answer()
            client.socket.settimeout(30)
            client.send(b"\x03")
            self.assertTrue(client.answer().startswith("T02"))
            client.packet("k")
            run.end()

    def test_the_first_packet_behind_noise_makes_a_debugger(self):
        with Run(FOREVER, "--uart0", "null") as run:
            with Packets.__new__(Packets) as client:
                client.socket = socket.create_connection(("127.0.0.1", run.port), timeout=30)
                client.buffer = b""
                client.send(b"noise\x03+")
                self.assertTrue(client.ask("?").startswith("T05"))
                client.send(b"+")
                pc = client.register(15)
                time.sleep(0.05)
                self.assertEqual(client.register(15), pc, "it halts the processor")
                client.send(b"+")
                client.packet("c")
                client.send(b"\x03")
                self.assertTrue(client.answer().startswith("T02"))
                client.packet("k")
            run.end()

    def test_a_debugger_is_the_first_one_though_probes_came_before(self):
        with Run(FOREVER, "--uart0", "null") as run, socket.create_connection(
            ("127.0.0.1", run.port), timeout=30
        ), Packets(run) as client:
            pc = client.register(15)
            time.sleep(0.05)
            self.assertEqual(client.register(15), pc, "it halts the processor")
            client.packet("k")
            self.assertEqual(run.end()[2]["exit"]["reason"], "ended by the debugger")


if __name__ == "__main__":
    unittest.main()
