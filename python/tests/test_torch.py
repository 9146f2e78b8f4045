"""PyTorch around the renderer, where it is installed."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import COLOUR, POSITION, SCENE
from error_bars import assert_equal_means

from warpath_worker import JobFailed, Renderer, Seeds, Worker

torch = pytest.importorskip("torch")

from warpath_worker.torch import render, render_views  # noqa: E402


def test_gradients_are_the_bytes_of_the_command(
    program: Path, view: Renderer, tmp_path: Path
) -> None:
    weight = torch.linspace(-1, 1, 40 * 48 * 3).reshape(40, 48, 3)
    np.save(tmp_path / "adjoint.npy", weight.numpy())
    arguments = f"backward {SCENE} --param {POSITION} --param {COLOUR} -o {tmp_path}"
    more = f"--adjoint {tmp_path}/adjoint.npy --resolution 48x40 --spp 16 --seed 5 --quiet"
    subprocess.run([program, *arguments.split(), *more.split()], check=True)
    position = torch.zeros(3, requires_grad=True)
    colour = torch.tensor([0.65, 0.63, 0.6], requires_grad=True)
    image = render(view, {POSITION: position, COLOUR: colour}, Seeds(image=4, derivative=5))
    assert image.shape == (40, 48, 3) and image.dtype == torch.float32
    assert (image.detach().numpy() == view.image({}, 4)).all()
    (image * weight).sum().backward()
    with np.load(tmp_path / "gradients.npz") as theirs:
        assert position.grad.numpy().tobytes() == theirs[POSITION].tobytes()
        assert colour.grad.numpy().tobytes() == theirs[COLOUR].tobytes()


def test_a_loss_of_ones_own_has_the_slope_of_its_differences(worker: Worker) -> None:
    """Through a network of PyTorch's before and a loss of its own after the renderer."""
    view = Renderer(worker, SCENE, resolution=[32, 32], spp=64)
    target = torch.from_numpy(view.image({POSITION: [0.15, 0, 0]}, 9))

    def loss(x: torch.Tensor, seeds: Seeds) -> torch.Tensor:
        position = torch.stack([x**2, torch.sin(x), 0 * x])
        image = render(view, {POSITION: position}, seeds)
        return ((image - target) ** 2).mean()

    at, step = 0.3, 0.03

    def slope(run: int) -> float:
        x = torch.tensor(at, requires_grad=True)
        loss(x, Seeds.of(1, run)).backward()
        return float(x.grad)

    def difference(run: int) -> float:
        with torch.no_grad():
            ends = [loss(torch.tensor(x), Seeds.of(2, run)) for x in (at + step, at - step)]
        return float(ends[0] - ends[1]) / 2 / step

    runs = range(24)
    assert_equal_means([slope(r) for r in runs], [difference(r) for r in runs], least_signal=10)


def test_several_views_are_added(worker: Worker) -> None:
    views = [Renderer(worker, SCENE, resolution=[w, 8], spp=4, stderr=False) for w in (8, 12)]
    seeds = [Seeds.of(3, 0), Seeds.of(3, 1)]
    together = torch.zeros(3, dtype=torch.float64, requires_grad=True)
    images = render_views(views, {POSITION: together}, seeds)
    assert [tuple(image.shape) for image in images] == [(8, 8, 3), (8, 12, 3)]
    (images[0].sum() + 2 * images[1].sum()).backward()
    parts = []
    for view, of_view in zip(views, seeds, strict=True):
        alone = torch.zeros(3, requires_grad=True)
        render(view, {POSITION: alone}, of_view).sum().backward()
        parts.append(alone.grad)
    assert together.grad.dtype == torch.float64
    assert torch.allclose(together.grad.float(), parts[0] + 2 * parts[1], rtol=1e-5)
    with pytest.raises(ValueError, match="2 views"):
        render_views(views, {POSITION: together}, seeds[:1])


def test_values_are_those_of_the_forward_pass(view: Renderer) -> None:
    def slope(change: float) -> torch.Tensor:
        position = torch.zeros(3, requires_grad=True)
        image = render(view, {POSITION: position}, Seeds.of(4, 0))
        with torch.no_grad():
            position += change
        image.sum().backward()
        return position.grad

    assert (slope(0.3) == slope(0.0)).all()


def test_only_what_is_asked_for_has_a_gradient(view: Renderer) -> None:
    position, colour = torch.zeros(3), torch.full((3,), 0.5, requires_grad=True)
    image = render(view, {POSITION: position, COLOUR: colour}, Seeds.of(5, 0))
    image.sum().backward()
    assert position.grad is None and (colour.grad > 0).all()
    assert not render(view, {POSITION: position}, Seeds.of(5, 0)).requires_grad


def test_derivatives_of_gradients_are_refused(view: Renderer) -> None:
    colour = torch.full((3,), 0.5, requires_grad=True)
    image = render(view, {COLOUR: colour}, Seeds.of(6, 0))
    (slope,) = torch.autograd.grad((image**2).sum(), colour, create_graph=True)
    with pytest.raises(RuntimeError, match="once_differentiable"):
        slope.sum().backward()


def test_failures_come_through(worker: Worker) -> None:
    with pytest.raises(JobFailed, match="nowhere.xml"):
        render(Renderer(worker, "nowhere.xml"), {}, Seeds.of(7, 0))
    wrong = torch.zeros(2, requires_grad=True)
    with pytest.raises(JobFailed, match=POSITION):
        render(Renderer(worker, SCENE), {POSITION: wrong}, Seeds.of(7, 0))
    # Too many for a difference each: told in the backward pass.
    slow = Renderer(worker, SCENE, resolution=[8, 8], spp=4, method="fd")
    vertices = torch.rand(4000, 3, requires_grad=True)
    image = render(slow, {"occluder.vertex_positions": vertices}, Seeds.of(7, 0))
    with pytest.raises(JobFailed, match="each of 12000 numbers"):
        image.sum().backward()


def test_an_optimiser_of_torch_finds_the_truth_in_twenty_steps(worker: Worker) -> None:
    view = Renderer(worker, SCENE, resolution=[32, 32], spp=16, stderr=False)
    truth = torch.tensor([0.35, 0.5, 0.65])
    target = torch.from_numpy(
        Renderer(worker, SCENE, resolution=[32, 32], spp=4096).image({COLOUR: truth.numpy()}, 8)
    )

    def found(run: int) -> np.ndarray:
        colour = torch.full((3,), 0.5, requires_grad=True)
        optimizer = torch.optim.SGD([colour], lr=6)
        for step in range(20):
            optimizer.zero_grad()
            image = render(view, {COLOUR: colour}, Seeds.of(run, step))
            ((image - target) ** 2).mean().backward()
            optimizer.step()
        return colour.detach().numpy()

    assert_equal_means([found(run) for run in range(6)], [truth.numpy()] * 6, least_signal=50)
