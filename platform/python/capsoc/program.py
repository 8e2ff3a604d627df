"""Where the program `capsoc` and the firmware that comes with it are."""

from __future__ import annotations

import os
import shutil
from os import PathLike, fspath
from pathlib import Path
from typing import Optional, Union

from .errors import ProgramNotFound

Place = Union[str, PathLike[str]]


def find_program(program: Optional[Place] = None) -> Path:
    """The program: the argument, the environment variable CAPSOC, a file next to this package, or one on PATH.

    Raises ProgramNotFound. The argument and CAPSOC may also name the folder of a build or of an install tree.
    """
    for origin, named in (("program", program), ("the environment variable CAPSOC", os.environ.get("CAPSOC"))):
        if named:
            return _named(Path(fspath(named)), origin)
    for folder in list(Path(__file__).resolve().parents)[1:6]:
        for place in (folder / "bin" / "capsoc", folder / "build" / "capsoc"):
            if _is_program(place):
                return place
    if found := shutil.which("capsoc"):
        return Path(found).resolve()
    raise ProgramNotFound(
        "The program capsoc is neither next to this package nor on PATH. Build or install it, or name it by "
        "the environment variable CAPSOC."
    )


def _named(place: Path, origin: str) -> Path:
    for candidate in (place, place / "bin" / "capsoc", place / "capsoc"):
        if _is_program(candidate):
            return candidate.resolve()
    raise ProgramNotFound(
        f"{place}: is no program (named by {origin}). Name the file capsoc or the folder of its build."
    )


def _is_program(place: Path) -> bool:
    return place.is_file() and os.access(place, os.X_OK)


def find_firmware(elf: Place, program: Optional[Path]) -> str:
    """The absolute path of a program for the Cortex-M3.

    A name without a folder that is no file here is looked up in the firmware that comes with capsoc, with or without
    `.elf`. What is found nowhere is returned as it is: the session says what it misses.
    """
    name = fspath(elf)
    if os.path.isfile(name):
        return os.path.abspath(name)
    if program is not None and os.path.basename(name) == name:
        for folder in (program.parent / "firmware", program.parent.parent / "share" / "capsoc" / "firmware"):
            for candidate in (folder / name, folder / f"{name}.elf"):
                if candidate.is_file():
                    return str(candidate)
    return name
