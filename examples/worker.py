#!/usr/bin/env python3
"""Gradients from a persistent warpath worker, as NumPy arrays. Needs NumPy and nothing beyond the standard library.

    python3 examples/worker.py target/release/warpath scenes/demo.xml occluder.translation

moves the object of the key, step by step, to where the picture looks like that of the scene as it is. Scripts of your
own can import Worker and gradient.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np


class Worker:
    """A `warpath batch -` process: scenes stay loaded between jobs, and jobs sent together run beside each other."""

    def __init__(self, warpath="warpath", folder=None, options=()):
        # Results are files; a folder in memory (/dev/shm) saves the disk's time.
        self.temporary = None if folder else tempfile.TemporaryDirectory()
        self.folder = Path(folder or self.temporary.name)
        command = [warpath, "batch", "-", "-o", str(self.folder), "--quiet", *options]
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True)
        self.count = 0

    def send(self, **job):
        """Sends a job and returns its id; arrays become lists. Its result comes when it is done: see `receive`."""
        self.count += 1
        job.setdefault("id", f"job-{self.count}")
        self.process.stdin.write(json.dumps(job, default=lambda array: array.tolist()) + "\n")
        self.process.stdin.flush()
        return job["id"]

    def receive(self):
        """The next result that is done, which need not be the next sent. A failed job is an exception."""
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(f"warpath ended with code {self.process.wait()}")
        result = json.loads(line)
        if result["status"] != "ok":
            raise RuntimeError(f"{result['id']}: {result['message']}")
        return result

    def run(self, **job):
        """Sends one job and waits for it; no other may be under way."""
        self.send(**job)
        return self.receive()

    def array(self, result, key):
        """The .npy file that a result has under `key` (gradient, stderr)."""
        return np.load(self.folder / result["files"][key])

    def gradients(self, result):
        """The gradients of a backward job by parameter; standard errors under KEY#se."""
        with np.load(self.folder / result["files"]["gradients_npz"]) as archive:
            return {key: archive[key] for key in archive.files}

    def close(self):
        """Lets the worker finish what it has, and ends it."""
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
        if self.temporary:
            self.temporary.cleanup()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def main(warpath, scene, key, steps=20):
    common = {"scene": scene, "resolution": [64, 64], "spp": 16}
    with Worker(warpath) as worker:
        target = worker.run(mode="render", **common, seed=1000)
        target = worker.folder / target["files"]["image"]
        position = np.array([0.2, 0.0, 0.1])
        speed = None
        for step in range(steps):
            result = worker.run(
                mode="backward", set={key: position}, params=[key], target=str(target),
                outputs=["gradients.npz"], seed=step, **common,
            )
            slope = worker.gradients(result)[key]
            # The first step is a tenth of the way; Polyak's rule for a minimum near zero would overshoot the noise.
            speed = speed or 0.04 / np.linalg.norm(slope)
            position = position - speed * slope
            print(f"step {step}: loss {result['loss']:.3e}, {key} {np.round(position, 4)}")
    return position


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
