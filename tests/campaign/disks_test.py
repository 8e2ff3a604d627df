#!/usr/bin/env python3
"""Stores on disks without shared memory, without locks, and on those that may only be read; sqlite3 is the oracle."""

import contextlib
import errno
import os
import signal
import sqlite3
import subprocess
import time
import unittest
from pathlib import Path

from campaign_test import DRAWN

from harness import CAPSOC, CLEAN, Case

CTEST = {"name": "campaign: other disks", "whole": True}


class Disks(Case):
    def setUp(self):
        super().setUp()
        self.folder.chmod(0o755)
        (self.folder / "d.toml").write_text(DRAWN.format(runs=20))
        subprocess.run(
            [
                "cc",
                "-shared",
                "-fPIC",
                "-w",
                Path(__file__).with_name("no_shared_memory.c"),
                "-o",
                self.folder / "disk.so",
                "-ldl",
            ],
            check=True,
        )

    def campaign(self, *words, code=0, **disk):
        environment = {**CLEAN, **({"LD_PRELOAD": str(self.folder / "disk.so")} if disk else {}), **disk}
        done = subprocess.run(
            [CAPSOC, "campaign", *words],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            timeout=100,
            check=False,
        )
        self.assertEqual(done.returncode, code, done.stderr.decode())
        return (done.stdout + done.stderr).decode()

    def ask(self, name, question):
        with contextlib.closing(sqlite3.connect(self.folder / name)) as store:
            return store.execute(question).fetchone()[0]

    def test_without_shared_memory(self):
        self.campaign("run", "d.toml", "--store", "a.sqlite", NOSHM="1")
        self.assertEqual(self.ask("a.sqlite", "PRAGMA journal_mode"), "delete")
        self.assertEqual(self.ask("a.sqlite", "PRAGMA integrity_check"), "ok")
        self.assertEqual(self.ask("a.sqlite", "SELECT count(*) FROM runs"), 20)
        self.assertIn("20 of 20 runs done", self.campaign("report", "a.sqlite", NOSHM="1"))

    def test_a_store_from_another_disk(self):
        self.campaign("run", "d.toml", "--store", "a.sqlite")
        self.assertEqual(self.ask("a.sqlite", "PRAGMA journal_mode"), "wal")
        self.assertIn("20 of 20 runs done", self.campaign("report", "a.sqlite", NOSHM="1"))
        self.campaign("resume", "a.sqlite", NOSHM="1")
        self.assertEqual(self.ask("a.sqlite", "PRAGMA journal_mode"), "delete")
        self.campaign("resume", "a.sqlite")
        self.assertEqual(self.ask("a.sqlite", "PRAGMA journal_mode"), "wal")

    def test_without_locks(self):
        self.campaign("run", "d.toml", "--store", "a.sqlite")
        for number in (errno.ENOLCK, errno.EOPNOTSUPP):
            said = self.campaign("run", "d.toml", "--store", "b.sqlite", code=2, NOLOCK=str(number))
            self.assertEqual(
                said,
                f"capsoc: b.sqlite: its file system has no locks ({os.strerror(number)}); "
                "name a store on another disk\n",
            )
            self.assertIn("20 of 20 runs done", self.campaign("report", "a.sqlite", NOLOCK=str(number)))

    def test_what_a_killed_campaign_left_without_shared_memory(self):
        (self.folder / "d.toml").write_text(DRAWN.format(runs=4000))
        process = subprocess.Popen(
            [CAPSOC, "campaign", "run", "d.toml", "--store", "a.sqlite", "--jobs", "1"],
            cwd=self.folder,
            env=CLEAN,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        time.sleep(3)
        process.send_signal(signal.SIGKILL)
        process.wait()
        (self.folder / "a.sqlite-shm").unlink(missing_ok=True)
        done = subprocess.run(
            [CAPSOC, "campaign", "report", "a.sqlite"],
            cwd=self.folder,
            capture_output=True,
            timeout=100,
            check=False,
            env={**CLEAN, "LD_PRELOAD": str(self.folder / "disk.so"), "NOLOCK": str(errno.ENOLCK)},
        )
        said = done.stdout.decode()
        done = int(said[: said.index(" of 4000 runs done")].split()[-1])
        self.assertGreater(done, 0)
        self.assertEqual(done, self.ask("a.sqlite", "SELECT count(*) FROM runs"))


if __name__ == "__main__":
    unittest.main()
