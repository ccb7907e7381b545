#!/usr/bin/env python3
"""Writes docs/cpp-reference.md from the public headers, include/kerf/*.hpp: of each header its comment, then every
declaration with the comment above it. Bodies of functions and private members are left out. Run it from anywhere;
--check says whether the committed page is up to date."""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TARGET = ROOT / "docs/cpp-reference.md"
HEAD = """# C++ reference

Made by `docs/cpp_reference.py` from the public headers in `include/kerf`: change the comments there, not this page. `#include "kerf/kerf.hpp"` includes all of them.
[The developer's tutorial](tutorials/developer.md) shows a whole program, `examples/map.cpp` is one of 30 lines, [install](install.md) says how `find_package(kerf)` finds the library.

Everything is in the namespace `kerf`. Errors at the borders (case file, geometry, an unsolvable system, the file system) are thrown as `kerf::Error`, whose `fault` is the exit code of the program.
A letter and a number in parentheses, such as (T.4), is an equation of the [theory](theory/README.md); a name and a year are a source of the [bibliography](theory/bibliography.md).

| header | holds |
|---|---|
"""


def prose(lines):
    """Comment lines as Markdown: one paragraph per block, equations in the form that the pages link."""
    text = " ".join(line.strip() for line in lines).strip()

    def equations(found):
        tags, *sources = found[1].split(";", 1)
        return ", ".join(f"({tag.strip()})" for tag in tags.split(",")) + "".join(f" [{of.strip()}]" for of in sources)

    text = re.sub(r"\[theory: ([^\]]*)\]", equations, text)
    text = re.sub(r"; theory: ([^\]]*)\]", lambda found: f"] {equations(found)}", text)
    text = re.sub(r"\(theory: ([A-Z]\.\d+)\)", r"(\1)", text)
    pieces = re.split(r"(`[^`]*`)", text)
    return "".join(piece if piece.startswith("`") else re.sub(r"([*<|])", r"\\\1", piece) for piece in pieces)


def bare(line):
    """A line without strings and comments, for counting brackets."""
    return re.sub(r"//.*", "", re.sub(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'', '""', line))


def depth(line, opening, closing):
    text = bare(line)
    return text.count(opening) - text.count(closing)


def without_bodies(lines):
    """A declaration without the bodies of its functions and without its private part."""
    out, skip, private = [], 0, False
    for at, line in enumerate(lines):
        if skip > 0:
            skip += depth(line, "{", "}")
            continue
        if re.match(r"\s*(private|public|protected):", line):
            private = "public" not in line
        if private and not (at == len(lines) - 1):
            continue
        opens = re.match(r"(.*\)(?: const)?(?: noexcept)?(?: -> [\w:<>]+)?) \{", line) or re.match(r"(\s+: .*[)}]) \{", line)
        if opens:
            if depth(line, "{", "}") > 0:
                skip = depth(line, "{", "}")
            text = re.sub(r"\) : .*$", ")", opens[1])
            if not text.lstrip().startswith(":"):
                out.append(text + ";")
            continue
        out.append(line)
    return out


def declarations(lines):
    """(comment, code) of every declaration of the namespace."""
    comment, code, level, inside = [], [], 0, 0
    for line in lines:
        if not code and line.strip().startswith("///"):
            comment.append(line.strip()[3:])
            continue
        if not code and not line.strip():
            comment = []
            continue
        code.append(line)
        level += depth(line, "{", "}")
        inside += depth(line, "(", ")")
        if level == 0 and inside == 0 and re.search(r"[;}]$", bare(line).rstrip()):
            yield comment, code
            comment, code = [], []


def name(code):
    text = " ".join(code)
    found = (re.match(r"\s*(?:template <.*?> )?(?:struct|class|enum class|enum|namespace) (\w+)", text) or
             re.match(r"\s*using (\w+)", text) or re.search(r"(\w+|operator\S+)\(", text) or re.search(r"(\w+)(?: =|;|\{)", text))
    return found[1]


def section(path):
    """The lines of a header on the page, and what its first comment says."""
    lines = path.read_text(encoding="utf-8").splitlines()
    said = []
    for line in lines[1:]:
        if not line.startswith("//"):
            break
        said.append(line.lstrip("/"))
    begin = next((i for i, line in enumerate(lines) if re.match(r"namespace kerf(::\w+)? \{", line)), None)
    if begin is None:
        return [], prose(said)
    end = max(i for i, line in enumerate(lines) if line.startswith("}  // namespace kerf"))
    out = [f"## kerf/{path.name}", "", prose(said), ""]
    if "::" in lines[begin]:
        out += [f"In the namespace `{lines[begin].split()[1]}`.", ""]
    last = None
    for comment, code in declarations(lines[begin + 1:end]):
        if re.fullmatch(r"(struct|class) \w+;", code[0]):
            continue  # named here, declared elsewhere
        if comment or last is None:
            called = name(code)
            out += [f"### {called}", ""] + ([prose(comment), ""] if comment else [])
            out += ["```cpp", *without_bodies(code), "```", ""]
        else:  # belongs to the one above
            out = out[:-2] + [*without_bodies(code), "```", ""]
        last = code
    return out, prose(said)


def page():
    table, body = [], []
    for path in sorted((ROOT / "include/kerf").glob("*.hpp")):
        lines, said = section(path)
        first = re.split(r"(?<=[.!?]) ", said)[0]
        table.append(f"| [{path.stem}](#kerf{path.stem}hpp) | {first} |" if lines else f"| {path.stem} | {first} |")
        body += lines
    return HEAD + "\n".join(table) + "\n\n" + "\n".join(body).rstrip() + "\n"


if __name__ == "__main__":
    text = page()
    if "--check" in sys.argv:
        if not TARGET.exists() or TARGET.read_text(encoding="utf-8") != text:
            sys.exit("docs/cpp-reference.md is not what the public headers say: run docs/cpp_reference.py")
    else:
        TARGET.write_text(text, encoding="utf-8")
