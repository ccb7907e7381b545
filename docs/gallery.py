#!/usr/bin/env python3
"""The gallery: runs cases and keeps their pictures and numbers in docs/gallery.

    ./dev gallery            every case again: pictures, numbers, tables of the pages
    ./dev gallery l_bracket  this one
    docs/gallery.py --program build/kerf --check l_bracket     fails when the repository is stale

A picture is stale when the case has changed since it was made, when it is another file than the one that was recorded,
or when the program draws something else: the numbers behind it differ, or its colors over a grid of tiles do. Single
pixels are not compared: fonts and rounding change them."""

import argparse
import csv
import hashlib
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import struct
import tempfile
import tomllib
import zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
GALLERY = ROOT / "docs/gallery"
RECORD = GALLERY / "drawn.json"
NUMBERS = re.compile(r"(<!-- numbers: gallery\.py makes them -->\n).*?(<!-- end of numbers -->\n)", re.S)

# Which pictures of a run a page shows. A design is NAME.png, others are NAME_<picture>.png.
PICTURES = {
    "adaptive": ["mesh"],
    "arc_crack": ["von_mises"],
    "cantilever": ["design", "evolution"],
    "crack_arrest": ["design"],
    "cracked_plate": ["von_mises", "map", "validate", "design"],
    "crossing_cracks": ["von_mises"],
    "edge_crack": ["von_mises"],
    "gmsh_plate": ["map"],
    "heat_flow": ["von_mises"],
    "hydraulic_fracture": ["von_mises"],
    "inclined_closed": ["map"],
    "inverse_crack": ["found"],
    "inverse_hole": ["found"],
    "kinked_crack_hole": ["von_mises"],
    "l_bracket": ["design"],
    "least_volume": ["design"],
    "many_cracks": ["map"],
    "near_incompressible_block": ["design"],
    "nucleation": ["map"],
    "orthotropic_plate": ["map"],
    "partly_closed": ["map"],
    "press_fit": ["von_mises"],
    "sliding_crack": ["von_mises"],
    "stiff_inclusion": ["von_mises"],
    "tracking_map": ["map", "validate"],
    "two_loads": ["design"],
    "unloading_crack": ["von_mises"],
    "worst_crack": ["design"],
}
# Processors round otherwise, and a design follows the last digit: what is drawn may differ by these shares.
TOLERANCE, TOLERANCE_OF_DESIGNS = 2e-4, 2e-2


def picture_path(name, picture):
    return GALLERY / (f"{name}.png" if picture in ("design", "found") else f"{name}_{picture}.png")


def digest(data):
    return hashlib.sha256(data).hexdigest()[:16]


def case_digest(name):
    """Of what the case says: comments and blanks do not count."""
    return digest(json.dumps(tomllib.loads((ROOT / f"cases/{name}.toml").read_text(encoding="utf-8")), sort_keys=True).encode())


def run(program, name, folder):
    done = subprocess.run([program, "run", ROOT / f"cases/{name}.toml", "-o", folder, "--force", "--quiet", "--threads", "1",
                           "--set", "output.vtk=false", "--set", "output.html=false"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{name}: kerf ended with {done.returncode}\n{done.stderr}")


def map_cells(path):
    """Means of a map over 6 x 4 cells of its extent: what the picture shows, without the mesh."""
    with open(path) as file:
        rows = [(float(r["x"]), float(r["y"]), float(r["topological_derivative"])) for r in csv.DictReader(file)
                if r["masked"] == "0" and r["topological_derivative"]]
    if not rows:
        return []
    (x0, x1), (y0, y1) = ((min(r[i] for r in rows), max(r[i] for r in rows)) for i in (0, 1))
    sums = {}
    for x, y, t in rows:
        cell = (min(3, int(4 * (y - y0) / (y1 - y0 or 1))), min(5, int(6 * (x - x0) / (x1 - x0 or 1))))
        total, count = sums.get(cell, (0, 0))
        sums[cell] = (total + t, count + 1)
    return [float(f"{total / count:.5g}") for _, (total, count) in sorted(sums.items())]


def design_numbers(folder):
    body = tomllib.loads((folder / "design.toml").read_text(encoding="utf-8"))
    return {"openings": len(body.get("hole", [])), "cracks_left": len(body.get("crack", []))}


def drawn(folder):
    """The numbers that stand behind the pictures."""
    result = json.loads((folder / "result.json").read_text())
    numbers = {"compliance": result["state"]["compliance"], "area": result["state"]["area"]}
    for crack in result.get("cracks", []):
        numbers[f"opening of {crack['name']}"] = crack["max_opening"]
    if (folder / "map.csv").exists():
        numbers["map"] = map_cells(folder / "map.csv")
    if "validate" in result:
        numbers["verdicts"] = " ".join(point["verdict"] for point in result["validate"])
    if "optimize" in result:
        numbers |= design_numbers(folder)
        numbers |= {"objective": result["optimize"]["objective"], "feasible": result["optimize"]["feasible"]}
        for variable in result["optimize"].get("least_squares", {}).get("variables", []):
            numbers[variable["name"]] = variable["value"]
    return numbers


def differences(old, new):
    """What the program draws otherwise, in words."""
    of_design = "openings" in new
    for key in sorted(old.keys() | new.keys()):
        a, b = old.get(key), new.get(key)
        tolerance = TOLERANCE_OF_DESIGNS if of_design and key != "map" else TOLERANCE
        if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
            size = max(map(abs, a), default=0)
            if any(abs(x - y) > 10 * tolerance * size for x, y in zip(a, b)):
                yield f"{key}: other values"
        elif isinstance(a, float) and isinstance(b, (int, float)):
            if not math.isclose(a, b, rel_tol=tolerance, abs_tol=1e-12):
                yield f"{key} is {b:.6g}, in the picture {a:.6g}"
        elif a != b:
            yield f"{key} is {b}, in the picture {a}"


def pixels(path):
    """Width, bytes per pixel and rows of a PNG with 8 bits per channel."""
    data = path.read_bytes()
    at, packed, palette = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + length]
        at += 12 + length
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", chunk[:10])
            if depth != 8 or chunk[12]:
                sys.exit(f"{path}: not a PNG with 8 bits per channel")
        elif kind == b"PLTE":
            palette = [chunk[i:i + 3] for i in range(0, length, 3)]
        elif kind == b"IDAT":
            packed += chunk
    raw, size = zlib.decompress(packed), {0: 1, 2: 3, 3: 1, 6: 4}[color]
    stride, rows, above = width * size, [], bytearray(width * size)
    for y in range(height):
        how, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        if how == 2:
            line = bytearray((a + b) & 255 for a, b in zip(line, above))
        elif how:
            for i in range(stride):
                a, b = line[i - size] if i >= size else 0, above[i]
                if how == 1:
                    guess = a
                elif how == 3:
                    guess = (a + b) // 2
                else:  # Paeth
                    c = above[i - size] if i >= size else 0
                    pa, pb, pc = abs(b - c), abs(a - c), abs(a + b - 2 * c)
                    guess = a if pa <= pb and pa <= pc else b if pb <= pc else c
                line[i] = (line[i] + guess) & 255
        above = line
        rows.append(b"".join(palette[p] for p in line) if palette else bytes(line))
    return width, 3 if palette else size, rows


def tiles(path, count=24):
    """Mean colors over count x count tiles."""
    width, size, rows = pixels(path)
    out = []
    for i in range(count):
        band = rows[i * len(rows) // count:(i + 1) * len(rows) // count]
        for j in range(count):
            left, right = j * width // count * size, (j + 1) * width // count * size
            out.append([sum(sum(row[left + c:right:size]) for row in band) * size / (len(band) * (right - left))
                        for c in range(min(size, 3))])
    return out


def looks_otherwise(old, new):
    """Whether more than 3 % of the tiles have another color. The same file is the usual case."""
    if old.read_bytes() == new.read_bytes():
        return False
    a, b = tiles(old), tiles(new)
    return sum(max(abs(x - y) for x, y in zip(p, q)) > 16 for p, q in zip(a, b)) > 0.03 * len(a)


def number(value):
    return f"{value:.4g}"


def at(point):
    return f"({point[0]:.3g}, {point[1]:.3g})"


def table(folder):
    """The rows of a page's table of numbers."""
    result = json.loads((folder / "result.json").read_text())
    rows = [("triangles", f"{result['mesh']['triangles']:,}"), ("compliance (work of the loads)", number(result["state"]["compliance"]))]
    cracks = result.get("cracks", [])
    if len(cracks) > 4:
        opened = sum(not crack["max_pressure"] for crack in cracks)
        closed = sum(not crack["max_opening"] for crack in cracks)
        rows.append(("cracks", f"{opened} open, {closed} closed, {len(cracks) - opened - closed} open in part"))
        cracks = []
    for crack in cracks:
        what = f"largest opening {number(crack['max_opening'])}"
        if crack.get("max_pressure"):
            what += f", largest pressure {number(crack['max_pressure'])}"
        for tip in crack.get("tips", []):
            if tip.get("K_I") is not None:
                what += f"; tip {at(tip['at'])}: K_I {number(tip['K_I'])}, K_II {number(tip['K_II'])}"
        rows.append((f"crack {crack['name']}", what))
    if result.get("map", {}).get("min"):
        rows += [(f"{word} of the map", f"{number(result['map'][key]['value'])} at {at(result['map'][key]['at'])}")
                 for key, word in (("min", "least value"), ("max", "largest value"))]
    for point in result.get("validate", []):
        rows.append((f"validation at {at(point['at'])}", point["verdict"]))
    if "optimize" in result:
        optimize = result["optimize"]
        rows += [("objective", f"{number(optimize['start']['objective'])} before, {number(optimize['objective'])} in the end"),
                 ("share of the area", number(optimize["volume_fraction"])),
                 ("openings", str(design_numbers(folder)["openings"])),
                 ("how it ended", optimize["ending"]), ("state solves", str(optimize["state_solves"]))]
        for variable in optimize.get("least_squares", {}).get("variables", []):
            rows.append((variable["name"], f"{number(variable['value'])} ± {number(variable['deviation'])}"))
    return "\n".join(["| | |", "|---|---|", *(f"| {a} | {b} |" for a, b in rows), ""])


def make(program, results, name, folder, record):
    if results:
        folder = results / name
    else:
        run(program, name, folder)
    optimize = json.loads((folder / "result.json").read_text()).get("optimize", {"ending": "optimal"})
    if not optimize["ending"].startswith("optimal"):
        sys.exit(f"{name}: the gallery shows designs that are proved to be optimal alone; this one is {optimize['stopped']}")
    for picture in PICTURES[name]:
        shutil.copyfile(folder / f"{picture}.png", picture_path(name, picture))
    record[name] = {"case": case_digest(name), "drawn": drawn(folder),
                    "pictures": {picture: digest(picture_path(name, picture).read_bytes()) for picture in PICTURES[name]}}
    page = GALLERY / f"{name}.md"
    if page.exists():
        page.write_text(NUMBERS.sub(lambda found: found[1] + table(folder) + found[2], page.read_text(encoding="utf-8")),
                        encoding="utf-8")


def stale(program, results, name, folder, record):
    """What is wrong with the pictures of a case. It is run, or its results are there already."""
    if name not in record:
        return ["has no pictures"]
    entry = record[name]
    wrong = [f"{picture_path(name, picture).relative_to(ROOT)} is another file than the one that was recorded"
             for picture in PICTURES[name]
             if not picture_path(name, picture).exists() or
             digest(picture_path(name, picture).read_bytes()) != entry["pictures"].get(picture)]
    if entry["case"] != case_digest(name):
        wrong.append(f"cases/{name}.toml has changed since")
    if not wrong and (program or results):
        if not results:
            run(program, name, folder)
        folder = results / name if results else folder
        wrong = list(differences(entry["drawn"], drawn(folder)))
        wrong += [f"{picture_path(name, picture).relative_to(ROOT)} looks otherwise than what the program draws"
                  for picture in PICTURES[name] if looks_otherwise(picture_path(name, picture), folder / f"{picture}.png")]
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="cases; all without one")
    parser.add_argument("--program", help="kerf; without it --check looks at the files alone")
    parser.add_argument("--check", action="store_true", help="say what is stale, and fail")
    parser.add_argument("--results", type=pathlib.Path, help="a folder with what kerf run left of every case: nothing is run")
    parser.add_argument("--keep", type=pathlib.Path, help="a folder for the results")
    asked = parser.parse_args()
    if not (asked.program or asked.results or asked.check):
        parser.error("give --program, --results or --check")
    cases = {path.stem for path in (ROOT / "cases").glob("*.toml")}
    if cases != set(PICTURES):
        sys.exit(f"docs/gallery.py and cases/ do not name the same cases: {sorted(cases ^ set(PICTURES))}")
    record = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    failed = False
    with tempfile.TemporaryDirectory() as scratch:
        for name in asked.names or sorted(PICTURES):
            folder = (asked.keep or pathlib.Path(scratch)) / name
            if asked.check:
                for what in stale(asked.program, asked.results, name, folder, record):
                    print(f"{name}: {what}; ./dev gallery {name} makes it again")
                    failed = True
                continue
            make(asked.program, asked.results, name, folder, record)
            RECORD.write_text(json.dumps(record, indent=1, sort_keys=True) + "\n")
            print(name, flush=True)
    sys.exit(failed)


main()
