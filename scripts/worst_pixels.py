#!/usr/bin/env python3
"""How much of the difference between gradient images and their reference lies in few pixels.

    python3 scripts/worst_pixels.py REFERENCE.npy GRADIENT.npy GRADIENT.npy ... [--pixels 20]

The gradients are `gradient.npy` of runs with different seeds, which are averaged. Bias is the root of the mean squared difference less the
average's own variance, relative to the reference's RMS. Needs NumPy.
"""

import argparse

import numpy as np


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("reference")
    parser.add_argument("gradients", nargs="+")
    parser.add_argument("--pixels", type=int, default=20)
    arguments = parser.parse_args()
    reference = np.load(arguments.reference)
    runs = np.stack([np.load(path) for path in arguments.gradients])
    mean = runs.mean(0)
    variance = runs.var(0, ddof=1) / len(runs)
    rms = np.sqrt((reference**2).mean())

    def bias(where):
        square = ((mean - reference)[where] ** 2).mean() - variance[where].mean()
        return np.sign(square) * np.sqrt(abs(square)) / rms

    square = ((mean - reference) ** 2).sum(2)
    worst = np.argsort(-square, axis=None)[: arguments.pixels]
    rest = np.ones(square.shape, bool)
    rest.flat[worst] = False
    print(f"bias {bias(slice(None)):+.4f}, of which {square.flat[worst].sum() / square.sum():.0%} of the square "
          f"in {len(worst)} of {square.size} pixels; without them {bias(rest):+.4f}")
    print("row column | average | reference (red)")
    for k in worst:
        y, x = np.unravel_index(k, square.shape)
        print(f"{y:4} {x:4} | {mean[y, x, 0]:9.3f} | {reference[y, x, 0]:9.3f}")


if __name__ == "__main__":
    main()
