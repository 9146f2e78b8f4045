"""What can be set and differentiated in a scene."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import WorkerError


@dataclass(frozen=True)
class Parameter:
    """A parameter of a scene, as `warpath params` lists it."""

    key: str
    shape: tuple[int, ...]
    differentiable: bool
    #: Whether it moves what hides what.
    moves_visibility: bool
    #: Its value in the scene, of its shape and in its unit; None for meshes and pictures, of which
    #: only the range is told.
    value: NDArray[np.float32] | None
    #: Other names of the same parameter.
    aliases: tuple[str, ...]


def list_parameters(
    program: Path,
    scene: str | os.PathLike[str],
    defines: Mapping[str, str | float | bool],
) -> dict[str, Parameter]:
    """All of a scene, by key."""
    command = [str(program), "params", os.fspath(scene), "--json", "--quiet"]
    for name, value in defines.items():
        text = str(value).lower() if isinstance(value, bool) else str(value)
        command += ["-D", f"{name}={text}"]
    done = subprocess.run(command, capture_output=True, encoding="utf-8", errors="replace")
    if done.returncode != 0:
        raise WorkerError(done.stderr.strip())
    return {row["key"]: _parameter(row) for row in json.loads(done.stdout)}


def _parameter(row: Mapping[str, Any]) -> Parameter:
    shape = tuple(row["shape"])
    value = row["value"]
    numbers = np.array(value, np.float32).reshape(shape) if isinstance(value, list) else None
    return Parameter(
        key=str(row["key"]),
        shape=shape,
        differentiable=bool(row["differentiable"]),
        moves_visibility=bool(row["moves_visibility"]),
        value=numbers,
        aliases=tuple(row["aliases"]),
    )
