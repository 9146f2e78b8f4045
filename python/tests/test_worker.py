"""Jobs and their answers, and workers that die. NumPy alone."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import as_completed
from pathlib import Path

import numpy as np
import pytest
from conftest import COLOUR, POSITION, SCENE

from warpath_worker import (
    JobFailed,
    ProgramNotFound,
    Renderer,
    Worker,
    WorkerDied,
    WorkerError,
    find_program,
)

SMALL = {"scene": SCENE, "resolution": [16, 12], "spp": 4}


def test_the_program_is_the_one_given_or_of_the_environment_or_on_the_path(
    program: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("on_path", "in_variable"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "warpath").symlink_to(program)
    monkeypatch.delenv("WARPATH", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path / "empty"))
    with pytest.raises(ProgramNotFound, match="set WARPATH"):
        find_program()
    monkeypatch.setenv("PATH", str(tmp_path / "on_path"))
    assert find_program() == tmp_path / "on_path" / "warpath"
    monkeypatch.setenv("WARPATH", str(tmp_path / "in_variable" / "warpath"))
    assert find_program() == tmp_path / "in_variable" / "warpath"
    assert find_program(program) == program
    with pytest.raises(ProgramNotFound, match="nowhere"):
        find_program(tmp_path / "nowhere")
    monkeypatch.setenv("WARPATH", str(tmp_path / "gone"))
    with pytest.raises(ProgramNotFound, match="the variable WARPATH"):
        find_program()


def test_results_are_arrays(worker: Worker) -> None:
    image = worker.run(mode="render", outputs=["image.npy"], **SMALL).image()
    assert (image.shape, image.dtype) == ((12, 16, 3), np.float32)
    assert image.min() >= 0 and image.max() > 0
    forward = worker.run(mode="forward", params={POSITION: np.array([1, 0, 0])}, **SMALL)
    assert forward.gradient().shape == forward.standard_error().shape == (12, 16, 3)
    assert (forward.standard_error() > 0).any()
    backward = worker.run(mode="backward", params=[POSITION, COLOUR], target=image + 1, **SMALL)
    assert backward.gradients().keys() == backward.standard_errors().keys() == {POSITION, COLOUR}
    # All that the target is too bright by, as the picture is the same but for its noise.
    assert backward.loss == pytest.approx(1, rel=0.5)
    backward.discard()
    assert not (worker.folder / backward.id).exists()


def test_gradients_are_those_of_the_command(program: Path, worker: Worker, tmp_path: Path) -> None:
    adjoint = np.random.default_rng(1).normal(size=(12, 16, 3)).astype(np.float32)
    np.save(tmp_path / "adjoint.npy", adjoint)
    arguments = (
        f"backward {SCENE} --param {POSITION} --param occluder.vertex_positions -o {tmp_path}"
    )
    more = f"--adjoint {tmp_path}/adjoint.npy --resolution 16x12 --spp 4 --seed 5 --quiet"
    subprocess.run([program, *arguments.split(), *more.split()], check=True)
    keys = [POSITION, "occluder.vertex_positions"]
    done = worker.run(mode="backward", params=keys, adjoint=adjoint, seed=5, **SMALL)
    ours, theirs = done.path("gradients_npz"), tmp_path / "gradients.npz"
    assert ours.read_bytes() == theirs.read_bytes()


def test_values_reach_the_scene_inline_and_by_file(worker: Worker) -> None:
    def image(**values: object) -> np.ndarray:
        job = {"mode": "render", "outputs": ["image.npy"], "set": values, "seed": 3, **SMALL}
        return worker.run(**job).image()

    at = worker.parameters(SCENE)[COLOUR].value
    assert at is not None
    assert (image(**{COLOUR: at}) == image()).all()
    assert (image(**{COLOUR: at / 2}) != image()).any()
    # 4000 vertices go by a file, which is gone afterwards.
    collapsed = np.zeros((4000, 3), np.float32)
    assert (image(**{"occluder.vertex_positions": collapsed}) != image()).any()
    assert not list((Path(worker._temporary.name) / "inputs").iterdir())


def test_parameters_are_listed(worker: Worker) -> None:
    listed = worker.parameters(SCENE, {"res": 8})
    assert listed[POSITION].differentiable and listed[POSITION].moves_visibility
    assert listed[COLOUR].value == pytest.approx([0.65, 0.63, 0.6])
    assert listed["occluder.vertex_positions"].shape == (4000, 3)
    with pytest.raises(WorkerError, match="nowhere.xml"):
        worker.parameters("nowhere.xml")


def test_many_jobs_are_under_way_and_each_has_its_own_answer(worker: Worker) -> None:
    # More than the worker reads ahead, and more than the pipes hold.
    colours = np.linspace(0, 1, 300)
    job = {"scene": SCENE, "resolution": [2, 2], "spp": 1, "outputs": ["image.npy"]}
    futures = {
        worker.submit(mode="render", set={COLOUR: np.full(3, c)}, seed=1, **job): c for c in colours
    }
    brightness = {futures[done]: done.result().image().sum() for done in as_completed(futures)}
    sums = np.array([brightness[c] for c in colours])
    # With one seed, the image is linear in the colour where paths have one bounce.
    assert np.allclose(sums, sums[0] + (sums[-1] - sums[0]) * colours, rtol=1e-5)
    assert sums[-1] > 1.5 * sums[0]


@pytest.mark.parametrize(
    ("fields", "code", "part"),
    [
        ({"mode": "forward"}, 3, "params"),
        ({"mode": "render", "scene": "nowhere.xml"}, 3, "nowhere.xml"),
        ({"mode": "render", "colour": 1}, 3, "colour"),
        ({"mode": "render", "set": {"occlude.translation": [0, 0, 1]}}, 3, "occluder.translation"),
        ({"mode": "render", "set": {POSITION: np.zeros((2, 3))}}, 3, POSITION),
        ({"mode": "render", "set": {"occluder.vertex_positions": np.zeros((7, 3))}}, 3, "4000"),
        ({"mode": "backward", "params": [POSITION], "target": np.zeros((2, 2, 3))}, 3, "16x12"),
        ({"mode": "render", "outputs": ["image.tiff"]}, 3, "image.npy"),
        ({"mode": "render", "id": "../out"}, 3, "id"),
    ],
)
def test_bad_jobs_fail_with_the_workers_words_and_it_goes_on(
    worker: Worker, fields: dict, code: int, part: str
) -> None:
    with pytest.raises(JobFailed) as failure:
        worker.run(**{**SMALL, **fields})
    assert failure.value.code == code
    assert part in str(failure.value)
    worker.run(mode="render", **SMALL)


def test_what_is_no_number_is_refused_before_it_is_sent(worker: Worker) -> None:
    for value, error in (
        (np.array([np.nan, 0, 0]), ValueError),
        (np.full(3, 1e39), ValueError),
        (np.zeros(3, complex), TypeError),
        (np.array(["a"]), TypeError),
    ):
        with pytest.raises(error, match=POSITION):
            worker.submit(mode="render", set={POSITION: value}, **SMALL)
    with pytest.raises(ValueError):
        worker.submit(mode="render", seed=float("nan"), **SMALL)
    with pytest.raises(TypeError):
        worker.submit(mode="render", seed=object(), **SMALL)
    # Lines are counted as they are sent: what was not sent confuses no later answer.
    worker.run(mode="render", **SMALL)


def test_a_worker_that_dies_is_noticed(program: Path) -> None:
    slow = {"mode": "render", "scene": SCENE, "spp": 1 << 14}
    with Worker(program) as worker:
        jobs = [worker.submit(**slow) for _ in range(3)]
        time.sleep(0.5)
        os.kill(worker._process.pid, signal.SIGKILL)
        for job in jobs:
            with pytest.raises(WorkerDied, match="signal 9") as death:
                job.result(timeout=20)
            assert death.value.code == -signal.SIGKILL
        with pytest.raises(WorkerDied, match="signal 9"):
            worker.submit(**slow)


def test_a_worker_that_cannot_start_says_why(program: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with Worker(program, folder=tmp_path / "file") as worker:
        with pytest.raises(WorkerDied, match="file"):
            worker.run(mode="render", **SMALL)
    with Worker(program, options=["--no-such-option"]) as worker:
        with pytest.raises(WorkerDied, match="no-such-option") as death:
            worker.run(mode="render", **SMALL)
        assert death.value.code == 2
    other = tmp_path / "warpath"
    other.write_text("#!/bin/sh\nread line; echo hello; exec sleep 60\n")
    other.chmod(0o755)
    with Worker(other) as worker:
        with pytest.raises(WorkerDied, match="no worker: it answered 'hello'"):
            worker.run(mode="render", **SMALL)


def test_the_end_of_the_block_is_the_end_of_the_worker(program: Path, tmp_path: Path) -> None:
    with Worker(program) as worker:
        job = worker.submit(mode="render", outputs=["image.npy"], **SMALL)
        folder = worker.folder
    assert job.done() and job.exception() is None, "what was submitted is finished"
    assert worker._process.poll() == 0
    assert not folder.exists()
    with pytest.raises(WorkerDied, match="closed"):
        worker.submit(mode="render", **SMALL)

    with Worker(program, folder=tmp_path / "kept") as worker:
        job = worker.submit(mode="render", id="mine", outputs=["image.npy"], **SMALL)
    assert job.result().image().shape == (12, 16, 3)
    assert (tmp_path / "kept" / "mine" / "image.npy").exists()

    # A second worker adds to what the first has left there; the same job is another result of it.
    seen = set()
    for _ in range(2):
        with Worker(program, folder=tmp_path / "kept") as worker:
            result = worker.run(mode="render", outputs=["image.npy"], **SMALL)
            done = worker.run(mode="render", id="mine", outputs=["image.npy"], **SMALL)
        assert done.id == "mine"
        assert result.image().shape == (12, 16, 3)
        seen.add(result.id)
    assert len(seen) == 2
    assert len((tmp_path / "kept" / "results.jsonl").read_text().splitlines()) == 3

    began = time.monotonic()
    with pytest.raises(RuntimeError, match="mine"):
        with Worker(program) as worker:
            job = worker.submit(mode="render", scene=SCENE, spp=1 << 20)
            raise RuntimeError("mine")
    assert time.monotonic() - began < 20, "hours of rendering are not waited for"
    assert isinstance(job.exception(), WorkerDied)


def test_a_worker_that_nobody_closed_ends_with_python(program: Path) -> None:
    text = (
        "from warpath_worker import Worker\n"
        f"w = Worker({str(program)!r})\n"
        f"w.submit(mode='render', scene={str(SCENE)!r}, spp=1 << 20)\n"
        "print(w._process.pid)"
    )
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=30)
    assert done.returncode == 0, done.stderr
    process = Path("/proc") / done.stdout.strip()
    for _ in range(100):
        # Who has ended may still be listed, without a command line, until somebody asks for it.
        if not process.exists() or not (process / "cmdline").read_bytes():
            return
        time.sleep(0.1)
    raise AssertionError("it renders on")


def test_threads_change_no_bytes(program: Path) -> None:
    images = []
    for threads in (1, 3):
        with Worker(program, threads=threads) as worker:
            images.append(Renderer(worker, SCENE, resolution=[40, 30], spp=4).image({}, 7))
    assert (images[0] == images[1]).all()
