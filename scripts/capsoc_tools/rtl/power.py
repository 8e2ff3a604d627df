"""Estimates the coprocessor's energy from the toggles of its netlist in standard cells, by unit.

usage: power [--arithmetic precise|safety|paper|two-clocks|all] [--samples N] [--seed N] [--idle N] [--slew PS]
             [--no-delay-run] [--opensta] [--json FILE] [--liberty FILE] [--work FOLDER]

yosys maps the RTL to the cells of the Debian package qflow-tech-osu018 (180 nm, 1.8 V), each module by itself. A
sampled sensor drives the netlist next to the Verilated RTL while it learns. All outputs are compared in every clock.
The Liberty file says what each edge of a net costs. Two runs: samples with at least --idle clocks of idle_o between
them, and a sample in every tick. A third design gets its clock only while idle_o is 0, or a sample or a transfer
comes, and has to give the same outputs.

Not in the figures: wires, a clock tree, the memories' insides (their accesses are counted). Without delays a net
changes once after each edge; real gates glitch. A run with the same delay for each cell shows how much that can be.

--arithmetic    default: all but two-clocks
--samples       counted, after 16 others; default 64
--idle          default 100
--slew          nominal slew in picoseconds, default 180
--no-delay-run  leaves out the runs with unit delays, which have a quarter of the samples
--opensta       compares the power at a uniform activity with OpenSTA's (package opensta)
--liberty       another Liberty file with flip-flops DFF and DFFSR as yosys maps them
--work          netlists, programs, counts, cells.v and activity.saif; default build/power

Status 0: printed; 1: the netlist, or that with the gated clock, differs from the RTL; 2: a tool or package is missing.
"""

import argparse
import sys
from dataclasses import asdict
from pathlib import Path

from capsoc_tools.rtl.cells import mapping
from capsoc_tools.rtl.cells.energy import NOMINAL_SLEW, Unit, costs_of, total
from capsoc_tools.rtl.cells.liberty import read_liberty
from capsoc_tools.rtl.cells.netlist import Netlist
from capsoc_tools.rtl.cells.opensta import compare
from capsoc_tools.rtl.cells.saif import write_saif
from capsoc_tools.rtl.synth import CLOCK_MHZ, PARAMETERS
from capsoc_tools.rtl.synth_flow import ROOT, ToolError, write_figures

CLOCK = CLOCK_MHZ * 1e6
HALF_CLOCK_NS = round(5e8 / CLOCK)
SAMPLE_RATE = 250  # of the paper's converter, and of the main job
TICKS = 6  # a sample's five and the one that it may wait for
FOLDED = 4  # names of a unit's path that are printed
DELAY_SHARE = 4  # the runs with unit delays, which take longer, have a quarter of the samples
SMALLEST = 0.01  # share of a unit that has its own line


def folded(units, energy):
    """Units with the first names of their paths; those with a small share of `energy` as one."""
    sums = {}
    for name, unit in units.items():
        name = ".".join(name.split(".")[:FOLDED]) or "top"
        sums[name] = total({0: sums.get(name, Unit()), 1: unit})
    all_of = sum(map(energy, sums.values()))
    small = {name: unit for name, unit in sums.items() if energy(unit) < SMALLEST * all_of}
    kept = {name: sums[name] for name in sorted(sums) if name not in small}
    return {**kept, f"{len(small)} others": total(small)}


def print_units(units, samples, open_clocks):
    """Per sample; the clock pins in the clocks in which the gate is open."""

    def energy(unit):
        return unit.switched + unit.clock * open_clocks

    rows = folded(units, energy)
    rows["together"] = sums = total(units)
    heads = zip(("cells", "FF", "toggles", "gates", "FF", "clock", "nJ", "share"), (8, 6, 10, 8, 7, 8, 8, 8))
    print(f"  {'unit, nJ per sample':54}" + "".join(f"{head:>{width}}" for head, width in heads))
    for name, unit in rows.items():
        parts = [1e9 / samples * part for part in (unit.gates, unit.registers, unit.clock * open_clocks)]
        share = energy(unit) / energy(sums)
        print(
            f"  {name:54}{unit.cells:8,}{unit.flip_flops:6,}{unit.toggles / samples:10,.0f}{parts[0]:8.2f}"
            f"{parts[1]:7.2f}{parts[2]:8.2f}{sum(parts):8.2f}{share:8.1%}"
        )


def powers(sums, samples, run, rate):
    """Watt at `rate` samples a second: with the clock always on, and gated by idle_o."""
    switched = sums.switched / samples * rate
    return {
        "free": switched + sums.clock * CLOCK + sums.leakage,
        "gated": switched + sums.clock * run.open / samples * rate + sums.leakage,
    }


def measure(costs, run, samples, rate):
    """The figures of one run; joules and toggles are those of one sample."""
    units = costs.spent(run.counts)
    sums = total(units)
    return {
        "clocks": run.clocks / samples,
        "open_clocks": run.open / samples,
        "quiet_clocks": run.quiet / samples,
        "quiet_toggles": run.quiet_toggles,
        "toggles": sums.toggles / samples,
        "gates_j": sums.gates / samples,
        "flip_flops_j": sums.registers / samples,
        "clock_j": sums.clock * run.open / samples,
        "power_w": {"samples_per_s": rate, **powers(sums, samples, run, rate)},
        "units": {name: asdict(unit) for name, unit in sorted(units.items())},
    }


def print_powers(result):
    print(f"  power at a clock of {CLOCK_MHZ} MHz, mW{'':21}{'clock on':>12}{'gated by idle_o':>18}")
    rows = [("idle", result["idle_w"])]
    for key, run in result["runs"].items():
        delay = ", unit delays" if key.endswith("delay") else ""
        rows.append((f"{run['power_w']['samples_per_s']:,.0f} samples/s{delay}", run["power_w"]))
    for name, watt in rows:
        print(f"  {name:48}{1e3 * watt['free']:12.4f}{1e3 * watt['gated']:18.4f}")


def save_saif(netlist, run, folder):
    end = 2 * run.clocks
    nets = {f"n{net}": (end - high, high, rises + falls) for net, (high, rises, falls) in run.counts.items()}
    nets[f"n{netlist.clock}"] = (run.clocks, run.clocks, end)
    nets = {
        name: (low * HALF_CLOCK_NS, high * HALF_CLOCK_NS, toggles)
        for name, (low, high, toggles) in sorted(nets.items())
    }
    write_saif(folder / "activity.saif", f"{netlist.name}_cells", end * HALF_CLOCK_NS, nets)


def print_head(name, netlist, costs, options):
    sums, bits = total(costs.units), sum(memory.width * memory.size for memory in netlist.memories)
    print(
        f"== {name}: {sums.cells:,} cells, {sums.flip_flops:,} flip-flops; outside: {len(netlist.memories)} memories, "
        f"{bits:,} bits\n   {netlist.library.name}, {netlist.library.voltage} V, slew {options.slew:g} ps; "
        f"{options.samples} samples, seed {options.seed}"
    )
    return sums, bits


def report(name, options):
    parameters = dict(PARAMETERS[name])
    folder = options.work.resolve() / name
    library = read_liberty(options.liberty)
    netlist = Netlist(mapping.map_cells(parameters, options.liberty, folder), library)
    costs = costs_of(netlist, options.slew * 1e-12)
    (folder / "cells.v").write_text(netlist.structure())
    sums, bits = print_head(name, netlist, costs, options)
    program = mapping.build(netlist, parameters, folder)
    tick = 32 * parameters.get("IterationClocks", 1)
    cases = {"spaced": (TICKS * tick + options.idle, False), "full_rate": (tick, False)}
    if options.delay_run:
        cases |= {"spaced_delay": (TICKS * tick + options.idle, True), "full_rate_delay": (tick, True)}
    result = {"memory_bits": bits, "cells": sums.cells, "flip_flops": sums.flip_flops, "runs": {}}
    result["clock_j_a_cycle"], result["leakage_w"] = sums.clock, sums.leakage
    result["idle_w"] = {"free": sums.clock * CLOCK + sums.leakage, "gated": sums.leakage}
    for case, (period, delay) in cases.items():
        samples = max(1, options.samples // DELAY_SHARE) if delay else options.samples
        run = mapping.simulate(program, netlist, samples, options.seed, period, parameters["Safety"], delay)
        rate = SAMPLE_RATE if case.startswith("spaced") else CLOCK / tick
        figures = result["runs"][case] = measure(costs, run, samples, rate)
        switched = figures["gates_j"] + figures["flip_flops_j"]
        print(
            f"  a sample every {period} clocks{', unit delays' if delay else ''}: {run.clocks:,} clocks as the RTL\n"
            f"    a sample: {figures['toggles']:,.0f} toggles, {1e9 * switched:.2f} nJ;"
            f" clock pins {1e9 * figures['clock_j']:.2f} nJ in {figures['open_clocks']:.1f} clocks",
            flush=True,
        )
        if case == "spaced":
            save_saif(netlist, run, folder)
            result["samples_a_turn"] = run.samples_a_turn
            writes, reads = (sum(column) / options.samples for column in zip(*run.accesses))
            result |= {"memory_writes": writes, "memory_reads": reads}
            print_units(costs.spent(run.counts), options.samples, run.open)
            print(
                f"  memories: {writes:.1f} words written and {reads:.1f} read a sample\n"
                f"  quiet clocks (idle_o, no sample, bus as before): {run.quiet:,}, with {run.quiet_toggles} toggles"
            )
    print_powers(result)
    if options.opensta:
        kinds = {cell.kind for cell in netlist.cells}
        result["opensta"] = compare(kinds, library, options.liberty, options.slew * 1e-12, folder)
    return result


def print_relative(results):
    first, *others = results
    for name in others:
        one, other = results[first]["runs"]["spaced"], results[name]["runs"]["spaced"]
        ratios = {key: other[key] / one[key] for key in ("toggles", "gates_j", "flip_flops_j", "clock_j")}
        print(
            f"{name} / {first}, per sample: "
            + ", ".join(f"{key.removesuffix('_j')} {value:.2f}" for key, value in ratios.items())
        )


def main(words=None):
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1])
    parser.add_argument("--arithmetic", choices=[*PARAMETERS, "all"], default="all")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--idle", type=int, default=100)
    parser.add_argument("--slew", type=float, default=NOMINAL_SLEW * 1e12)
    parser.add_argument("--no-delay-run", dest="delay_run", action="store_false")
    parser.add_argument("--opensta", action="store_true")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--liberty", type=Path, default=mapping.LIBERTY)
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "power")
    options = parser.parse_args(words)
    names = (
        [name for name in PARAMETERS if name != "two-clocks"] if options.arithmetic == "all" else [options.arithmetic]
    )
    results = {}
    try:
        if options.samples < 1 or options.idle < 0:
            raise ToolError("--samples has to be 1 or more, and --idle 0 or more")
        mapping.liberty_file(options.liberty)
        for name in names:
            results[name] = report(name, options)
        print_relative(results)
        head = {"seed": options.seed, "samples": options.samples, "slew_ps": options.slew, "clock_hz": CLOCK}
        write_figures(options.json, {**head, "arithmetics": results})
    except mapping.Different as difference:
        print(f"power: {difference}", file=sys.stderr)
        return 1
    except ToolError as error:
        print(f"power: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
