"""The page that `pytest --capsoc-html FILE` writes: the results of all simulations, by `capsoc report`."""

from __future__ import annotations

import json
import subprocess
import tempfile
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional

from .errors import CapsocError
from .program import find_program

if TYPE_CHECKING:
    from .simulation import Simulation


class Pages:
    """Collects results while the tests run.

    program: as of Session. file: where the page goes, None for none. worker: of pytest-xdist; begins the page's name.
    """

    def __init__(self, program: Optional[str], file: Optional[str], worker: Optional[str] = None) -> None:
        self._program = program
        path = None if file is None else Path(file).resolve()
        self._file = path if path is None or worker is None else path.with_name(f"{worker}-{path.name}")
        self._results: list[tuple[str, dict[str, Any]]] = []

    @property
    def wanted(self) -> bool:
        """Whether a page will be written."""
        return self._file is not None

    def add(self, simulation: Simulation) -> None:
        """Ends a run that is still open and keeps its result."""
        if not self.wanted:
            return
        try:
            self._results.append((simulation.name, simulation.finish().data))
        except CapsocError:
            pass  # the session is lost: there is no result, and the test's own report says why

    def write(self) -> None:
        """Writes the page. A failure is a warning of pytest's: the tests have their outcome."""
        if self._file is None or not self._results:
            return
        with tempfile.TemporaryDirectory(prefix="capsoc-") as folder:
            names = []
            for number, (name, result) in enumerate(self._results, 1):
                names.append(f"{number:03}-{Path(name).stem}.json")
                Path(folder, names[-1]).write_text(json.dumps(result))
            command = [str(find_program(self._program)), "report", *names, "--html", str(self._file)]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            warnings.warn(f"--capsoc-html: {done.stderr.strip()}", stacklevel=1)
