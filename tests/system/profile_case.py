"""What the tests of the processors other than the Cortex-M3 share."""

import json
import subprocess

from harness import CAPSOC, CLEAN, FIRMWARE, Case, output_of, without_host_times


def capsoc(*arguments):
    return subprocess.run(
        [CAPSOC, *map(str, arguments)],
        capture_output=True,
        timeout=300,
        check=False,
        env=CLEAN,
        stdin=subprocess.DEVNULL,
    )


def ask(*requests):
    """The results of methods and their parameters, in one session; of a refused one its sentence."""
    lines = [
        json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": parameters})
        for number, (method, parameters) in enumerate(requests)
    ]
    out = output_of(CAPSOC, "serve", input="\n".join(lines) + "\n")
    answers = [json.loads(line) for line in out.splitlines()]
    return [each.get("result", each.get("error", {}).get("message")) for each in answers]


class Programs(Case):
    """Built for the processor that the options CHOSEN give the board, in every executor."""

    CHOSEN = ()

    def everywhere(self, program, *options):
        """Output and results, which are the same in every executor."""
        seen = []
        for executor in ("stepping", "blocks", "translator"):
            out = output_of(
                *(CAPSOC, "run", FIRMWARE / f"{program}.elf", *self.CHOSEN, "-C", f"cpu.executor={executor}"),
                *("--json", self.folder / "r.json", *options),
            )
            result = without_host_times(self.result())
            result.pop("configuration")
            result.pop("command")
            seen.append((out, result))
        for other in seen[1:]:
            self.assertEqual(other, seen[0])
        return seen[0]
