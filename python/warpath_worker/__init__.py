"""Images and gradients from a `warpath batch -` process, as NumPy arrays.

`Worker` runs jobs as docs/batch.md describes them. `Renderer` is one view of a scene as a function
of some of its parameters. `warpath_worker.torch` and `warpath_worker.jax` make that a function
that PyTorch and JAX differentiate.
"""

from .errors import JobFailed, ProgramNotFound, WorkerDied, WorkerError
from .program import find_program
from .renderer import Renderer
from .result import Result
from .seeds import Seeds
from .worker import Worker

__all__ = [
    "JobFailed",
    "ProgramNotFound",
    "Renderer",
    "Result",
    "Seeds",
    "Worker",
    "WorkerDied",
    "WorkerError",
    "find_program",
]
