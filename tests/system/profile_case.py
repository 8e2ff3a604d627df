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

    def check_checkpoints(self, program, parts, other):
        """Saved at parts of the run, which they continue to its end; the profile `other` refuses them."""
        chosen = self.CHOSEN[1].split("=")[1]
        whole = output_of(CAPSOC, "run", program, *self.CHOSEN, "--json", self.folder / "whole.json")
        seconds = self.result("whole.json")["time"]["simulated_s"]
        for number, part in enumerate(parts):
            saved = self.folder / f"saved{number}"
            done = capsoc("run", program, *self.CHOSEN, "--save", f"{saved}@{part * seconds:.9f}")
            self.assertEqual((done.returncode, done.stdout.decode()), (0, whole), done.stderr)
            refused = capsoc("run", program, "-C", f"cpu.profile={other}", "--restore", saved)
            self.check_refused(
                refused.returncode,
                refused.stdout,
                refused.stderr.decode(),
                f"was saved with another cpu.profile ({chosen}, here {other}); give the same as then",
            )
            done = capsoc("run", program, *self.CHOSEN, "--restore", saved, "--json", self.folder / "rest.json")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue(whole.endswith(done.stdout.decode()))
            self.assertEqual(self.result("rest.json")["cpu"]["cycles"], self.result("whole.json")["cpu"]["cycles"])
