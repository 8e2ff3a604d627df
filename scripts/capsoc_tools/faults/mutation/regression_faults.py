"""Runs the regression on the faults of tests/faults/regression.toml: every one must be noticed.

Puts all of them into one copy of the RTL, chosen by a variable, Verilates it once for each arithmetic, and
runs the regression's stimulus on each. Ends with 0 if all were noticed, 1 if not, 2 if something is missing or a
fault's place is not in the RTL any more (exactly once).
"""

import argparse
import sys
from pathlib import Path

from capsoc_tools.faults.mutation import mutation
from capsoc_tools.faults import planting

SELECTOR = """package faults;
  int unsigned selected /* verilator public_flat_rw */;
endpackage
"""


def planted(files, faults):
    """The texts of source files with all of the faults in them, by file name; a fault's number is its position."""
    number = {fault["name"]: position for position, fault in enumerate(faults, 1)}
    names = {file.name for file in files}
    for fault in faults:
        if Path(fault["file"]).name not in names:
            raise planting.PlantError(f"there is no {fault['file']}, the file of '{fault['name']}'")
    return {
        file.name: planting.all_planted(
            file.read_text(encoding="utf-8"),
            [fault for fault in faults if Path(fault["file"]).name == file.name],
            lambda fault: f"faults::selected == {number[fault['name']]}",
        )
        for file in files
    }


def of_arithmetic(every, arithmetic):
    return [fault for fault in every if fault["arithmetic"] in (arithmetic, "both")]


def write_copy(faults, folder, rtl):
    """The design with all of the faults in it, in `folder`/rtl; its files in reading order."""
    copy = folder / "rtl"
    copy.mkdir(parents=True, exist_ok=True)
    files = mutation.sources(folder, rtl)
    for name, text in planted(files, faults).items():
        (copy / name).write_text(text, encoding="utf-8")
    (copy / "faults.sv").write_text(SELECTOR, encoding="utf-8")
    return [copy / "faults.sv"] + [copy / file.name for file in files]


def build(arithmetic, faults, arguments):
    folder = arguments.output / f"faults-{arithmetic}"
    files = write_copy(faults, folder, arguments.rtl)
    return mutation.build_library(files, folder, ["-GPaper=" + str(int(arithmetic == "paper"))], ["-DCAPSOC_FAULTS"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    mutation.add_options(parser)
    planting.add_options(parser, jobs=False)
    parser.set_defaults(edges=0)  # few are left when the long scenarios begin
    arguments = mutation.parse(parser)
    survived = 0
    try:
        every = planting.chosen("regression", arguments, located=False)
        for arithmetic in arguments.arithmetics:
            faults = of_arithmetic(every, arithmetic)
            if not faults:
                continue
            library = build(arithmetic, faults, arguments)
            mutation.build_runner(arguments, library.parent)
            found = mutation.verdicts(
                library, arithmetic, range(1, len(faults) + 1), arguments, arguments.edges, library.parent
            )
            print(f"arithmetic {arithmetic}")
            for number, fault in enumerate(faults, 1):
                verdict = found[number]
                survived += verdict[0] != "killed"
                how = f"{verdict[1]}, cycle {verdict[2]}: {verdict[3]}" if verdict[0] == "killed" else ""
                print(f"  {verdict[0]:<9}{Path(fault['file']).name:<24}{fault['name']:<62}{how}")
            killed = sum(found[number][0] == "killed" for number in range(1, len(faults) + 1))
            print(f"noticed: {killed} of {len(faults)}\n")
    except (mutation.MutationError, planting.PlantError) as error:
        print(f"faults: {error}", file=sys.stderr)
        return 2
    return 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main())
