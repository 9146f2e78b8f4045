"""Gradients against finite differences, and what they find. NumPy alone."""

from __future__ import annotations

import numpy as np
from conftest import COLOUR, POSITION, SCENE
from error_bars import assert_equal_means, mean_and_error

from warpath_worker import Renderer, Seeds, Worker


def test_gradients_are_those_of_finite_differences(view: Renderer) -> None:
    """Of a linear function of the image, whose derivative by it has no noise."""
    adjoint = np.random.default_rng(2).uniform(0.5, 1.5, (40, 48, 3)).astype(np.float32)
    adjoint[:, :24] *= -1
    step = 0.02

    def difference(seed: int) -> float:
        # Common random numbers.
        above, below = (view.submit_image({POSITION: [x, 0, 0]}, seed) for x in (step, -step))
        return float(((above.result() - below.result()) * adjoint).sum(dtype=np.float64)) / 2 / step

    def slope(seed: int) -> float:
        return float(view.gradients({POSITION: np.zeros(3)}, adjoint, seed).values[POSITION][0])

    runs = range(24)
    slopes = [slope(100 + seed) for seed in runs]
    assert_equal_means(slopes, [difference(seed) for seed in runs], least_signal=10)


def test_independent_seeds_make_the_gradient_of_a_loss_unbiased(worker: Worker) -> None:
    """The squared error at its minimum, at few samples: with seeds of its own the gradient is zero
    but for noise, with the image's seed it is that of the image's variance."""
    view = Renderer(worker, SCENE, resolution=[24, 24], spp=4, stderr=False)
    colour = np.array([0.65, 0.63, 0.6])
    truth = Renderer(worker, SCENE, resolution=[24, 24], spp=4096).image({}, 1000)

    def slope(seeds: Seeds) -> np.ndarray:
        image = view.image({COLOUR: colour}, seeds.image)
        adjoint = 2 * (image - truth) / image.size
        return view.gradients({COLOUR: colour}, adjoint, seeds.derivative).values[COLOUR]

    runs = range(80)
    independent, error = mean_and_error([slope(Seeds.of(0, run)) for run in runs])
    biased, biased_error = mean_and_error([slope(Seeds.same(0, run)) for run in runs])
    assert (np.abs(independent) < 4 * error).all(), (independent, error)
    assert (biased > 5 * biased_error).all(), (biased, biased_error)


def test_twenty_steps_find_the_truth(worker: Worker) -> None:
    """A colour and a position, from a picture made with others."""
    view = Renderer(worker, SCENE, resolution=[32, 32], spp=16)
    truth = {COLOUR: np.array([0.2, 0.5, 0.8]), POSITION: np.array([0.1, 0, 0])}
    target = Renderer(worker, SCENE, resolution=[32, 32], spp=4096).image(truth, 2000)

    def found(run: int) -> np.ndarray:
        values = {COLOUR: np.full(3, 0.5), POSITION: np.zeros(3)}
        for step in range(20):
            seeds = Seeds.of(run, step)
            image = view.image(values, seeds.image)
            slopes = view.gradients(values, 2 * (image - target) / image.size, seeds.derivative)
            values[COLOUR] = values[COLOUR] - 6 * slopes.values[COLOUR]
            # Along the first axis alone: down and back the picture hardly changes.
            values[POSITION] = values[POSITION] - [2 * slopes.values[POSITION][0], 0, 0]
        return np.append(values[COLOUR], values[POSITION][0])

    mean, error = mean_and_error([found(run) for run in range(6)])
    expected = np.append(truth[COLOUR], truth[POSITION][0])
    start = np.array([0.5, 0.5, 0.5, 0])
    print(mean, error)
    assert np.linalg.norm(start - expected) > 50 * np.linalg.norm(error), error
    assert (np.abs(mean - expected) < 4 * error).all(), (mean, error)
