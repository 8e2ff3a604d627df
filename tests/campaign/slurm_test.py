#!/usr/bin/env python3
"""capsoc campaign slurm on a real Slurm: slurmctld and two slurmd of Debian's packages, in the foreground, of this
user alone.
"""

import getpass
import os
import shlex
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from campaign_test import DRAWN, rows_of

from harness import CAPSOC, CLEAN

CTEST = {"name": "campaign slurm", "timeout": 1200, "long": ["Slurm"]}

RUNS = int(os.environ.get("CAPSOC_TEST_SLURM_RUNS", "1000"))
TASKS = 20
ENOUGH = 900  # seconds

CONFIGURATION = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/none
CredType=cred/none
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
ReturnToService=2
KillWait=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
SlurmdParameters=config_overrides
NodeName=one NodeHostname={host} NodeAddr=127.0.0.1 Port={one} CPUs=1
NodeName=two NodeHostname={host} NodeAddr=127.0.0.1 Port={two} CPUs=1
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


@unittest.skipUnless(
    shutil.which("slurmctld") and shutil.which("slurmd") and shutil.which("sbatch"),
    "slurmctld, slurmd and slurm-client are not installed",
)
class Slurm(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="capsoc-slurm-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        cluster = self.folder / "cluster"
        for name in ("state", "spool-one", "spool-two"):
            (cluster / name).mkdir(parents=True)
        port, one, two = free_ports(3)
        (cluster / "slurm.conf").write_text(
            CONFIGURATION.format(
                host=socket.gethostname(), folder=cluster, user=getpass.getuser(), port=port, one=one, two=two
            )
        )
        self.environment = {**CLEAN, "SLURM_CONF": str(cluster / "slurm.conf")}
        self.daemon("slurmctld", "-D", "-c")
        self.wait(lambda: "UP" in self.ask("scontrol", "ping"), 60)
        for name in ("one", "two"):
            self.daemon("slurmd", "-D", "-N", name)
        self.wait(lambda: self.ask("sinfo", "-h", "-t", "idle", "-o", "%D") == "2", 60)

    def daemon(self, *command):
        process = subprocess.Popen(command, env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

        def end():
            process.send_signal(signal.SIGTERM)
            process.wait(timeout=60)

        self.addCleanup(end)

    def ask(self, *command):
        return (
            subprocess.run(command, env=self.environment, capture_output=True, check=False, cwd=self.folder)
            .stdout.decode()
            .strip()
        )

    def wait(self, condition, seconds=ENOUGH):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, self.logs())
            time.sleep(0.2)

    def logs(self):
        text = ""
        for path in sorted(self.folder.glob("cluster/*.log")) + sorted(self.folder.glob("d.slurm/*.log")):
            text += f"--- {path.name}\n{path.read_text(errors='replace')[-1500:]}\n"
        return text + self.ask("squeue", "-r")

    def running(self, job):
        return self.ask("squeue", "-h", "-r", "-j", job, "-t", "running", "-o", "%i").split()

    def test_killed_requeued_and_drained(self):
        (self.folder / "d.toml").write_text(DRAWN.format(runs=RUNS))
        process = subprocess.run(
            [CAPSOC, "campaign", "slurm", "d.toml", "--tasks", str(TASKS)],
            env=self.environment,
            cwd=self.folder,
            capture_output=True,
            check=False,
        )
        self.assertEqual(process.returncode, 0, process.stderr.decode())
        words = process.stdout.decode().split("\n")[1].replace(",", "").replace(":", "").split()
        array, last = words[1], words[3]
        # One task is killed for good, the next one requeued, and a node is drained for a while.
        self.wait(lambda: self.running(array))
        killed = self.running(array)[0]
        self.ask("scancel", "--signal=KILL", "--full", killed)
        self.wait(lambda: set(self.running(array)) - {killed})
        requeued = sorted(set(self.running(array)) - {killed})[0]
        self.ask("scontrol", "requeue", requeued)
        self.ask("scontrol", "update", "nodename=two", "state=drain", "reason=test")
        self.wait(lambda: "drained" in self.ask("sinfo", "-h", "-n", "two", "-o", "%T"))
        self.ask("scontrol", "update", "nodename=two", "state=resume")
        self.wait(lambda: not self.ask("squeue", "-h", "-r", "-j", f"{array},{last}", "-o", "%i"))
        self.assertIn("0", self.ask("scontrol", "show", "job", last).partition("ExitCode=")[2][:1], self.logs())
        report = (self.folder / "d.slurm/report.log").read_text()
        self.assertIn(f"{RUNS} of {RUNS} runs done, 0 without a result", report)
        subprocess.run(
            [CAPSOC, "campaign", "run", "d.toml", "--store", "local.sqlite"],
            env=CLEAN,
            cwd=self.folder,
            check=True,
            capture_output=True,
        )
        self.assertEqual(rows_of(self.folder / "d.sqlite"), rows_of(self.folder / "local.sqlite"))


class Scripts(unittest.TestCase):
    """What needs no Slurm."""

    def test_scripts_and_a_missing_sbatch(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "d.toml").write_text(DRAWN.format(runs=20))

            def slurm(*options, **environment):
                return subprocess.run(
                    [CAPSOC, "campaign", "slurm", "d.toml", "--tasks", "4", *options],
                    env={**CLEAN, **environment},
                    cwd=folder,
                    capture_output=True,
                    check=False,
                )

            process = slurm("--no-submit", "--sbatch", "--partition=long")
            self.assertEqual(process.returncode, 0, process.stderr)
            script = (Path(folder) / "d.slurm/array.sh").read_text()
            self.assertIn("#SBATCH --array=1-4\n", script)
            self.assertIn("#SBATCH --partition=long\n", script)
            process = slurm(
                "--no-submit",
                "--sbatch",
                "--comment=a b's",
                "--sbatch",
                "-p long",
                "--sbatch",
                '--mail-user="quoted by the user"',
            )
            self.assertEqual(process.returncode, 0, process.stderr)
            script = (Path(folder) / "d.slurm/array.sh").read_text()
            options = [
                word for line in script.splitlines() if line.startswith("#SBATCH ") for word in shlex.split(line[8:])
            ]
            for word in ("--comment=a b's", "-p", "long", "--mail-user=quoted by the user"):
                self.assertIn(word, options)
            process = slurm("--no-submit", "--sbatch", "--comment=a\nreboot")
            self.assertEqual(process.returncode, 2)
            self.assertIn("has more than one line", process.stderr.decode())
            slurm("--no-submit", "--sbatch", "--partition=long")
            for task in range(1, 5):  # any scheduler can do the same
                done = subprocess.run(
                    ["sh", "d.slurm/array.sh"],
                    env={**CLEAN, "SLURM_ARRAY_TASK_ID": str(task)},
                    cwd=folder,
                    capture_output=True,
                    check=False,
                )
                self.assertEqual(done.returncode, 0, done.stderr)
            (Path(folder) / "d.slurm/task-2.sqlite").unlink()
            done = subprocess.run(["sh", "d.slurm/last.sh"], env=CLEAN, cwd=folder, capture_output=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("20 of 20 runs done", done.stdout.decode())
            self.assertTrue((Path(folder) / "d.slurm/report.json").exists())
            process = slurm(PATH="/nonexistent")
            self.assertEqual(process.returncode, 2)
            self.assertIn("sbatch: there is no such program; install slurm-client", process.stderr.decode())


if __name__ == "__main__":
    unittest.main()
