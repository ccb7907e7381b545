#!/usr/bin/env python3
"""documents.py SOURCE PROGRAM: what the documents say is so. Commands in ```console blocks are run, and print what stands
below them; a run has the summary that its tutorial shows, as have the cases of docs/guide/modelling.md; cases in
```toml blocks of the README, the tutorials, the guides and the pages of docs/case-files are read by kerf check, as are
those in examples; the README is short; CITATION.cff is valid; it, codemeta.json and CHANGELOG.md have the version of the
program; the paper has what JOSS asks for; every licence has its text."""

import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import tomllib

source, program = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
VERSION = (source / "VERSION").read_text().strip()
problems = []
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)


def blocks(path, language):
    text = (source / path).read_text(encoding="utf-8")
    for found in FENCE.finditer(text):
        if found[1] == language:
            yield text[:found.start()].count("\n") + 2, found[2]


def kerf(arguments, folder):
    done = subprocess.run([program, *arguments], cwd=folder, capture_output=True, text=True)
    # The log is not what the reader is told about, nor are summaries.
    return done.returncode, [line for line in done.stderr.splitlines() if not line.startswith("[")]


def try_commands(path, folder):
    count = 0
    for line, block in blocks(path, "console"):
        shutil.rmtree(folder / "out", ignore_errors=True)
        for command, said in re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", block, re.M):
            words = shlex.split(command)
            if words[0] != "kerf":
                continue
            _, errors = kerf(words[1:], folder)
            count += 1
            if errors != said.splitlines():
                problems.append(f"{path}:{line}: {command}\n  should say {said.splitlines()}\n  says       {errors}")
    return count


def try_cases(path, folder):
    count = 0
    for line, block in blocks(path, "toml"):
        if "[domain]" not in block or "[material]" not in block:
            continue  # a part of a case
        (folder / "block.toml").write_text(block, encoding="utf-8")
        code, errors = kerf(["check", "block.toml"], folder)
        count += 1
        if code:
            problems.append(f"{path}:{line}: kerf check says {errors}")
    return count


def check_solutions(path, folder):
    """A case with lines of a summary below it: kerf solve prints them, in this order."""
    text = (source / path).read_text(encoding="utf-8")
    count = 0
    for found in re.finditer(r"^```toml\n(.*?)^```\n\n```text\n(.*?)^```$", text, re.M | re.S):
        (folder / "solved.toml").write_text(found[1], encoding="utf-8")
        quick = [word for key in ("html", "png", "vtk") for word in ("--set", f"output.{key}=false")]
        done = subprocess.run([program, "solve", "solved.toml", "-o", "out/solved", "--force", *quick], cwd=folder,
                              capture_output=True, text=True)
        summary = done.stdout.splitlines()
        for expected in found[2].splitlines():
            if expected not in summary:
                problems.append(f"{path}:{text[:found.start()].count(chr(10)) + 1}: the summary has no line {expected!r}")
                continue
            summary = summary[summary.index(expected) + 1:]
        count += 1
    return count


def try_example_files(folder):
    for path in sorted((source / "examples").glob("*.toml")):
        code, errors = kerf(["check", str(path), "-o", "out/example", "--force"], folder)
        if code:
            problems.append(f"{path.relative_to(source)}: kerf check says {errors}")


# What an example of a page of keys leaves out.
BODY = {
    "domain": '[domain]\noutline = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = ["bottom", "right", "top", "left"]\n',
    "material": "[material]\nyoung = 1\npoisson = 0.3\n",
    "boundary": '[[boundary]]\non = "left"\ndisplacement = [0, 0]\n',
}


def try_key_examples(path, folder):
    """Examples of the pages of docs/case-files, with the body of BODY where they have none, are read by kerf check."""
    count = 0
    for line, block in blocks(path, "toml"):
        if "file =" in block:
            continue  # the file is the reader's
        tables = set(re.findall(r"^\[+(\w+)", block, re.M))
        text = block + "".join(table for name, table in BODY.items() if name not in tables)
        (folder / "block.toml").write_text(text, encoding="utf-8")
        code, errors = kerf(["check", "block.toml", "-o", "out/check", "--force"], folder)
        count += 1
        if code:
            problems.append(f"{path}:{line}: kerf check says {errors}")
    return count


def check_objective():
    """The objective of the developer's tutorial is the one that tests/contributing.sh adds and validates."""
    text = (source / "tests/contributing.sh").read_text(encoding="utf-8")
    code = re.search(r"^Term deflection\(\) \{.*?^\}$", text, re.M | re.S)
    if not code or code[0] not in (source / "docs/tutorials/developer.md").read_text(encoding="utf-8"):
        problems.append("docs/tutorials/developer.md: deflection() is not that of tests/contributing.sh")


def check_run(path, folder):
    """A command whose summary has the lines that stand below it, in this order."""
    for line, block in blocks(path, "console"):
        command, *said = block.splitlines()
        done = subprocess.run([program, *shlex.split(command)[2:], "-o", "out/run", "--force"], cwd=folder, capture_output=True,
                              text=True)
        summary = done.stdout.splitlines()
        for expected in said:
            if expected not in summary:
                problems.append(f"{path}:{line}: the summary has no line {expected!r}")
                continue
            summary = summary[summary.index(expected) + 1:]


def check_citation():
    """The fields that the schema 1.2.0 of the Citation File Format asks for, and the version of the program."""
    text = (source / "CITATION.cff").read_text(encoding="utf-8")
    keys = re.findall(r"^([a-z-]+):", text, re.M)
    known = {"cff-version", "message", "type", "title", "abstract", "authors", "version", "license", "keywords", "doi",
             "date-released", "repository-code", "url", "identifiers", "references", "preferred-citation", "contact", "commit"}
    for missing in {"cff-version", "message", "title", "authors"} - set(keys):
        problems.append(f"CITATION.cff: {missing} is missing")
    for key in set(keys) - known:
        problems.append(f"CITATION.cff: {key} is no key of the format")
    if len(set(keys)) != len(keys):
        problems.append("CITATION.cff: a key stands twice")
    if f"\nversion: {VERSION}\n" not in text:
        problems.append(f"CITATION.cff: the version is {VERSION}")


def check_paper():
    """paper/paper.md: the sections and the length that JOSS asks for, sources that are in paper.bib, and DOIs of the bibliography."""
    text = (source / "paper/paper.md").read_text(encoding="utf-8")
    bib = (source / "paper/paper.bib").read_text(encoding="utf-8")
    sections = re.findall(r"^# (.*)$", text, re.M)
    for missing in {"Summary", "Statement of need", "State of the field", "Software design", "Research impact statement",
                    "AI usage disclosure", "References"} - set(sections):
        problems.append(f"paper/paper.md has no section {missing}")
    words = len(text.split("---", 2)[2].split())
    if not 750 <= words <= 1750:
        problems.append(f"paper/paper.md has {words} words; 750 to 1750 are asked for")
    entries, cited = set(re.findall(r"^@\w+\{(\w+),", bib, re.M)), set(re.findall(r"@([A-Z]\w+\d{4})", text))
    if entries != cited:
        problems.append(f"paper/paper.md and paper.bib differ: {sorted(entries ^ cited)}")
    known = (source / "docs/theory/bibliography.md").read_text(encoding="utf-8")
    for doi in re.findall(r"doi = \{(.*?)\}", bib):
        if doi not in known and doi != "10.1515/jnum-2012-0013":  # of FreeFEM, which the theory does not cite
            problems.append(f"paper/paper.bib: {doi} is not in the bibliography")


def check_licences():
    """REUSE.toml: every pattern has files, every licence its text; codemeta.json has the version of the program."""
    tables = tomllib.loads((source / "REUSE.toml").read_text(encoding="utf-8"))["annotations"]
    for table in tables:
        for pattern in [table["path"]] if isinstance(table["path"], str) else table["path"]:
            if not any(source.glob(pattern)):
                problems.append(f"REUSE.toml: {pattern} has no files")
        for name in table["SPDX-License-Identifier"].split(" AND "):
            if not (source / "LICENSES" / f"{name}.txt").exists():
                problems.append(f"REUSE.toml: LICENSES/{name}.txt is missing")
    if (source / "LICENSES/GPL-3.0-or-later.txt").read_bytes() != (source / "LICENSE").read_bytes():
        problems.append("LICENSES/GPL-3.0-or-later.txt is not LICENSE")
    if json.loads((source / "codemeta.json").read_text(encoding="utf-8"))["version"] != VERSION:
        problems.append(f"codemeta.json: the version is {VERSION}")


def check_changelog():
    """The sections of Keep a Changelog; the newest that has a number is the version's."""
    text = (source / "CHANGELOG.md").read_text(encoding="utf-8")
    releases = re.findall(r"^## (.*)$", text, re.M)
    if releases[:2] != ["[Unreleased]", f"[{VERSION}]"]:
        problems.append(f"CHANGELOG.md: its first sections are {releases[:2]}, not [Unreleased] and [{VERSION}]")
    for unknown in set(re.findall(r"^### (.*)$", text, re.M)) - {"Added", "Changed", "Fixed", "Removed", "Case files that change"}:
        problems.append(f"CHANGELOG.md: a section is called {unknown}")


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    os.symlink(source / "cases", folder / "cases")
    commands = sum(try_commands(path, folder) for path in ["docs/faq.md"])
    pages = ["README.md", *(str(p.relative_to(source)) for wing in ("tutorials", "guide")
                            for p in sorted((source / "docs" / wing).glob("*.md")))]
    cases = sum(try_cases(path, folder) for path in pages)
    try_example_files(folder)
    solved = check_solutions("docs/guide/modelling.md", folder)
    os.symlink(source / "docs", folder / "docs")
    check_run("docs/tutorials/engineer.md", folder)
    cases += sum(try_key_examples(str(p.relative_to(source)), folder) for p in sorted((source / "docs/case-files").glob("*.md")))
check_objective()
check_citation()
check_paper()
check_licences()
check_changelog()
lines = len((source / "README.md").read_text(encoding="utf-8").splitlines())
if lines > 120:
    problems.append(f"README.md has {lines} lines; 120 are allowed")
if commands < 10 or cases < 1 or solved < 10:
    problems.append(f"only {commands} commands, {cases} cases and {solved} solutions were found")
print("\n".join(problems) or f"{commands} commands say what the documents say, {cases} cases are read, {solved} solved")
sys.exit(bool(problems))
