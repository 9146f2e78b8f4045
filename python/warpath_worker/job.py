"""A job's line, and the files that its large arrays go to."""

from __future__ import annotations

import json
import os
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

# More numbers than this are a file.
_INLINE = 64

_FILES = ("scene", "adjoint", "target")


class Job:
    """A job with its arrays written: `text` is its line, without the end of the line.

    Large arrays become files in `inputs`, which `discard` removes once the job is done.
    """

    def __init__(self, fields: Mapping[str, Any], inputs: Path) -> None:
        self._inputs = inputs
        self._files: list[Path] = []
        try:
            plain = {name: self._field(name, value) for name, value in fields.items()}
            # The worker wants JSON proper, which has no NaN.
            self.text = json.dumps(plain, allow_nan=False)
        except BaseException:
            self.discard()
            raise

    def discard(self) -> None:
        """Removes the files that were written for the job."""
        for file in self._files:
            file.unlink(missing_ok=True)

    def _field(self, name: str, value: Any) -> Any:
        if name in _FILES:
            if isinstance(value, str | os.PathLike):
                return os.path.abspath(value)
            return self._write(_floats(name, value))
        if name in ("set", "params") and isinstance(value, Mapping):
            return {key: self._numbers(f"{name}: {key}", numbers) for key, numbers in value.items()}
        return value

    def _numbers(self, name: str, numbers: Any) -> Any:
        if isinstance(numbers, str | os.PathLike):
            return os.path.abspath(numbers)
        array = _floats(name, numbers)
        return array.tolist() if array.size <= _INLINE else self._write(array)

    def _write(self, array: NDArray[np.float32]) -> str:
        path = self._inputs / f"{uuid.uuid4().hex}.npy"
        self._files.append(path)
        np.save(path, array)
        return str(path)


def _floats(name: str, numbers: Any) -> NDArray[np.float32]:
    """In single precision, as the worker computes."""
    given = np.asarray(numbers)
    if given.dtype.kind not in "fiub":
        raise TypeError(f"{name}: real numbers are wanted, not {given.dtype}")
    with np.errstate(over="ignore"):
        array = np.ascontiguousarray(given, dtype=np.float32).reshape(given.shape)
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: a number is not finite in single precision")
    return array
