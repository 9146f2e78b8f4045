#!/usr/bin/env python3
"""How often stated errors hold: gradients of hard scenes over many seeds (NumPy, safetensors).

For each scene and parameter: the spread of the runs over the root mean square of the standard errors they state (1 is
right), the share of runs whose interval mean ± t·error (t = 3.18, 95 % of Student's with the 3 degrees of freedom of four
groups) holds the mean of all runs, and the median share of the variance that `largest_parts` says its largest part
carries, with the coverage of the runs in which that share is above and below 0.3, beyond which Warpath warns.
"""
import argparse, json, pathlib, subprocess, tempfile
import numpy as np
from safetensors.numpy import load_file

ROOT = pathlib.Path(__file__).resolve().parent.parent
LAMP = """<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="2"/></integrator>
  <sensor type="perspective" id="cam"><float name="fov" value="38"/>
    <transform name="to_world"><lookat origin="0, -5, 2.6" target="0, 0, 0.3" up="0, 0, 1"/></transform>
    <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="24"/></film></sensor>
  <shape type="rectangle" id="floor"><transform name="to_world"><scale value="3"/></transform></shape>
  <shape type="cube" id="ball"><transform name="to_world"><scale value="0.4"/><rotate x="1" y="2" angle="40"/>
    <translate z="0.9"/></transform></shape>
  <shape type="sphere" id="lamp"><point name="center" x="-0.8" y="-0.5" z="3"/><float name="radius" value="0.4"/>
    <emitter type="area"><rgb name="radiance" value="9"/></emitter></shape>
</scene>
"""
CASES = [
    ("demo", "scenes/demo.xml", ["occluder.translation", "light.translation", "cam.translation"]),
    ("lamp of 20480 triangles", None, ["ball.translation", "lamp.translation", "lamp.emitter.radiance.value"]),
    ("sun", "scenes/paper/sun.xml", None),
    ("reflection", "scenes/paper/reflection.xml", None),
]


def parameters(warpath, scene):
    listed = json.loads(subprocess.run([warpath, "params", scene, "--json"], capture_output=True, check=True).stdout)
    listed = listed if isinstance(listed, list) else listed["parameters"]
    keys = [p["key"] for p in listed if p["differentiable"]]
    return [k for k in keys if k.endswith(".translation")]


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--warpath", default=str(ROOT / "target/release/warpath"))
    options.add_argument("--runs", type=int, default=200)
    options.add_argument("--spp", type=int, default=16)
    options = options.parse_args()
    print("| scene, parameter | spread / stated | coverage of 95 % | largest part | coverage where it is above 0.3 (runs) | below |")
    print("|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "lamp.xml").write_text(LAMP)
        np.save(folder / "one.npy", np.ones((24, 24, 3), np.float32))
        for name, scene, keys in CASES:
            scene = str(ROOT / scene) if scene else str(folder / "lamp.xml")
            keys = keys or parameters(options.warpath, scene)
            jobs = [
                dict(id=f"j{seed}", mode="backward", scene=scene, params=keys, adjoint=str(folder / "one.npy"),
                     resolution=[24, 24], spp=options.spp, seed=seed, outputs=["gradients.safetensors"])
                for seed in range(options.runs)
            ]
            (folder / "jobs.jsonl").write_text("\n".join(map(json.dumps, jobs)))
            out = folder / name.replace(" ", "-")
            subprocess.run([options.warpath, "batch", str(folder / "jobs.jsonl"), "-o", str(out), "--quiet"], check=True)
            lines = [json.loads(line) for line in (out / "results.jsonl").open()]
            files = {line["id"]: load_file(out / line["files"]["gradients"]) for line in lines}
            for key in keys:
                value = np.array([files[line["id"]][key] for line in lines], float)
                error = np.array([files[line["id"]][key + "#se"] for line in lines], float)
                share = np.array([line.get("largest_parts", {}).get(key, 0.0) for line in lines])
                mean = value.mean(0)
                held = np.abs(value - mean) <= 3.182 * error
                spread = np.sqrt(value.var(0, ddof=1).mean() / (error**2).mean())
                part = lambda runs: f"{held[runs].mean():.3f} ({runs.sum()})" if runs.any() else "–"
                print(f"| {name}, `{key}` | {spread:.2f} | {held.mean():.3f} | {np.median(share):.2f} "
                      f"| {part(share > 0.3)} | {part(share <= 0.3)} |", flush=True)


if __name__ == "__main__":
    main()
