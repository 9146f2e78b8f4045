"""JAX around the renderer, where it is installed."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import COLOUR, POSITION, SCENE
from error_bars import assert_equal_means

from warpath_worker import Renderer, Seeds, Worker

jax = pytest.importorskip("jax")
import jax.numpy as jnp  # noqa: E402

from warpath_worker.jax import renderer  # noqa: E402

HERE = {POSITION: jnp.zeros(3), COLOUR: jnp.array([0.65, 0.63, 0.6])}


@pytest.mark.parametrize("compiled", [False, True])
def test_gradients_are_the_bytes_of_the_command(
    program: Path, view: Renderer, tmp_path: Path, compiled: bool
) -> None:
    weight = np.linspace(-1, 1, 40 * 48 * 3, dtype=np.float32).reshape(40, 48, 3)
    np.save(tmp_path / "adjoint.npy", weight)
    seeds = Seeds.of(0, 7)
    arguments = f"backward {SCENE} --param {POSITION} --param {COLOUR} -o {tmp_path}"
    more = f"--adjoint {tmp_path}/adjoint.npy --resolution 48x40 --spp 16 --quiet"
    seed = ["--seed", str(seeds.derivative)]
    subprocess.run([program, *arguments.split(), *more.split(), *seed], check=True)
    image = renderer(view)
    slope = jax.grad(lambda values, step: (image(values, step) * weight).sum())
    if compiled:
        slope = jax.jit(slope)
    ours = slope(HERE, 7)
    assert (image(HERE, 7) == view.image({COLOUR: HERE[COLOUR]}, seeds.image)).all()
    with np.load(tmp_path / "gradients.npz") as theirs:
        for key in HERE:
            assert np.asarray(ours[key]).tobytes() == theirs[key].tobytes()


def test_a_loss_of_ones_own_has_the_slope_of_its_differences(worker: Worker) -> None:
    view = Renderer(worker, SCENE, resolution=[24, 24], spp=64)
    target = view.image({POSITION: [0.15, 0, 0]}, 9)
    image = renderer(view, seed=1)
    at, step = 0.3, 0.03

    @jax.jit
    def loss(x: jax.Array, run: jax.Array) -> jax.Array:
        position = jnp.stack([x**2, jnp.sin(x), 0 * x])
        return jnp.mean((image({POSITION: position}, run) - target) ** 2)

    slope = jax.jit(jax.grad(loss))
    runs = range(16)
    differences = [(loss(at + step, r) - loss(at - step, r)) / 2 / step for r in runs]
    assert_equal_means([slope(at, 100 + r) for r in runs], differences, least_signal=10)


def test_images_of_several_values_and_in_another_order(worker: Worker) -> None:
    view = Renderer(worker, SCENE, resolution=[8, 6], spp=4)
    image = renderer(view)
    shifts = jnp.array([[0.0, 0, 0], [0.3, 0, 0]])
    both = jax.vmap(lambda shift: image({POSITION: shift}, 0))(shifts)
    assert both.shape == (2, 6, 8, 3)
    for shift, one in zip(shifts, both, strict=True):
        assert (one == image({POSITION: shift}, 0)).all()
    # A whole mesh set after a shift undoes it; set before, it is shifted.
    mesh = "occluder.vertex_positions"
    tangle = jnp.asarray(np.random.default_rng(3).normal(size=(4000, 3)), jnp.float32)
    values = {POSITION: shifts[1], mesh: tangle}
    seed = Seeds.of(0, 0).image
    shifted, unshifted = (
        view.image({key: values[key] for key in order}, seed)
        for order in ((mesh, POSITION), (POSITION, mesh))
    )
    assert (shifted != unshifted).any()
    assert (renderer(view, order=[mesh, POSITION])(values, 0) == shifted).all()
    assert (renderer(view, order=[POSITION, mesh])(values, 0) == unshifted).all()
    with pytest.raises(ValueError, match="order"):
        renderer(view, order=[mesh])(values, 0)


def test_failures_come_through(worker: Worker) -> None:
    image = renderer(Renderer(worker, SCENE, resolution=[8, 6], spp=4))
    with pytest.raises(Exception, match="occluder.translation"):
        jax.block_until_ready(image({"occlude.translation": jnp.zeros(3)}, 0))
