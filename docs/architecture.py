#!/usr/bin/env python3
"""Draws docs/architecture.svg from the includes: rooms from the highest to the lowest, their wings and doors, and who
includes whom. Run it from anywhere; --check says whether the committed picture is up to date."""

import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
ROOMS = ["python", "bench", "app", "plot", "io", "optimize", "inspect", "topo", "growth", "solver", "geometry", "base"]
WIDTH, LEFT, BOX, HEIGHT, GAP = 1000, 20, 640, 74, 22


def escaped(text):
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def public_rooms():
    """Room of each public header, as tests/includes.sh has it."""
    text = (ROOT / "tests/includes.sh").read_text()
    return dict(re.findall(r"\[(\w+)\]=(\w+)", text[text.index("declare -A home"):].split(")", 1)[0]))


def read():
    home = public_rooms()
    wings = {room: collections.Counter() for room in ROOMS}
    doors = {room: [] for room in ROOMS}
    public = {room: sorted(name for name, of in home.items() if of == room) for room in ROOMS}
    arrows = collections.Counter()
    for room in ROOMS:
        for path in sorted((ROOT / room).rglob("*.[ch]pp")):
            inside = path.relative_to(ROOT / room)
            if len(inside.parts) > 1:
                wings[room][inside.parts[0]] += 1
            elif path.suffix == ".hpp":
                doors[room].append(path.stem)
            for include in re.findall(r'^#include "([^"]+)"', path.read_text(), re.M):
                first = include.split("/")[0]
                target = home.get(include[5:-4]) if first == "kerf" else first
                if target in ROOMS and target != room:
                    arrows[room, target] += 1
    return wings, doors, public, arrows


def clipped(words, limit):
    text = ", ".join(words)
    return text if len(text) <= limit else text[:limit].rsplit(",", 1)[0] + ", ..."


def draw():
    wings, doors, public, arrows = read()
    y = {room: 20 + i * (HEIGHT + GAP) for i, room in enumerate(ROOMS)}
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{20 + len(ROOMS) * (HEIGHT + GAP)}" '
           'font-family="DejaVu Sans, sans-serif" font-size="12">',
           '<title>The rooms of kerf: who includes whom</title>',
           '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
           'markerUnits="userSpaceOnUse" orient="auto"><path d="M0 0 L8 4 L0 8 z" fill="#456"/></marker></defs>',
           '<rect width="100%" height="100%" fill="white"/>']
    for room in ROOMS:
        top = y[room]
        lines = [", ".join(f"{wing} ({count})" for wing, count in sorted(wings[room].items()) if wing != "micro") or
                 f"{len(list((ROOT / room).glob('*.cpp')))} sources"]
        if public[room]:
            lines.append("public: " + clipped([name for name in public[room] if name != "kerf"], 84))
        if doors[room] and room not in ("app", "bench", "python"):
            lines.append("doors: " + clipped(doors[room], 84))
        out.append(f'<rect x="{LEFT}" y="{top}" width="{BOX}" height="{HEIGHT}" rx="6" fill="#eef3f8" stroke="#456"/>')
        out.append(f'<text x="{LEFT + 12}" y="{top + 19}" font-weight="bold" font-size="14">{room}</text>')
        for i, line in enumerate(lines):
            out.append(f'<text x="{LEFT + 12}" y="{top + 36 + 16 * i}">{escaped(line)}</text>')
    # Neighbors are joined by a straight arrow, the others by an arc to the right, the longer the farther out.
    lanes = collections.Counter()
    for (above, below), count in sorted(arrows.items(), key=lambda a: (ROOMS.index(a[0][1]) - ROOMS.index(a[0][0]), a)):
        span = ROOMS.index(below) - ROOMS.index(above)
        if span < 0:
            sys.exit(f"{above} includes {below}, which stands above it")
        width = 1 + min(count, 60) / 15
        if span == 1:
            x = LEFT + BOX / 2
            out.append(f'<line x1="{x}" y1="{y[above] + HEIGHT}" x2="{x}" y2="{y[below] - 1}" stroke="#456" '
                       f'stroke-width="{width:.1f}" marker-end="url(#tip)"/>')
            out.append(f'<text x="{x + 9}" y="{y[below] - 7}" fill="#456" font-size="11">{count}</text>')
            continue
        shift = lanes[span] * 9
        lanes[span] += 1
        reach = LEFT + BOX + 30 + 44 * span + shift
        start, end = y[above] + 16 + 8 * span, y[below] + HEIGHT - 12 - 7 * span
        edge = LEFT + BOX
        out.append(f'<path d="M{edge} {start} C{reach} {start} {reach} {end} {edge + 1} {end}" fill="none" stroke="#456" '
                   f'stroke-opacity="0.6" stroke-width="{width:.1f}" marker-end="url(#tip)"/>')
        out.append(f'<text x="{edge + 0.75 * (reach - edge) + 4:.0f}" y="{(start + end) / 2 + 9 * lanes[span]:.0f}" '
                   f'fill="#456" font-size="11">{count}</text>')
    out.append("</svg>\n")
    return "\n".join(out)


if __name__ == "__main__":
    target = ROOT / "docs/architecture.svg"
    picture = draw()
    if "--check" in sys.argv:
        # Numbers may lag behind: what exists and who includes whom may not.
        def shape(text):
            return re.sub(r"[0-9.]+", "", text)

        if not target.exists() or shape(target.read_text()) != shape(picture):
            sys.exit("docs/architecture.svg is not what the includes say: run docs/architecture.py")
    else:
        target.write_text(picture)
