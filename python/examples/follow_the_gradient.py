"""Moves an object, step by step, to where the picture looks like that of the scene as it is.

python python/examples/follow_the_gradient.py scenes/demo.xml occluder.translation
"""

from __future__ import annotations

import sys

import numpy as np
from numpy.typing import NDArray

from warpath_worker import Renderer, Seeds, Worker


def main(scene: str, key: str, steps: int = 20) -> NDArray[np.float64]:
    """Where the object of the key, a `.translation`, ends, in world units."""
    with Worker() as worker:
        view = Renderer(worker, scene, resolution=[64, 64], spp=16)
        target = view.image({}, seed=1000)
        position = np.array([0.2, 0.0, 0.1])
        speed = None
        for step in range(steps):
            seeds = Seeds.of(0, step)
            difference = view.image({key: position}, seeds.image) - target
            adjoint = 2 * difference / difference.size
            gradients = view.gradients({key: position}, adjoint, seeds.derivative)
            slope = gradients.values[key]
            # The first step is of a fifth of the way.
            speed = speed or 0.04 / np.linalg.norm(slope)
            position = position - speed * slope
            print(
                f"step {step}: loss {(difference**2).mean():.3e}, {key} {np.round(position, 4)}, "
                f"slope {slope} ± {gradients.standard_errors[key]}"
            )
    return position


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
