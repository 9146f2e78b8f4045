#!/usr/bin/env python3
"""Writes src/scene/metals.rs and src/scene/iors.rs, the named materials of Mitsuba 3 as it resolves them itself, and
src/scene/observer.rs, how its eye sees.

Needs `pip install mitsuba numpy` (made with Mitsuba 3.9.1, variant scalar_rgb). Usage, from anywhere:

    python scripts/mitsuba_tables.py
"""

from pathlib import Path
import re

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
mi.set_log_level(mi.LogLevel.Error)

SCENE = Path(__file__).resolve().parent.parent / "src" / "scene"


def number(x):
    x = np.float32(x)
    if 0 < x < 1e-4:
        return np.format_float_scientific(x, unique=True, trim="0")
    return np.format_float_positional(x, unique=True, trim="0")


def triple(value):
    values = np.broadcast_to(np.array(value, dtype=np.float32), 3)
    return "[" + ", ".join(number(x) for x in values) + "]"


def metals():
    folder = Path(mi.__file__).parent / "data" / "ior"
    for name in sorted(path.name[: -len(".eta.spd")] for path in folder.glob("*.eta.spd")):
        values = mi.traverse(mi.load_dict({"type": "conductor", "material": name}))
        yield name, values["eta.value"], values["k.value"]


def ior_names():
    """Mitsuba lists the names it knows when it is asked for one it does not know."""
    try:
        mi.load_dict({"type": "dielectric", "int_ior": "?"})
    except RuntimeError as error:
        listed = re.search(r"Valid choices are:\s*(.*)", str(error)).group(1)
        return [name.strip() for name in listed.split(",")]
    raise SystemExit("Mitsuba took '?' for a material")


def main():
    version = f"Mitsuba {mi.__version__}, variant {mi.variant()}"
    observer(version)
    lines = [
        "//! Complex indices of refraction of named conductors in linear sRGB, as Mitsuba resolves `material` in its rgb variants.",
        "//!",
        f"//! Written by `scripts/mitsuba_tables.py` with {version}. Names are case-sensitive. `none` is not listed:",
        "//! it stands for eta = 0, k = 1, which reflects everything.",
        "",
        "/// Name, eta, k.",
        "#[rustfmt::skip]",
        "pub const METALS: &[(&str, [f32; 3], [f32; 3])] = &[",
    ]
    lines += [f'    ("{name}", {triple(eta)}, {triple(k)}),' for name, eta, k in metals()]
    (SCENE / "metals.rs").write_text("\n".join(lines + ["];"]) + "\n")

    lines = [
        "//! Indices of refraction of named dielectrics.",
        "//!",
        f"//! Written by `scripts/mitsuba_tables.py` with {version}. Mitsuba lowers the case of a name before it looks it up.",
        "",
        "/// Name, index of refraction.",
        "pub const IORS: &[(&str, f32)] = &[",
    ]
    for name in ior_names():
        inside = mi.traverse(mi.load_dict({"type": "dielectric", "int_ior": name, "ext_ior": 1.0}))
        lines.append(f'    ("{name}", {number(inside["eta"])}),')
    (SCENE / "iors.rs").write_text("\n".join(lines + ["];"]) + "\n")


def observer(version):
    """The CIE 1931 observer and the illuminant D65 at steps of 5 nm."""
    lines = [
        "//! The CIE 1931 2° standard observer and the illuminant D65 (CIE 015), from 360 to 830 nanometres at",
        "//! steps of 5.",
        "//!",
        f"//! Written by `scripts/mitsuba_tables.py` with {version}. D65 is",
        "//! one at 560 nanometres.",
        "",
        "/// x̄, ȳ, z̄, D65.",
        "#[rustfmt::skip]",
        "pub const OBSERVER: [[f32; 4]; 95] = [",
    ]
    d65 = lambda nm: float(np.ravel(mi.cie_d65(float(nm)))[0])
    for nm in range(360, 831, 5):
        row = [*np.ravel(mi.cie1931_xyz(float(nm))), d65(nm) / d65(560)]
        lines.append("    [" + ", ".join(number(x) for x in row) + "],")
    (SCENE / "observer.rs").write_text("\n".join([*lines, "];", ""]))


if __name__ == "__main__":
    main()