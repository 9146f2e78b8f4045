"""Seeds of the random numbers of images and of derivatives."""

from __future__ import annotations

from dataclasses import dataclass

_MASK = (1 << 64) - 1


@dataclass(frozen=True)
class Seeds:
    """The seeds of one image and of the gradient of a loss of it.

    A loss that is not linear in the image multiplies two noisy numbers: its derivative by the
    image, L′(I), and the image's derivative by the parameters, ∂I/∂θ. If both come from the same
    samples they are correlated, and the mean of their product is not the product of their means.
    From independent samples it is. (What is left is the bias of L′(I) itself, which is zero where
    L′ is linear in the image, as in the squared error.) So `of` makes two seeds, and `same` is for
    those who want the derivative of the very image they saw, noise and all, biased as it is.
    """

    image: int
    derivative: int

    @staticmethod
    def of(seed: int, step: int) -> Seeds:
        """Independent ones for step `step` of the run that `seed` names."""
        first = _mix(_mix(seed & _MASK) ^ (2 * step & _MASK))
        second = _mix(_mix(seed & _MASK) ^ (2 * step + 1 & _MASK))
        return Seeds(image=first, derivative=second)

    @staticmethod
    def same(seed: int, step: int) -> Seeds:
        """One for both: the gradient is that of the noisy image, and biased."""
        image = Seeds.of(seed, step).image
        return Seeds(image=image, derivative=image)


def _mix(x: int) -> int:
    """The finaliser of SplitMix64 (Steele, Lea, Flood 2014), one to one on 64 bits."""
    x = (x + 0x9E3779B97F4A7C15) & _MASK
    x = ((x ^ (x >> 30)) * 0xBF58476D1CE4E5B9) & _MASK
    x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & _MASK
    return x ^ (x >> 31)
