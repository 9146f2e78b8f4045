"""What all tests share: the program, a worker, and scenes of a second or less."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from warpath_worker import Renderer, Worker

REPOSITORY = Path(__file__).parents[2]
SCENE = REPOSITORY / "scenes" / "demo.xml"
POSITION = "occluder.translation"
COLOUR = "floor.bsdf.reflectance.value"


@pytest.fixture(scope="session")
def program() -> Path:
    """WARPATH, or what `cargo build --release` has made."""
    path = Path(os.environ.get("WARPATH", REPOSITORY / "target" / "release" / "warpath"))
    assert path.exists(), f"{path}: build it with `cargo build --release`, or set WARPATH"
    return path.absolute()


@pytest.fixture(scope="module")
def worker(program: Path) -> Iterator[Worker]:
    with Worker(program) as worker:
        yield worker


@pytest.fixture
def view(worker: Worker) -> Renderer:
    """48 by 40 pixels, so that no side is taken for the other."""
    return Renderer(worker, SCENE, resolution=[48, 40], spp=16)
