"""Proves properties of the RTL with yosys-smtbmc.

usage: formal [--with-fault] [--list] [--waves FOLDER] [NAME...]

Without names: every proof of rtl/formal/proofs.toml. A proof is a bounded check from reset (bmc), an
induction step (ind), or both; induction without an assertion that fails proves for all time.
--with-fault plants each of the proof's faults of tests/faults/proofs.toml into a copy of the RTL and expects the
proof to fail: a proof that cannot fail proves nothing.

Prints proof, engine, result and seconds. A proof that fails names its assertions and writes its counterexample as
waves, FOLDER/NAME.vcd, in formal_waves if no folder is named; the next line says in which cycle it fails. The waves of
faults that were found are written if a folder is named. Status 0: as expected; 1: a proof failed, or missed its fault;
2: a tool is missing or the arguments are wrong.
"""

import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

from capsoc_tools.faults import planting
from capsoc_tools.rtl.sources import DESIGN, RTL, RtlError, generate, read_list
from capsoc_tools.rtl.yosys_types import readable

PROOFS = RTL / "formal" / "proofs.toml"


class ProofError(Exception):
    """A proof that could not be set up."""


def read_proofs():
    """The proofs by name, each with its faults."""
    proofs = {proof["name"]: proof for proof in tomllib.loads(PROOFS.read_text(encoding="utf-8"))["proof"]}
    for fault in planting.read_list("proofs")["fault"]:
        if fault["proof"] not in proofs:
            raise planting.PlantError(f"tests/faults/proofs.toml has a fault for {fault['proof']!r}, which is no proof")
        proofs[fault["proof"]].setdefault("faults", []).append(fault)
    for name, proof in proofs.items():
        if "faults" not in proof:
            raise planting.PlantError(f"tests/faults/proofs.toml has no fault for the proof {name!r}; add one")
    return proofs


def copy_sources(proof, folder, fault=None):
    """The proof's files in `folder`, in reading order, with a fault of tests/faults/proofs.toml if one is given."""
    made = [path.name for path in generate(folder)]
    names = [name for name in made if name.startswith("capsoc_")]
    if proof.get("sources") == ["*"]:  # the whole design
        own = [path for path in read_list(RTL / DESIGN) if not path.match(proof.get("except", "-"))]
        names = made + [path.name for path in own]
        for path in own:
            shutil.copy(path, folder)
    else:
        for name in proof.get("sources", []):
            file = Path(name).name
            if not (folder / file).exists():
                shutil.copy(RTL / name, folder)
            names.append(file)
    if "harness" in proof:
        shutil.copy(RTL / "formal" / proof["harness"], folder)
        names.append(proof["harness"])
    if fault:
        planting.plant(folder / Path(fault["file"]).name, fault)
    return list(dict.fromkeys(names))


def yosys(folder, script):
    done = subprocess.run(["yosys", "-q", "-p", script], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise ProofError((done.stdout + done.stderr).strip() or "yosys failed")


PREPARE = "prep -flatten -top {top}; memory_map; async2sync; dffunmap; opt_clean; " "setundef -undriven -anyseq"


def freeze_all_registers(netlist, top, quiet):
    """Asserts for every register of the netlist that it keeps its value while `quiet` is 1."""
    module = netlist["modules"][top]
    permission = module["netnames"][quiet]["bits"][0]
    highest = max(bit for net in module["netnames"].values() for bit in net["bits"] if isinstance(bit, int))
    cells = {}
    for name, cell in module["cells"].items():
        if cell["type"] != "$dff":
            continue
        width = len(cell["connections"]["Q"])
        highest += 1
        cells[f"keeps:{name}"] = {
            "type": "$eq",
            "parameters": {"A_SIGNED": 0, "B_SIGNED": 0, "A_WIDTH": width, "B_WIDTH": width, "Y_WIDTH": 1},
            "attributes": {},
            "port_directions": {"A": "input", "B": "input", "Y": "output"},
            "connections": {"A": cell["connections"]["D"], "B": cell["connections"]["Q"], "Y": [highest]},
        }
        cells[f"assert:{name}"] = {
            "type": "$assert",
            "parameters": {},
            "attributes": {},
            "port_directions": {"A": "input", "EN": "input"},
            "connections": {"A": [highest], "EN": [permission]},
        }
    module["cells"].update(cells)
    return len(cells) // 2


def translate(proof, folder, names):
    top = proof["top"]
    # Assertions are named by the files' paths, so these begin at the folder.
    files = " ".join(str(file.relative_to(folder)) for file in readable([folder / name for name in names], folder))
    read = f"read_verilog -sv -formal -D FORMAL {files}; "
    for parameter, value in proof.get("parameters", {}).items():
        read += f"chparam -set {parameter} {value} {top}; "
    prepare = PREPARE.format(top=top)
    if "freeze" in proof:
        # Registers that no assertion looks at are not to be optimised away before they get one.
        prepare = f"hierarchy -top {top}; proc; setattr -set keep 1 t:$dff t:$adff t:$mem*; {prepare}"
    # A multiplier is no more than a function of its operands, which the proof does not look into.
    cut = "cutpoint t:$mul; opt_clean; setundef -undriven -anyseq; " if proof.get("cut") else ""
    if "freeze" in proof:
        yosys(folder, f"{read}{prepare}; {cut}write_json netlist.json")
        netlist = json.loads((folder / "netlist.json").read_text(encoding="utf-8"))
        freeze_all_registers(netlist, top, proof["freeze"])
        (folder / "frozen.json").write_text(json.dumps(netlist), encoding="utf-8")
        yosys(folder, "read_json frozen.json; opt_clean; write_smt2 -wires model.smt2")
    else:
        yosys(folder, f"{read}{prepare}; {cut}write_smt2 -wires model.smt2")


def engines(proof, fault):
    """[(label, arguments of yosys-smtbmc)]"""
    solver = proof.get("solver", "z3")
    chosen = []
    if proof.get("bmc"):
        chosen.append((f"{solver} bmc {proof['bmc']}", ["-s", solver, "-t", str(proof["bmc"])]))
    if proof.get("induction"):
        chosen.append((f"{solver} ind {proof['induction']}", ["-s", solver, "-i", "-t", str(proof["induction"])]))
    return chosen[::-1] if fault and proof.get("fault_first") == "induction" else chosen


WAVES = "counterexample.vcd"
CYCLE_NS = 10  # of yosys-smtbmc's waves


def smtbmc(arguments, folder, seconds):
    """Status and output of yosys-smtbmc; status None after a timeout."""
    # Unrolled formulas: z3 takes minutes for the other form of the same step. A separate session,
    # so that the solver ends with its driver; `timeout` ends both if this process is killed.
    command = ["timeout", "--signal=KILL", str(seconds + 5)]
    command += ["yosys-smtbmc", "--noprogress", "--unroll", "--dump-vcd", WAVES, *arguments, "model.smt2"]
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    ) as process:
        try:
            output, _ = process.communicate(timeout=seconds)
            return process.returncode, output
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return None, ""
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)


def last_cycle(waves):
    """The number of a counterexample's last cycle, which is the one whose assertion fails; the first is 0."""
    with open(waves, encoding="utf-8") as lines:
        times = [int(line[1:]) for line in lines if line.startswith("#")]
    return times[-1] // CYCLE_NS - 1


def keep_waves(folder, waves, induction):
    """Moves the counterexample in `folder` to the file `waves`; a sentence on where the failure is in it."""
    waves.parent.mkdir(parents=True, exist_ok=True)
    shutil.move(folder / WAVES, waves)
    cycle = last_cycle(waves)
    begin = "a state that the assertions allow, whether or not it can be reached" if induction else "the first"
    return f"fails in cycle {cycle} (0 is {begin}): {waves}, at {cycle * CYCLE_NS} ns"


def run(proof, fault=None, waves=None):
    """Yields (engine, passed, seconds, log, where it fails); `waves` is a file for the counterexample."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        translate(proof, folder, copy_sources(proof, folder, fault))
        for label, arguments in engines(proof, fault):
            start = time.monotonic()
            status, log = smtbmc(arguments, folder, proof.get("timeout", 170))
            passed = None if status is None else status == 0
            if passed is False and "FAILED" not in log:
                raise ProofError(log.strip())
            seconds = time.monotonic() - start
            where = keep_waves(folder, waves, "-i" in arguments) if passed is False and waves else ""
            yield label, passed, seconds, log, where


def prove(proof, fault, waves):
    """Runs one proof, prints its lines; whether all is as it should be."""
    verdicts = []
    for label, passed, seconds, log, where in run(proof, fault, waves):
        verdict = {True: "proved", False: "FAILED", None: "TIMEOUT"}[passed]
        if fault:
            verdict = "caught" if passed is False else "passed"
        print(f"{proof['name']:<24} {label:<14} {verdict:<8} {seconds:7.1f}", flush=True)
        if passed is False and not fault:
            print("\n".join(line for line in log.splitlines() if "Assert failed" in line))
        if where:
            print(f"{proof['name']}: {where}")
        verdicts.append(passed)
        if passed is False:
            break
    if fault:
        if False in verdicts:
            return True
        print(f"{proof['name']}: the fault was not found: {fault['name']}")
        return False
    return all(verdicts)


def prove_all(proof, arguments):
    """The proof as it is, or with each of its faults."""
    if not arguments.with_fault:
        return prove(proof, None, (arguments.waves or Path("formal_waves")) / f"{proof['name']}.vcd")
    good = True
    for number, fault in enumerate(proof["faults"], 1):
        waves = arguments.waves / f"{proof['name']}_fault_{number}.vcd" if arguments.waves else None
        good = prove(proof, fault, waves) and good
    return good


def arguments_of(command_line, known):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0], prog="formal")
    parser.add_argument("names", nargs="*", metavar="NAME", help="proofs to run; all if none is given")
    parser.add_argument(
        "--with-fault", action="store_true", help="plant each of a proof's faults and expect the proof to fail"
    )
    parser.add_argument("--waves", type=Path, metavar="FOLDER", help="where counterexamples go (formal_waves)")
    parser.add_argument("--list", action="store_true", help="print names and what they prove")
    arguments = parser.parse_args(command_line)
    unknown = [name for name in arguments.names if name not in known]
    if unknown:
        parser.error(f"no proof is called {', '.join(unknown)}; see --list")
    return arguments


def main(command_line):
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    try:
        proofs = read_proofs()
    except planting.PlantError as error:
        print(f"formal: {error}", file=sys.stderr)
        return 2
    arguments = arguments_of(command_line, proofs)
    chosen = [proofs[name] for name in arguments.names or proofs]
    if arguments.list:
        for proof in chosen:
            print(f"{proof['name']}: {proof['what']}")
            for fault in proof["faults"]:
                print(f"    fault: {fault['name']}")
        return 0
    tools = {"yosys", "yosys-smtbmc"} | {proof.get("solver", "z3") for proof in chosen}
    missing = sorted(tool for tool in tools if not shutil.which(tool))
    if missing:
        print(f"formal: {', '.join(missing)} not found; install scripts/packages.txt", file=sys.stderr)
        return 2
    print(f"{'proof':<24} {'engine':<14} {'result':<8} {'seconds':>7}")
    good = True
    for proof in chosen:
        try:
            good = prove_all(proof, arguments) and good
        except (ProofError, RtlError, planting.PlantError) as error:
            print(f"{proof['name']:<24} could not be set up: {error}")
            good = False
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
