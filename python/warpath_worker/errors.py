"""What can go wrong."""

from __future__ import annotations


class WorkerError(Exception):
    """Whatever went wrong with a worker or one of its jobs."""


class ProgramNotFound(WorkerError):
    """There is no `warpath` program where one was looked for."""


class JobFailed(WorkerError):
    """A job failed; the worker goes on. The text is the worker's own.

    `id` names the job, `code` is the exit code that the single command would have had: 3 for bad
    input, 4 where the system failed (README.md has them all).
    """

    def __init__(self, id: str, code: int, message: str) -> None:
        super().__init__(message)
        self.id = id
        self.code = code
        self.message = message


class WorkerDied(WorkerError):
    """The process is no more. Jobs that were under way have this in place of a result.

    `code` is its exit code, negative for the signal that ended it, None where it was closed before
    the job was sent.
    """

    def __init__(self, message: str, code: int | None) -> None:
        super().__init__(message)
        self.code = code
