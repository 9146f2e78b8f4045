"""Images that JAX differentiates.

from warpath_worker import Renderer, Worker
from warpath_worker.jax import renderer

with Worker() as worker:
    image = renderer(Renderer(worker, "scenes/demo.xml", spp=16))

    @jax.jit
    def loss(values, step):
        return ((image(values, step) - target) ** 2).mean()

    slope = jax.grad(loss)({"occluder.translation": jnp.zeros(3)}, 0)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .renderer import Renderer
from .seeds import Seeds

Values = Mapping[str, Any]


def renderer(
    view: Renderer,
    seed: int = 0,
    seeds: Callable[[int, int], Seeds] = Seeds.of,
    order: Sequence[str] | None = None,
) -> Callable[[Values, Any], Any]:
    """A function of parameter values by key and of a whole number, the step, to the image:
    float32, (height, width, 3), linear RGB.

    Every step has random numbers of its own: those of `seeds(seed, step)`, which are others for the
    image than for its derivative (see `Seeds` for why). The function is pure, may be compiled
    (`jax.jit`), and has a reverse mode (`jax.grad`, `jax.vjp`); not a forward mode. Under
    `jax.vmap` images are rendered one after the other.

    Values are set one after the other, which matters where one moves what another has put there
    (docs/batch.md). JAX keeps dictionaries sorted by key, so that is their order; `order` lists the
    keys in another.
    """
    width, height = view.size
    image_shape = jax.ShapeDtypeStruct((height, width, 3), jnp.float32)

    def ordered(values: Values) -> dict[str, np.ndarray[Any, Any]]:
        return {key: np.asarray(values[key]) for key in order or values}

    def render(values: Values, step: Any) -> Any:
        return view.image(ordered(values), seeds(seed, int(step)).image)

    def differentiate(values: Values, step: Any, adjoint: Any) -> Any:
        arrays = ordered(values)
        done = view.gradients(arrays, np.asarray(adjoint), seeds(seed, int(step)).derivative)
        return {key: done.values[key].astype(value.dtype) for key, value in arrays.items()}

    @jax.custom_vjp  # type: ignore[untyped-decorator]
    def image(values: Values, step: Any) -> Any:
        return jax.pure_callback(render, image_shape, values, step, vmap_method="sequential")

    def forward(values: Values, step: Any) -> Any:
        return image(values, step), (values, step)

    def backward(kept: Any, adjoint: Any) -> Any:
        values, step = kept
        shapes = {key: jax.ShapeDtypeStruct(v.shape, v.dtype) for key, v in values.items()}
        gradients = jax.pure_callback(
            differentiate, shapes, values, step, adjoint, vmap_method="sequential"
        )
        # What has no derivative has one of a type with no values.
        return gradients, np.zeros(jnp.shape(step), jax.dtypes.float0)

    image.defvjp(forward, backward)

    def of_arrays(values: Values, step: Any) -> Any:
        if order is not None and set(order) != set(values):
            raise ValueError(f"order lists {list(order)}, values are of {list(values)}")
        return image({key: jnp.asarray(value) for key, value in values.items()}, jnp.asarray(step))

    return of_arrays
