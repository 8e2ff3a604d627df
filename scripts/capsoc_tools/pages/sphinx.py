"""Runs Sphinx over the pages of a tree; its warnings are faults."""

import importlib.util
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from capsoc_tools import ROOT
from capsoc_tools.pages.staging import Faults, Pages

CONFIGURATION = Path(__file__).parent
NEEDED = {
    "sphinx": "python3-sphinx",
    "myst_parser": "python3-myst-parser",
    "sphinx_rtd_theme": "python3-sphinx-rtd-theme",
}
#: The book's pages have no navigation, and a style for paper.
OPTIONS = {"html": [], "book": ["-D", "html_theme=basic", "-D", "html_css_files=book.css"]}
#: The same bytes from every run: no order of a set by a random seed, no date, no locale.
ENVIRONMENT = {
    "PYTHONPATH": str(ROOT / "scripts"),
    "PYTHONHASHSEED": "0",
    "PYTHONDONTWRITEBYTECODE": "1",
    "SOURCE_DATE_EPOCH": "0",
    "LC_ALL": "C.UTF-8",
}


def missing():
    """Why no site can be made here, or None."""
    for module, package in NEEDED.items():
        if importlib.util.find_spec(module) is None:
            return f"{package} is not installed; install the packages of scripts/packages.txt: ./scripts/setup test"
    return None


def version(top):
    return re.search(r"project\(capsoc VERSION (\S+)", (top / "CMakeLists.txt").read_text(encoding="utf-8"))[1]


def build(top, builder, folder):
    """Writes what a builder of Sphinx makes ("html", "book") into a folder that does not exist yet. Raises Faults."""
    top = Path(top).resolve()
    with tempfile.TemporaryDirectory(prefix="capsoc-site-") as temporary:
        sources = Path(temporary).resolve() / "sources"
        sources.mkdir()
        Pages(top).write(sources)
        command = [sys.executable, "-m", "sphinx", "-q", "-b", builder, "-c", CONFIGURATION, "-d", f"{temporary}/trees"]
        release = version(top)
        command += ["-D", f"version={release}", "-D", f"release={release}", "-D", f"html_title=capsoc {release}"]
        command += [*OPTIONS[builder], sources, folder]
        done = subprocess.run(
            [*map(str, command)],
            env={**os.environ, **ENVIRONMENT},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
        said = re.sub(r"\x1b\[[\d;]*m", "", done.stderr).replace(f"{sources}/", "").strip()
        # Sphinx 8 takes MyST's file for the name of a page.
        said = said.replace(".md.rst:", ".md:")
        if said or done.returncode != 0:
            raise Faults(said.splitlines() or [f"Sphinx ended with status {done.returncode}"])
    (folder / ".buildinfo").unlink(missing_ok=True)  # for Sphinx's next run into the folder, of which there is none
