#!/usr/bin/env bash
# Every citation resolves: a source in a comment or a document has an entry in docs/theory/bibliography.md, an equation
# has its tag in docs/theory, a document that is mentioned is in the repository; no tag twice, no entry without a reader.
# Prints file:line and what is wrong. Forms of citations: docs/theory/README.md.
exec python3 - "${1:-.}" <<'PYTHON'
import bisect
import os
import re
import subprocess
import sys

root = sys.argv[1]
os.chdir(root)
theory = "docs/theory/"
bibliography = theory + "bibliography.md"
slashes = (".hpp", ".cpp", ".h", ".edp")
hashes = (".toml", ".py", ".sh", ".cmake", ".txt", ".geo", ".yml")
problems = []


def complain(path, line, text):
    problems.append((path, line, text))


def files():
    asked = subprocess.run("git ls-files -co --exclude-standard", shell=True, capture_output=True, text=True)
    if asked.returncode == 0:
        return [f for f in asked.stdout.splitlines() if os.path.isfile(f)]
    found = []
    for folder, inner, names in os.walk("."):
        inner[:] = [d for d in inner if not d.startswith((".", "build", "out"))]
        found += [os.path.relpath(os.path.join(folder, name)) for name in names]
    return found


class Block:
    """Consecutive lines of prose as one text, with the line that each character comes from."""

    def __init__(self):
        self.text, self.starts, self.lines = "", [], []

    def add(self, line, text):
        self.starts.append(len(self.text))
        self.lines.append(line)
        self.text += text.strip() + " "

    def line(self, at):
        return self.lines[bisect.bisect_right(self.starts, at) - 1]


def comment(path, line):
    """What a line says to a reader, or None."""
    if path.endswith(slashes):
        at = line.find("//")
        while at >= 0 and (line[:at].count('"') % 2 == 1 or line[:at].endswith(":")):
            at = line.find("//", at + 2)
        return None if at < 0 else line[at:].lstrip("/")
    stripped = line.lstrip()
    return stripped.lstrip("#") if stripped.startswith("#") and not stripped.startswith("#!") else None


def prose(path, lines):
    """Blocks of a document without its code, or of the comments of a source."""
    block, fenced = Block(), False
    for number, line in enumerate(lines, 1):
        if path.endswith(".md"):
            fence = line.lstrip().startswith("```")
            said = None if fence or fenced else re.sub(r"`[^`]*`", lambda m: "`" * len(m[0]), line)
            fenced ^= fence
            if said is not None and not said.strip():
                said = None
        else:
            said = comment(path, line)
        if said is not None:
            block.add(number, said)
        elif block.text:
            yield block
            block = Block()
    if block.text:
        yield block


name = r"[A-Z][^\W\d_]*(?:['-][A-Z]?[^\W\d_]+)*"
year = r"(?:1[89]|20)\d\d"
source = re.compile(rf"({name}(?:, {name})*(?: et al\.)?) ({year})\b")
loose = re.compile(rf"\b({name}(?:(?:,| and|, and|-) ?{name})*(?: et al\.)?),? \(?({year})\b")
months = re.compile(r"^(January|February|March|April|May|June|July|August|September|October|November|December)$")
equation = re.compile(r"[A-Z]\.\d+")

# Definitions.
tags, entries = {}, {}
letters = {}
for path in sorted(f for f in os.listdir(theory) if f.endswith(".md")):
    for number, line in enumerate(open(theory + path, encoding="utf-8"), 1):
        for tag in re.findall(r"\\tag\{(.*?)\}", line):
            if tag in tags:
                complain(theory + path, number, f"equation ({tag}) is defined in {tags[tag][0]}:{tags[tag][1]} already")
            elif not equation.fullmatch(tag):
                complain(theory + path, number, f"tag {tag}: a letter, a point, a number are wanted")
            elif letters.setdefault(path, tag[0]) != tag[0]:
                complain(theory + path, number, f"tag {tag}: the equations of this chapter begin with {letters[path]}")
            tags.setdefault(tag, (theory + path, number))
for number, line in enumerate(open(bibliography, encoding="utf-8"), 1):
    entry = re.match(r"- \*\*\[(.*?)\]\*\*", line)
    if not entry:
        continue
    key = entry[1]
    if not source.fullmatch(key):
        complain(bibliography, number, f"[{key}]: the form is Name, Name year")
    if key in entries:
        complain(bibliography, number, f"[{key}] is in line {entries[key]} already")
    entries.setdefault(key, number)
    if not re.search(r"\[doi:(\S+)\]\(https://doi\.org/\1\)|DOI not verified|No DOI|Journal version", line):
        complain(bibliography, number, f"[{key}] has no DOI and does not say why")

# Citations.
cited = set()


def cite_sources(path, block):
    rest = block.text
    for group in re.finditer(r"\[([^\[\]]+)\](?!\()", block.text):
        here = block.line(group.start())
        if path == bibliography and f"**[{group[1]}]**" in block.text[group.start() - 2 : group.end() + 2]:
            rest = rest[: group.start()] + " " * len(group[0]) + rest[group.end() :]
            continue
        items = [item.strip() for item in group[1].split(";")]
        if not any(source.search(item) or item.startswith("theory") for item in items):
            continue
        rest = rest[: group.start()] + " " * len(group[0]) + rest[group.end() :]
        for item in items:
            if item.startswith("theory"):
                references = item.removeprefix("theory:").split(",")
                for reference in (r.strip() for r in references):
                    if reference not in tags:
                        complain(path, here, f"[{item}]: there is no equation {reference} in {theory}")
                continue
            found = source.match(item)
            if found:
                key = f"{found[1]} {found[2]}"
                cited.add(key)
                if key not in entries:
                    complain(path, here, f"[{key}] is not in {bibliography}")
            elif source.search(item):
                complain(path, here, f"[{item}]: begin with the names, as in docs/theory/README.md")
    if path == bibliography:
        return
    for found in loose.finditer(rest):
        if not months.match(found[1].split()[-1]):
            complain(path, block.line(found.start()), f'"{found[0]}" outside brackets: write [Name, Name year]')


names = {os.path.basename(f) for f in files()}


def exists(path, mentioned):
    return mentioned in names or any(os.path.isfile(os.path.normpath(os.path.join(at, mentioned))) for at in (os.path.dirname(path), ""))


for path in files():
    # The pages of the validation manual have their sources in full.
    if path.startswith(("tests/data/", "docs/validation/")) or path == "LICENSE" or path == "tests/citations.sh":
        continue
    if not path.endswith(slashes + hashes + (".md",)) and path != "dev":
        continue
    with open(path, encoding="utf-8", errors="replace") as file:
        lines = file.read().split("\n")
    for number, line in enumerate(lines, 1):
        for mentioned in re.findall(r"(?<![\w/.:-])[\w./-]*\w\.md\b", re.sub(r"https?://\S+", "", line)):
            if not exists(path, mentioned):
                complain(path, number, f"{mentioned} is not in the repository")
        if path.endswith(".md"):
            for reference in re.findall(r"\(([A-Z]\.\d+)\)", line):
                if reference not in tags:
                    complain(path, number, f"there is no equation ({reference}) in {theory}")
    for block in prose(path, lines):
        cite_sources(path, block)
for key, number in entries.items():
    if key not in cited:
        complain(bibliography, number, f"[{key}] is cited by nobody")

for path, line, text in sorted(problems):
    print(f"{path}:{line}: {text}")
sys.exit(1 if problems else 0)
PYTHON
