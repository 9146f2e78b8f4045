"""What scripts/complexity writes beside results.json: a CSV, Markdown tables and charts."""
import csv, io, math

COLOURS = {"low": "#2166ac", "middle": "#4d9221", "high": "#b2182b"}
COLUMNS = [
    "seconds", "setup_seconds", "megabytes", "rays", "variance", "spread", "error2", "error", "rms",
    "rms_known", "amplitude", "amplitude_error", "bias", "bias_limits", "blocks", "efficiency",
    "efficiency_by_variance", "worst", "calibration", "silhouettes", "not_found", "largest_part",
    "largest", "truth_largest", "finite", "rejected", "warnings",
]
HEAD = ("| scene | direction | spp | method | s | error | variance | amplitude | bias "
        "| amplitude of blocks | bias of blocks | reference's noise | efficiency | worst ten "
        "| spread / stated | silhouettes | not found | largest part |")


def write_reports(out, results):
    (out / "results.csv").write_text(as_csv(results))
    (out / "results.md").write_text(as_markdown(results))
    for scene in dict.fromkeys(cell["scene"] for cell in results.values()):
        cells = [cell for cell in results.values() if cell["scene"] == scene]
        (out / f"{scene}.svg").write_text(chart(scene, cells))


def as_csv(results):
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    keys = ["scene", "density", "direction", "spp"]
    table.writerow([*keys, "method", "reference_noise", "reference_runs", *COLUMNS])
    for cell in results.values():
        for method, n in cell["methods"].items():
            reference = cell["reference"]
            values = [n.get(column, "") for column in COLUMNS]
            table.writerow([*(cell[k] for k in keys), method, reference["noise"],
                            reference["runs"], *values])
    return text.getvalue()


def as_markdown(results):
    lines = [HEAD, "|---" * (HEAD.count("|") - 1) + "|"]
    notes = []
    for key, cell in results.items():
        for method, n in cell["methods"].items():
            lines.append(row(cell, method, n))
            if not n["finite"]:
                notes.append(f"- {key}, {method}: numbers that are not finite")
            notes += [f"- {key}, {method}: {text}" for text in n["warnings"]]
        notes += [f"- {key}: FAILED {text}" for text in cell["failures"].values()]
    return "\n".join(lines) + "\n\n" + "\n".join(dict.fromkeys(notes)) + "\n"


def row(cell, method, n):
    noise = cell["reference"]["noise"]
    return "| " + " | ".join([
        f"{cell['scene']} {cell['density']}", cell["direction"], str(cell["spp"]), method,
        f"{n['seconds']:.2f}", number(n["error"] if n["rms_known"] else None),
        f"{n['variance']:.3g}", *amplitude_and_bias(n), *amplitude_and_bias(n["blocks"]),
        number(noise if n["rms_known"] else None), number(n.get("efficiency")),
        f"{n['worst']:.0%}", f"{n['calibration']:.2f}", f"{n['silhouettes']:.0f}",
        f"{n['not_found']:.0f}", f"{n['largest_part']:.2f}",
    ]) + " |"


def number(x):
    return "–" if x is None else f"{x:.3g}"


def amplitude_and_bias(n):
    if not n["rms_known"]:
        return "?", "?"
    low, high = n["bias_limits"]
    # Two standard errors that reach zero: a bound and no value.
    bias = f"{n['bias']:.3g} ({low:.3g} … {high:.3g})" if low > 0 else f"< {high:.3g}"
    return f"{n['amplitude']:.3f} ± {n['amplitude_error']:.3f}", bias


def chart(scene, cells):
    """Error against processor seconds, a panel for each direction, both axes logarithmic."""
    width, height, left, top = 330, 300, 58, 46
    directions = list(dict.fromkeys(cell["direction"] for cell in cells))
    points = [
        (cell["direction"], cell["density"], method, n["seconds"], n["error2"] ** 0.5)
        for cell in cells for method, n in cell["methods"].items() if n["error2"] > 0
    ]
    total = len(directions) * (width + left) + 20
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {total} {height + top + 76}" '
           'font-family="sans-serif" font-size="12">',
           f'<rect width="{total}" height="{height + top + 76}" fill="white"/>']
    if points:
        spans = [span([p[axis] for p in points]) for axis in (3, 4)]
        for k, direction in enumerate(directions):
            x0 = left + k * (width + left)
            frame = (x0, top, width, height, spans)
            out.append(f'<text x="{x0}" y="{top - 12}" font-size="14">{scene}, {direction}</text>')
            out += axes(frame) + lines(frame, [p for p in points if p[0] == direction])
        out += legend(left, top + height + 58, points)
        out.append(f'<text transform="translate(14 {top + height / 2}) rotate(-90)" '
                   'text-anchor="middle">RMS error of one run, in units of the image</text>')
    return "\n".join([*out, "</svg>"]) + "\n"


def span(values):
    low, high = math.log10(min(values)), math.log10(max(values))
    return low - 0.08 * (high - low) - 0.02, high + 0.08 * (high - low) + 0.02


def place(frame, x, y):
    x0, y0, width, height, ((a, b), (c, d)) = frame
    return (x0 + width * (math.log10(x) - a) / (b - a),
            y0 + height * (d - math.log10(y)) / (d - c))


def axes(frame):
    x0, y0, width, height, (xs, ys) = frame
    out = [f'<rect x="{x0}" y="{y0}" width="{width}" height="{height}" fill="none" stroke="#888"/>']
    for value in ticks(xs):
        x = place(frame, value, 1)[0]
        out += [f'<path d="M{x:.1f} {y0}V{y0 + height}" stroke="#ddd"/>',
                f'<text x="{x:.1f}" y="{y0 + height + 16}" text-anchor="middle">{value:g}</text>']
    for value in ticks(ys):
        y = place(frame, 1, value)[1]
        out += [f'<path d="M{x0} {y:.1f}H{x0 + width}" stroke="#ddd"/>',
                f'<text x="{x0 - 5}" y="{y + 4:.1f}" text-anchor="end">{value:g}</text>']
    out.append(f'<text x="{x0 + width / 2}" y="{y0 + height + 34}" text-anchor="middle">'
               'processor seconds</text>')
    return out


def ticks(bounds):
    steps = (1, 2, 5) if bounds[1] - bounds[0] < 2.5 else (1,)
    exponents = range(math.floor(bounds[0]) - 1, math.ceil(bounds[1]) + 1)
    values = [step * 10.0**e for e in exponents for step in steps]
    return [v for v in values if bounds[0] <= math.log10(v) <= bounds[1]]


def lines(frame, points):
    out = []
    for density, method in dict.fromkeys((p[1], p[2]) for p in points):
        places = [place(frame, p[3], p[4]) for p in points if (p[1], p[2]) == (density, method)]
        path = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
        out.append(f'<path d="{path}" fill="none" stroke-width="1.6" {stroke(density, method)}/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.6" fill="{COLOURS[density]}"/>'
                for x, y in places]
    return out


def stroke(density, method):
    dashes = {"fd": ' stroke-dasharray="5 4"', "reparam": ""}.get(method, ' stroke-dasharray="1 3"')
    return f'stroke="{COLOURS[density]}"{dashes}'


def legend(x, y, points):
    out = []
    for density, method in dict.fromkeys((p[1], p[2]) for p in points):
        out += [f'<path d="M{x} {y - 4}h24" stroke-width="1.6" {stroke(density, method)}/>',
                f'<text x="{x + 29}" y="{y}">{density}, {method}</text>']
        x += 40 + 7 * (len(density) + len(method) + 2)
    return out
