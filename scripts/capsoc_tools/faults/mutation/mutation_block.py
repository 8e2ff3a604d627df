"""Some of the mutants that `mutation --prepare` made, for a campaign that shares them out: campaigns/mutation.toml.

Holds the mutants of --first to --last against the regression's stimulus as `mutation` does, proves what is left, and
prints one JSON object: how many were killed, are equivalent and survived, and which survived. Ends with 0, with 2 if
something is missing.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

from capsoc_tools.faults.mutation import mutation


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    mutation.add_options(parser)
    parser.add_argument("--first", type=int, required=True)
    parser.add_argument("--last", type=int, required=True)
    parser.set_defaults(arithmetic="precise", jobs=1)
    arguments = mutation.parse(parser)
    arguments.resume, arguments.first_edges = False, 2000
    made = arguments.output / arguments.arithmetic
    try:
        if not (made / "mutants.so").exists():
            raise mutation.MutationError(f"{made / 'mutants.so'} is missing; run scripts/tool mutation --prepare")
        mutants = (made / "mutants.txt").read_text(encoding="utf-8").splitlines()
        if not 1 <= arguments.first <= arguments.last <= len(mutants):
            raise mutation.MutationError(f"there are the mutants 1 to {len(mutants)}")
        numbers = range(arguments.first, arguments.last + 1)
        with tempfile.TemporaryDirectory() as folder:
            found = mutation.decide(
                arguments.arithmetic, made / "mutants.so", mutants, numbers, arguments, Path(folder)
            )
    except mutation.MutationError as error:
        print(f"some: {error}", file=sys.stderr)
        return 2
    depth = mutation.depths(mutation.rtl_sources.read_list(arguments.rtl / mutation.rtl_sources.DESIGN))
    verdicts = [found[number][0] for number in numbers]
    survivors = [
        f"{number} {file}:{at} {mutation.describe(mutants[number - 1])}"
        for number in numbers
        if found[number][0] == "survived"
        for file, at in [mutation.place(mutants[number - 1], depth)]
    ]
    print(
        json.dumps(
            {
                "mutants": len(numbers),
                "killed": verdicts.count("killed"),
                "equivalent": verdicts.count("equivalent"),
                "survived": verdicts.count("survived"),
                "survivors": "; ".join(survivors),
            }
        )
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
