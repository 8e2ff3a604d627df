"""Prints area, clock and energy of the coprocessor's variants as one table, from what synth, route and power wrote.

usage: hardware_table FILE...

FILE is what `scripts/tool synth --json`, `scripts/tool route --json` or `scripts/tool power --json` wrote, in any order
and number. A row is an arithmetic with its number of channels, a cell without a figure is "-". Two files with the same
figure of the same variant are refused, and a netlist that differed from the RTL. Status 2: something is refused, or a
file cannot be read or is none of the three.
"""

import json
import sys

COLUMNS = (
    "ALM",
    "registers",
    "DSP",
    "memory bits",
    "path, ns",
    "LUT4",
    "MULT18",
    "routed, MHz",
    "LUT, 7 series",
    "nJ a sample",
    "mW, clock on",
    "mW, gated",
)


class BadFile(Exception):
    """Why a file is refused."""


def refuse_difference(name, compared):
    """If the tool simulated the netlist against the RTL, it must have been the same."""
    if not compared.get("identical", True):
        raise BadFile(f"the netlist of {name} differed from the RTL; its figures are of another design")


def of_synthesis(found):
    """(arithmetic, channels, figures by column) of each design in what synth wrote."""
    for name, design in found.items():
        if isinstance(design, dict) and "area" in design:
            refuse_difference(name, design.get("netlist", {}))
            area, path = design["area"], design.get("longest_path_ns")
            figures = {"ALM": area["alm"], "registers": area["registers"], "DSP": area["dsp"]}
            figures |= {"memory bits": area["memory_bits"], "path, ns": path}
            yield name, found["channels"], figures


def of_routing(found):
    for name, design in found["designs"].items():
        refuse_difference(name, design)
        cells = design["cells"]
        figures = {"LUT4": cells["LUT4"], "MULT18": cells["MULT18"], "routed, MHz": design["median_mhz"]}
        if design["xilinx"]:
            figures["LUT, 7 series"] = design["xilinx"]["LUT"]
        yield name, found["channels"], figures


def of_power(found):
    for name, design in found["arithmetics"].items():
        run = design["runs"]["spaced"]
        energy = 1e9 * (run["gates_j"] + run["flip_flops_j"] + run["clock_j"])
        powers = {
            f"mW, {title}": 1e3 * run["power_w"][key] for title, key in (("clock on", "free"), ("gated", "gated"))
        }
        yield name, 1, {"nJ a sample": energy, **powers}


READERS = {"table_7": of_synthesis, "designs": of_routing, "arithmetics": of_power}


def read(path):
    """The designs of one file."""
    try:
        with open(path, encoding="utf-8") as file:
            found = json.load(file)
        (reader,) = (reader for key, reader in READERS.items() if key in found)
        return list(reader(found))
    except OSError as error:
        raise BadFile(f"cannot read {path}: {error.strerror}; name a file that synth, route or power wrote") from error
    except (ValueError, KeyError, TypeError) as error:
        raise BadFile(f"{path} is nothing that synth, route or power of this version wrote; make it again") from error


def shown(value):
    """A count with its thousands, another figure with three digits."""
    if value is None:
        return "-"
    return f"{value:,}" if isinstance(value, int) else f"{value:.1f}" if value >= 10 else f"{value:.3g}"


def table(paths):
    """The lines of the table, in Markdown."""
    rows = {}
    for path in paths:
        for name, channels, figures in read(path):
            row = rows.setdefault((name, channels), {})
            if twice := sorted(row.keys() & figures.keys()):
                raise BadFile(f"{path} gives {twice[0]!r} of {name}, {channels} channels, again; leave one file out")
            row |= figures
    columns = [column for column in COLUMNS if any(column in row for row in rows.values())]
    lines = [["arithmetic", "channels", *columns], ["---"] * (2 + len(columns))]
    order = list(dict.fromkeys(name for name, _ in rows))
    for name, channels in sorted(rows, key=lambda key: (order.index(key[0]), key[1])):
        lines.append([f"`{name}`", str(channels), *(shown(rows[name, channels].get(column)) for column in columns)])
    return ["| " + " | ".join(line) + " |" for line in lines]


def main(arguments):
    if not arguments or arguments[0] in ("-h", "--help"):
        print(__doc__.strip(), file=sys.stdout if arguments else sys.stderr)
        return 0 if arguments else 2
    try:
        print("\n".join(table(arguments)))
    except BadFile as error:
        print(f"hardware_table: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
