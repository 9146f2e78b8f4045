"""The process, and the jobs that are under way in it."""

from __future__ import annotations

import collections
import contextlib
import json
import os
import secrets
import subprocess
import tempfile
import threading
import weakref
from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from .errors import JobFailed, WorkerDied
from .job import Job
from .parameters import Parameter, list_parameters
from .program import find_program
from .result import Result

# A message is the last lines of what the process said on standard error.
_LINES_KEPT = 20


class Worker:
    """A `warpath batch -` process. Scenes stay loaded between jobs, and jobs that were submitted
    together run beside each other. Threads may share one.

        with Worker() as worker:
            done = worker.run(mode="render", scene="scenes/demo.xml", outputs=["image.npy"])
            done.image()

    `program` is looked for as `find_program` says. Results are files in `folder`; without one they
    are in a temporary folder, which ends with the worker (set TMPDIR=/dev/shm to spare the disk).
    A folder may have results of earlier workers, which stay.
    `threads` are as many as the process may use, and `options` are more of `warpath batch`'s.
    """

    def __init__(
        self,
        program: str | os.PathLike[str] | None = None,
        *,
        folder: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        options: Sequence[str] = (),
    ) -> None:
        self.program = find_program(program)
        self._temporary = tempfile.TemporaryDirectory(prefix="warpath-")
        own = Path(self._temporary.name)
        self._inputs = own / "inputs"
        self._inputs.mkdir()
        self.folder = Path(folder).absolute() if folder else own / "results"
        # Unlike those of other workers that write into the same folder, before or after this one.
        self._ids = f"job-{secrets.token_hex(4)}"
        command = [str(self.program), "batch", "-", "-o", str(self.folder), "--quiet", *options]
        if folder and "--resume" not in options:
            command.append("--resume")
        if threads is not None:
            command += ["--threads", str(threads)]
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
            # An interrupt from the keyboard is Python's to handle, not the worker's.
            start_new_session=True,
        )
        # At the end of Python, where nobody has closed it, nobody waits for it either.
        weakref.finalize(self, self._process.terminate)
        assert self._process.stdin and self._process.stdout and self._process.stderr
        self._stdin = self._process.stdin
        # Lines are counted and written under the first lock. The second is never held for long, so
        # answers are read while a line waits for room in the pipe.
        self._writing = threading.Lock()
        self._state = threading.Lock()
        self._lines = 0
        self._pending: dict[int, tuple[Job, Future[Result]]] = {}
        self._death: WorkerDied | None = None
        self._is_closed = False
        self._said: collections.deque[str] = collections.deque(maxlen=_LINES_KEPT)
        self._listener = _start(self._listen, self._process.stderr)
        self._reader = _start(self._read, self._process.stdout)

    def submit(self, *, mode: str, scene: str | os.PathLike[str], **fields: Any) -> Future[Result]:
        """Sends a job and returns at once; the result is the future's. See docs/batch.md for the
        fields.

        In `set` and in tangents numbers may be arrays of the parameter's shape, and `adjoint` and
        `target` arrays of (height, width, 3). A job that fails raises `JobFailed` where its result
        is asked for, and a worker that is no more `WorkerDied`.
        """
        future: Future[Result] = Future()
        future.set_running_or_notify_cancel()
        with self._writing:
            if self._is_closed:
                raise WorkerDied("the worker was closed", None)
            number = self._lines + 1
            id = f"{self._ids}-{number}"
            job = Job({"id": id, "mode": mode, "scene": scene, **fields}, self._inputs)
            self._lines = number
            with self._state:
                if self._death is not None:
                    job.discard()
                    raise self._death
                self._pending[number] = (job, future)
            # If nobody reads any more, the end of the answers tells why.
            with contextlib.suppress(OSError):
                self._stdin.write(job.text + "\n")
                self._stdin.flush()
        return future

    def run(self, *, mode: str, scene: str | os.PathLike[str], **fields: Any) -> Result:
        """Sends a job and waits for its result."""
        return self.submit(mode=mode, scene=scene, **fields).result()

    def parameters(
        self,
        scene: str | os.PathLike[str],
        defines: Mapping[str, str | float | bool] | None = None,
    ) -> dict[str, Parameter]:
        """What can be set and differentiated in a scene, by key."""
        return list_parameters(self.program, scene, defines or {})

    def close(self) -> None:
        """Lets the worker finish what it has, and ends it. A temporary folder goes."""
        with self._writing:
            self._is_closed = True
            with contextlib.suppress(OSError):
                self._stdin.close()
        self._reader.join()
        self._temporary.cleanup()

    def terminate(self) -> None:
        """Ends the worker, whatever it is doing. Jobs that were under way raise `WorkerDied`."""
        self._process.terminate()
        self.close()

    def __enter__(self) -> Worker:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        # Nobody waits for what is left where something has gone wrong.
        if kind is None:
            self.close()
        else:
            self.terminate()

    def _read(self, stdout: IO[str]) -> None:
        """Hands out answers until there are no more."""
        nonsense = None
        for line in stdout:
            try:
                answer = json.loads(line)
                with self._state:
                    job, future = self._pending.pop(answer["line"])
            except (ValueError, KeyError, TypeError):
                nonsense = line.strip()
                self._process.kill()
                break
            job.discard()
            if answer["status"] == "ok":
                future.set_result(Result(answer, self.folder))
            else:
                future.set_exception(
                    JobFailed(str(answer["id"]), answer["code"], answer["message"])
                )
        stdout.close()
        self._listener.join()
        code = self._process.wait()
        with self._state:
            self._death = self._epitaph(code, nonsense)
            left, self._pending = list(self._pending.values()), {}
        for job, future in left:
            job.discard()
            future.set_exception(self._death)

    def _listen(self, stderr: IO[str]) -> None:
        self._said.extend(line.rstrip() for line in stderr)
        stderr.close()

    def _epitaph(self, code: int, nonsense: str | None) -> WorkerDied:
        how = f"signal {-code}" if code < 0 else f"code {code}"
        if nonsense is not None:
            return WorkerDied(f"{self.program} is no worker: it answered {nonsense!r}", code)
        said = "".join(f"\n{line}" for line in self._said)
        return WorkerDied(f"the worker ended with {how}{said}", code)


def _start(target: Any, stream: IO[str]) -> threading.Thread:
    thread = threading.Thread(target=target, args=(stream,), daemon=True)
    thread.start()
    return thread
