"""One view of a scene as a function of some of its parameters."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .result import Result
from .worker import Worker

T = TypeVar("T")


@dataclass(frozen=True)
class Gradients:
    """The derivatives of a loss by parameters, and their standard errors, in loss per unit of the
    parameter and of its shape. Without standard errors that dictionary is empty."""

    values: dict[str, NDArray[np.float32]]
    standard_errors: dict[str, NDArray[np.float32]]


class Renderer:
    """Images of a view of a scene, and gradients of whatever is computed from them.

    `spp` are the camera paths per pixel of images and `gradient_spp` (default: as many) those of
    gradients. `set` are values that stay as they are. `fields` are more of a job's (docs/batch.md):
    `sensor`, `resolution` (width, height), `max_depth`, `defines`, `groups`; and of gradients
    `method` and `stderr`.
    """

    _OF_GRADIENTS = ("method", "stderr")

    def __init__(
        self,
        worker: Worker,
        scene: str | os.PathLike[str],
        *,
        spp: int | None = None,
        gradient_spp: int | None = None,
        set: Mapping[str, ArrayLike] | None = None,
        **fields: Any,
    ) -> None:
        self.worker = worker
        self._set = dict(set or {})
        own = {k: v for k, v in fields.items() if k in self._OF_GRADIENTS}
        common = {k: v for k, v in fields.items() if k not in own}
        self._image = {"scene": scene, **common, **_given(spp=spp)}
        self._gradient = {"scene": scene, **common, **own, **_given(spp=gradient_spp or spp)}
        self._size: tuple[int, int] | None = None

    def submit_image(
        self, values: Mapping[str, ArrayLike], seed: int
    ) -> Future[NDArray[np.float32]]:
        """The image for these values, (height, width, 3), linear RGB radiance, once it is done."""
        return _then(
            self.worker.submit(
                mode="render",
                set={**self._set, **values},
                seed=seed,
                outputs=["image.npy"],
                **self._image,
            ),
            Result.image,
        )

    def submit_gradients(
        self,
        values: Mapping[str, ArrayLike],
        adjoint: ArrayLike,
        seed: int,
        keys: list[str] | None = None,
    ) -> Future[Gradients]:
        """The gradients of a loss by `keys` (default: those of `values`), once they are done.

        `adjoint` is the derivative of the loss by the image, (height, width, 3). For an unbiased
        gradient it comes from an image of another seed: see `Seeds`.
        """
        return _then(
            self.worker.submit(
                mode="backward",
                set={**self._set, **values},
                params=list(values) if keys is None else keys,
                adjoint=np.asarray(adjoint),
                seed=seed,
                outputs=["gradients.npz"],
                **self._gradient,
            ),
            lambda result: Gradients(result.gradients(), result.standard_errors()),
        )

    def image(self, values: Mapping[str, ArrayLike], seed: int) -> NDArray[np.float32]:
        """The same as `submit_image`, waited for."""
        return self.submit_image(values, seed).result()

    def gradients(
        self,
        values: Mapping[str, ArrayLike],
        adjoint: ArrayLike,
        seed: int,
        keys: list[str] | None = None,
    ) -> Gradients:
        """The same as `submit_gradients`, waited for."""
        return self.submit_gradients(values, adjoint, seed, keys).result()

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the image in pixels; found by a picture of one sample a pixel."""
        if self._size is None:
            fields = {**self._image, "spp": 1, "groups": 1, "outputs": ["image.npy"]}
            result = self.worker.run(mode="render", set=self._set, **fields)
            height, width, _ = result.image().shape
            result.discard()
            self._size = (width, height)
        return self._size


def _given(**fields: Any) -> dict[str, Any]:
    return {name: value for name, value in fields.items() if value is not None}


def _then(done: Future[Result], read: Callable[[Result], T]) -> Future[T]:
    """What `read` makes of a result, whose files it then removes."""
    future: Future[T] = Future()
    future.set_running_or_notify_cancel()

    def finish(done: Future[Result]) -> None:
        try:
            result = done.result()
            try:
                future.set_result(read(result))
            finally:
                result.discard()
        except BaseException as error:
            future.set_exception(error)

    done.add_done_callback(finish)
    return future
