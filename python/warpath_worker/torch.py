"""Images that PyTorch differentiates.

from warpath_worker import Renderer, Seeds, Worker
from warpath_worker.torch import render

position = torch.zeros(3, requires_grad=True)
with Worker() as worker:
    view = Renderer(worker, "scenes/demo.xml", spp=16)
    for step in range(100):
        image = render(view, {"occluder.translation": position}, Seeds.of(0, step))
        loss = ((image - target) ** 2).mean()
        loss.backward()
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch
from torch.autograd.function import once_differentiable

from .renderer import Renderer
from .seeds import Seeds


def render(view: Renderer, values: Mapping[str, torch.Tensor], seeds: Seeds) -> torch.Tensor:
    """The image of `view` for these parameter values: float32, (height, width, 3), linear RGB.

    Gradients reach the values that require them, and are of their type and device. They are
    computed by another job, with the seed `seeds.derivative` (see `Seeds` for why), from the values
    as they were here. Derivatives of gradients are refused.
    """
    (image,) = render_views([view], values, [seeds])
    return image


def render_views(
    views: Sequence[Renderer], values: Mapping[str, torch.Tensor], seeds: Sequence[Seeds]
) -> tuple[torch.Tensor, ...]:
    """The images of several views of the same values, side by side in their workers, and so are
    their gradients, which are added in the order of the views."""
    if len(views) != len(seeds):
        raise ValueError(f"{len(views)} views need as many seeds, not {len(seeds)}")
    images = _Render.apply(list(views), list(seeds), list(values), *values.values())
    return tuple(images)


class _Render(torch.autograd.Function):  # type: ignore[misc]
    @staticmethod
    def forward(
        ctx: Any,
        views: list[Renderer],
        seeds: list[Seeds],
        keys: list[str],
        *values: torch.Tensor,
    ) -> tuple[torch.Tensor, ...]:
        # Copies: an optimiser changes the tensors in place, perhaps before the backward pass.
        arrays = {key: _array(value).copy() for key, value in zip(keys, values, strict=True)}
        jobs = [view.submit_image(arrays, s.image) for view, s in zip(views, seeds, strict=True)]
        ctx.views, ctx.seeds, ctx.keys, ctx.arrays = views, seeds, keys, arrays
        ctx.likenesses = [(value.dtype, value.device) for value in values]
        device = values[0].device if values else torch.device("cpu")
        return tuple(torch.from_numpy(job.result()).to(device) for job in jobs)

    @staticmethod
    @once_differentiable  # type: ignore[untyped-decorator]
    def backward(ctx: Any, *adjoints: torch.Tensor) -> tuple[Any, ...]:
        needed = ctx.needs_input_grad[3:]
        wanted = [key for key, is_needed in zip(ctx.keys, needed, strict=True) if is_needed]
        parts = zip(ctx.views, ctx.seeds, adjoints, strict=True)
        jobs = [
            view.submit_gradients(ctx.arrays, _array(adjoint), seeds.derivative, wanted)
            for view, seeds, adjoint in parts
        ]
        done = [job.result().values for job in jobs]
        gradients: list[torch.Tensor | None] = []
        for key, (dtype, device) in zip(ctx.keys, ctx.likenesses, strict=True):
            if key not in wanted:
                gradients.append(None)
                continue
            total = np.zeros_like(done[0][key])
            for of_view in done:
                total = total + of_view[key]
            gradients.append(torch.from_numpy(total).to(device=device, dtype=dtype))
        return (None, None, None, *gradients)


def _array(tensor: torch.Tensor) -> np.ndarray[Any, Any]:
    array: np.ndarray[Any, Any] = tensor.detach().cpu().numpy()
    return array
