#!/usr/bin/env python3
"""The table at the head of docs/backends.md's results, from what `warpath bench` wrote.

    python3 scripts/backends_summary.py [out/bench/bench.json]

Each cell is how much better (faster, smaller) one backend is than another: the geometric mean over all meshes, and the least and the
most. Needs nothing but Python.
"""

import json
import math
import sys

ROBUST = {name: (name, True) for name in ("embree", "embree-sse4.2", "obvhs", "obvhs-bvh2")}
LEAKY = {name: (name, False) for name in ("embree", "obvhs")}
COLUMNS = [
    ("obvhs", ROBUST["obvhs"], ROBUST["embree"]),
    ("obvhs-bvh2", ROBUST["obvhs-bvh2"], ROBUST["embree"]),
    ("embree-sse4.2", ROBUST["embree-sse4.2"], ROBUST["embree"]),
    ("obvhs over embree-sse4.2", ROBUST["obvhs"], ROBUST["embree-sse4.2"]),
    ("leaky obvhs over leaky Embree", LEAKY["obvhs"], LEAKY["embree"]),
]
LESS_IS_BETTER = {"ms", "MiB"}


def main():
    path = sys.argv[1] if len(sys.argv) > 1 else "out/bench/bench.json"
    with open(path, encoding="utf-8") as file:
        records = json.load(file)["records"]
    medians, units = {}, {}
    for r in records:
        medians[r["case"], r["what"], r["backend"], r["robust"], r["threads"]] = r["median"]
        units[r["what"]] = r["unit"]
    cases = sorted({r["case"] for r in records})

    def better(what, a, b, threads):
        ratios = []
        for case in cases:
            x, y = (medians.get((case, what, *which, threads)) for which in (a, b))
            if x and y:
                ratios.append(y / x if units[what] in LESS_IS_BETTER else x / y)
        if not ratios:
            return ""
        mean = math.exp(sum(map(math.log, ratios)) / len(ratios))
        return f"{mean:.2f} ({min(ratios):.2f}–{max(ratios):.2f})"

    print(f"| geometric mean (least–most) of {len(cases)} | " + " | ".join(c[0] for c in COLUMNS) + " |")
    print("| --- |" + " ---: |" * len(COLUMNS))
    for threads in sorted({r["threads"] for r in records}):
        for what in dict.fromkeys(r["what"] for r in records if r["threads"] == threads):
            cells = [better(what, a, b, threads) for _, a, b in COLUMNS]
            if any(cells):
                print(f"| {what}, {threads} thread{'s' if threads > 1 else ''} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
