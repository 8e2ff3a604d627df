#!/usr/bin/env python3
"""What the program says that it is: version and commit."""

import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import BUILD, CAPSOC, Case, SOURCE

CTEST = {"name": "package: version", "whole": True}

CLEAN = {k: v for k, v in os.environ.items() if not k.startswith(("CAPSOC_", "GIT_"))}


def do(*command, cwd=None):
    return subprocess.run(
        [*map(str, command)], cwd=cwd, capture_output=True, text=True, timeout=60, check=True, env=CLEAN
    ).stdout


class Program(unittest.TestCase):
    def test_version_and_results_name_the_commit(self):
        header = next(BUILD.glob("**/generated/commit.h")).read_text()
        commit = re.search('CAPSOC_COMMIT "(.+)"', header)[1]
        version = re.search(r"VERSION (\d+\.\d+\.\d+)", (SOURCE / "CMakeLists.txt").read_text())[1]
        self.assertEqual(do(CAPSOC, "--version"), f"capsoc {version} (commit {commit})\n")
        with tempfile.TemporaryDirectory() as folder:
            do(CAPSOC, "run", BUILD / "firmware/hello.elf", "--json", "r.json", cwd=folder)
            versions = json.loads((Path(folder) / "r.json").read_text())["versions"]
        self.assertEqual((versions["capsoc"], versions["commit"]), (version, commit))


class Commit(Case):
    """cmake/commit.cmake in its own repositories."""

    def setUp(self):
        super().setUp()
        self.sources = self.folder / "sources"
        (self.sources / "part").mkdir(parents=True)
        (self.sources / "file").write_text("1\n")

    def git(self, *arguments):
        return do("git", "-C", self.sources, "-c", "user.name=a", "-c", "user.email=a@b", *arguments).strip()

    def repository(self):
        self.git("init", "-q")
        self.git("add", "file")
        self.git("commit", "-q", "-m", "first")

    def commit(self, sources=None):
        self.header = self.folder / "commit.h"
        do(
            "cmake",
            "-D",
            f"FOLDER={sources or self.sources}",
            "-D",
            f"OUTPUT={self.header}",
            "-P",
            SOURCE / "cmake/commit.cmake",
        )
        return re.search('CAPSOC_COMMIT "(.+)"', self.header.read_text())[1]

    def test_outside_git_it_is_unknown(self):
        self.assertEqual(self.commit(), "unknown")

    def test_inside_a_foreign_repository_it_is_unknown(self):
        self.repository()
        self.assertEqual(self.commit(self.sources / "part"), "unknown")

    def test_a_clean_checkout_is_its_commit(self):
        self.repository()
        self.assertEqual(self.commit(), self.git("rev-parse", "--short=12", "HEAD"))

    def test_a_link_to_the_checkout_is_the_checkout(self):
        self.repository()
        (self.folder / "link").symlink_to(self.sources)
        self.assertEqual(self.commit(self.folder / "link"), self.git("rev-parse", "--short=12", "HEAD"))

    def test_changes_are_told(self):
        self.repository()
        (self.sources / "file").write_text("2\n")
        self.assertRegex(self.commit(), r"^[0-9a-f]{12}-dirty$")

    def test_a_release_is_counted_from_its_tag(self):
        self.repository()
        self.git("tag", "-a", "v1.2.3", "-m", "release")
        self.assertEqual(self.commit(), "v1.2.3")
        self.git("commit", "-q", "--allow-empty", "-m", "second")
        self.assertRegex(self.commit(), r"^v1\.2\.3-1-g[0-9a-f]{12}$")

    def test_the_same_commit_leaves_the_header_alone(self):
        self.repository()
        self.commit()
        os.utime(self.header, (1, 1))
        self.commit()
        self.assertEqual(self.header.stat().st_mtime, 1)
        self.git("commit", "-q", "--allow-empty", "-m", "second")
        self.commit()
        self.assertNotEqual(self.header.stat().st_mtime, 1)


if __name__ == "__main__":
    unittest.main()
