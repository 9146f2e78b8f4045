"""How runs compare with the runs of a reference, number by number; for scripts/complexity."""
import numpy as np

WORST = 10
# Pixels across.
BLOCK = 8


def relative_noise(images):
    """Standard error of the mean of the images over its RMS, which is freed of that noise."""
    images = np.asarray(images, float)
    noise2 = images.var(0, ddof=1).mean() / len(images)
    rms2 = (images.mean(0) ** 2).mean() - noise2
    return float((noise2 / rms2) ** 0.5) if rms2 > 0 else float("inf")


def moments(runs, reference):
    """Amplitude, mean squared bias and mean squared reference, without what noise adds."""
    mean, truth = runs.mean(0), reference.mean(0)
    noise2 = runs.var(0, ddof=1).mean() / len(runs)
    truth_noise2 = reference.var(0, ddof=1).mean() / len(reference)
    # Noise may leave nothing of it, and what is relative to it is then not known.
    rms2 = (truth**2).mean() - truth_noise2
    bias2 = ((mean - truth) ** 2).mean() - noise2 - truth_noise2
    return np.array([(mean * truth).mean() / rms2, bias2 / rms2, rms2])


def jackknife(runs, reference):
    """Standard errors of the moments, by leaving out each run, and each run of the reference."""
    variance = 0
    for side in range(2):
        count = len((runs, reference)[side])
        if count < 3:
            return np.full(3, np.nan)
        left = []
        for k in range(count):
            sets = [runs, reference]
            sets[side] = np.delete(sets[side], k, 0)
            left.append(moments(*sets))
        variance = variance + (count - 1) / count * np.var(left, 0) * count
    return variance**0.5


def in_blocks(images):
    """Means over squares of BLOCK pixels: noise averages out there, and a bias does not."""
    count, rows, columns, channels = images.shape
    images = images[:, : rows // BLOCK * BLOCK, : columns // BLOCK * BLOCK]
    return images.reshape(count, rows // BLOCK, BLOCK, -1, BLOCK, channels).mean((2, 4))


def amplitude_and_bias(runs, reference):
    values, errors = moments(runs, reference), jackknife(runs, reference)
    amplitude, bias2, rms2 = (float(x) for x in values)
    limits = [max(bias2 + k * float(errors[1]), 0) ** 0.5 for k in (-2, 2)]
    return dict(
        rms=root(rms2),
        # Two standard errors above nothing, or what is relative to it says little.
        rms_known=bool(rms2 > 2 * errors[2]),
        amplitude=amplitude,
        amplitude_error=float(errors[0]),
        bias=root(bias2),
        bias_limits=limits,
    )


def compare(runs, reference):
    """All that a cell states of one method. `variance` and `error2` are squares in the image's own
    units, `spread` and `error` their roots relative to the reference's RMS."""
    images = np.array([run["gradient"] for run in runs])
    stated = np.array([run["stderr"] for run in runs])
    truth = reference.mean(0)
    variance = images.var(0, ddof=1)
    # Negative where the noise of the reference is larger than what is left of the difference.
    error2 = ((images - truth) ** 2).mean() - reference.var(0, ddof=1).mean() / len(reference)
    whole = amplitude_and_bias(images, reference)
    relative = lambda x: float(x**0.5 / whole["rms"]) if whole["rms"] > 0 and x > 0 else None
    pixels = np.sort(variance.sum(-1), axis=None)
    known = np.isfinite(stated).all(0)
    return dict(
        finite=bool(np.isfinite(images).all()),
        variance=float(variance.mean()),
        spread=relative(variance.mean()),
        error2=float(error2),
        error=relative(error2),
        **whole,
        blocks=amplitude_and_bias(in_blocks(images), in_blocks(reference)),
        worst=float(pixels[-WORST:].sum() / pixels.sum()) if pixels.sum() > 0 else 0.0,
        calibration=root(variance[known].mean() / (stated[:, known] ** 2).mean()),
        largest=float(np.abs(images).max()),
        truth_largest=float(np.abs(truth).max()),
    )


def root(x):
    """With its sign."""
    return float(np.sign(x) * abs(x) ** 0.5)
