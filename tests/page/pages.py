"""Folders of runs to look at: small runs of cases, and made-up ones that no run would leave."""

import json
import math
import re
import struct
import subprocess


def run(kerf, *arguments):
    done = subprocess.run([kerf, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode in (0, 4), f"kerf {' '.join(map(str, arguments))}: {done.stderr}"
    return done


def cracked(kerf, cases, folder):
    """State, map with error bars, contact and a validation, coarse."""
    out, case = folder / "cracked", folder / "cracked.toml"
    text = (cases / "cracked_plate.toml").read_text()
    case.write_text(re.sub(r"^\[optimize\].*?(?=^\[(?!\[?optimize))", "", text, flags=re.M | re.S))
    run(kerf, "run", case, "-o", out, "--quiet", "--set", "mesh.size=0.25", "--set", "map.bounds=true",
        "--set", "mesh.crack_tip_size=0.05", "--set", "output.vtk=false")
    return out


def designed(kerf, folder):
    """A few iterations of a level set."""
    case = folder / "beam.toml"
    case.write_text("""title = "A short beam"
[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1.0
poisson = 0.3
state = "plane stress"
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = ["0", "-0.1"]
[mesh]
size = 0.12
[functional]
kind = "compliance"
[optimize]
method = "level-set"
volume = { at_most = 0.6 }
max_iterations = 8
[output]
vtk = false
png = false
""")
    out = folder / "beam"
    run(kerf, "run", case, "-o", out, "--quiet")
    return out


def made_up(kerf, folder, name, points, triangles, values):
    """A folder with one body and one map, and the page of it. `values` per point."""
    out = folder / name
    out.mkdir()
    finite = [v for v in values if math.isfinite(v)]
    least, most = (min(finite), max(finite)) if finite else (None, None)
    (out / "result.json").write_text(json.dumps({
        "schema": 1, "version": "0", "case": name, "status": "ok", "title": f"A made-up page: {name}",
        "mesh": {"triangles": len(triangles), "vertices": len(points)},
        "state": {"element": "bdms", "residual": 1e-15, "energy": -1.0, "compliance": 2.0, "area": 1.0},
        "map": {"perturbation": "hole", "min": {"at": [0, 0], "value": least}, "max": {"at": [1, 0], "value": most}, "points": [],
                "radius": 0.1, "masked_share": 0.0}, "time_s": {"total": 1.0}}))
    flat = [x for p in points for x in p]
    arrays = [("points", "f32", 2, flat), ("triangles", "u32", 3, [i for t in triangles for i in t]), ("u", "f32", 2, [0.0] * len(flat)),
              ("stress", "f32", 3, [float("nan")] * 3 * len(points)), ("von_mises", "f32", 1, values), ("map", "f32", 1, values),
              ("margin", "f32", 1, [1.0] * len(points)), ("near", "u32", 1, [0] * len(points)), ("left_out", "u32", 1, [0] * len(points))]
    head = "kerf arrays 1\n" + "".join(f"{n} {t} {w} {len(v) // w}\n" for n, t, w, v in arrays) + "\n"
    body = b"".join(struct.pack(f"<{len(v)}{'f' if t == 'f32' else 'I'}", *v) for _, t, _, v in arrays)
    (out / "report.bin").write_bytes(head.encode() + body)
    run(kerf, "report", out, "--quiet")
    return out


def strange(kerf, folder):
    square, two = [(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 1, 2), (0, 2, 3)]
    nan = float("nan")
    return {
        "one triangle": made_up(kerf, folder, "one_triangle", square[:3], two[:1], [1.0, 2.0, 3.0]),
        "not a number": made_up(kerf, folder, "not_a_number", square, two, [nan] * 4),
        "partly not a number": made_up(kerf, folder, "partly", square + [(2, 0)], two + [(1, 4, 2)], [1.0, 2.0, 3.0, 1.5, nan]),
        "infinite": made_up(kerf, folder, "infinite", square, two, [1.0, float("inf"), 3.0, -1.0]),
        "constant": made_up(kerf, folder, "constant", square, two, [5.0] * 4),
        "empty": made_up(kerf, folder, "empty", [], [], []),
    }
