"""Where the `warpath` program is."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from .errors import ProgramNotFound

VARIABLE = "WARPATH"
NAME = "warpath"


def find_program(program: str | os.PathLike[str] | None = None) -> Path:
    """The program's path: the one given, or else of the variable WARPATH, or else on the PATH."""
    if program is not None:
        return _checked(program, "program")
    named = os.environ.get(VARIABLE)
    if named:
        return _checked(named, f"the variable {VARIABLE}")
    found = shutil.which(NAME)
    if found is None:
        raise ProgramNotFound(
            f"there is no {NAME} on the PATH; build it with `cargo build --release` and give "
            f"program='target/release/{NAME}', or set {VARIABLE} to its path"
        )
    return Path(found).absolute()


def _checked(program: str | os.PathLike[str], source: str) -> Path:
    # A name without a folder is looked for on the PATH, as a shell would.
    found = shutil.which(os.fspath(program))
    if found is None:
        raise ProgramNotFound(f"{source}: {os.fspath(program)!r} is no program that can be run")
    return Path(found).absolute()
