"""Means with error bars."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray


def mean_and_error(runs: Sequence[ArrayLike]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The mean of independent runs, and its standard error."""
    stacked = np.stack([np.asarray(run, np.float64) for run in runs])
    return stacked.mean(axis=0), stacked.std(axis=0, ddof=1) / np.sqrt(len(runs))


def assert_equal_means(
    one: Sequence[ArrayLike], other: Sequence[ArrayLike], least_signal: float
) -> None:
    """Two sets of runs have the same mean: 4 standard errors are allowed, and the error must be
    `least_signal` times smaller than the mean's norm, or the test would tell nothing."""
    (a, a_error), (b, b_error) = mean_and_error(one), mean_and_error(other)
    error = np.hypot(a_error, b_error)
    assert np.linalg.norm(b) > least_signal * np.linalg.norm(error), (b, error)
    assert (np.abs(a - b) < 4 * error).all(), (a, b, error)
