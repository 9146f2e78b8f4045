"""What a job has given."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_STANDARD_ERROR = "#se"


@dataclass(frozen=True)
class Result:
    """A job that is done. Its files stay in the worker's folder until `discard`, or for good if
    the folder is one's own."""

    #: The line of the worker's answer, with the fields of docs/batch.md.
    line: dict[str, Any]
    #: The worker's folder, which the paths of `line["files"]` start from.
    folder: Path

    @property
    def id(self) -> str:
        """The job's name."""
        return str(self.line["id"])

    @property
    def loss(self) -> float | None:
        """Of a backward job: the loss, or the sum of image times adjoint."""
        return self.line.get("loss")

    def path(self, key: str) -> Path:
        """Where the file is that the answer has under `key`, such as "image"."""
        files = self.line.get("files", {})
        if key not in files:
            there = ", ".join(files) or "none"
            asked = '; ask for it with outputs=["image.npy"]' if key == "image_npy" else ""
            raise KeyError(f"job {self.id} has no file {key!r}; it has {there}{asked}")
        return self.folder / str(files[key])

    def image(self) -> NDArray[np.float32]:
        """The image of a render job with `image.npy` among its outputs: (height, width, 3), linear
        RGB radiance."""
        return _array(self.path("image_npy"))

    def gradient(self) -> NDArray[np.float32]:
        """Of a forward job: the derivative of the image along the direction, (height, width, 3),
        in radiance per unit of the direction."""
        return _array(self.path("gradient"))

    def standard_error(self) -> NDArray[np.float32]:
        """Of a forward job: that of `gradient`, of the same shape and unit."""
        return _array(self.path("stderr"))

    def gradients(self) -> dict[str, NDArray[np.float32]]:
        """Of a backward job: the derivative of the loss by each parameter, of its shape, in loss
        per unit of the parameter."""
        return {k: v for k, v in self._archive().items() if not k.endswith(_STANDARD_ERROR)}

    def standard_errors(self) -> dict[str, NDArray[np.float32]]:
        """Of a backward job: those of `gradients`, by the same keys. Empty with `stderr=False`."""
        return {
            k.removesuffix(_STANDARD_ERROR): v
            for k, v in self._archive().items()
            if k.endswith(_STANDARD_ERROR)
        }

    def discard(self) -> None:
        """Removes the files of the job."""
        shutil.rmtree(self.folder / self.id, ignore_errors=True)

    def _archive(self) -> dict[str, NDArray[np.float32]]:
        with np.load(self.path("gradients_npz"), allow_pickle=False) as archive:
            return {key: archive[key] for key in archive.files}


def _array(path: Path) -> NDArray[np.float32]:
    array: NDArray[np.float32] = np.load(path, allow_pickle=False)
    return array
