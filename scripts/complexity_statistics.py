"""How runs compare with the runs of a reference, number by number; for scripts/complexity."""
import numpy as np

WORST = 10


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


def compare(runs, reference):
    """All that a cell states of one method. Errors are relative to the reference's RMS, but for
    `variance`, which is in the image's own units."""
    images = np.array([run["gradient"] for run in runs])
    stated = np.array([run["stderr"] for run in runs])
    finite = bool(np.isfinite(images).all())
    truth = reference.mean(0)
    truth_noise2 = reference.var(0, ddof=1).mean() / len(reference)
    values, errors = moments(images, reference), jackknife(images, reference)
    amplitude, bias2, rms2 = (float(x) for x in values)
    bias2_error = float(errors[1])
    variance = images.var(0, ddof=1)
    error2 = ((images - truth) ** 2).mean() - truth_noise2
    pixels = np.sort(variance.sum(-1), axis=None)
    known = np.isfinite(stated).all(0)
    root = lambda x: float(np.sign(x) * abs(x) ** 0.5)
    return dict(
        finite=finite,
        rms=root(rms2),
        variance=float(variance.mean()),
        spread=root(variance.mean() / rms2),
        error2=float(error2 / rms2) if rms2 > 0 else float("nan"),
        amplitude=amplitude,
        amplitude_error=float(errors[0]),
        bias=root(bias2),
        bias_limits=[max(bias2 + k * bias2_error, 0) ** 0.5 for k in (-2, 2)],
        worst=float(pixels[-WORST:].sum() / pixels.sum()) if pixels.sum() > 0 else 0.0,
        calibration=root(variance[known].mean() / (stated[:, known] ** 2).mean()),
        largest=float(np.abs(images).max()),
        truth_largest=float(np.abs(truth).max()),
    )
