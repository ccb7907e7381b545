#!/usr/bin/env python3
"""links.py SOURCE: internal links of the Markdown documents lead somewhere. A link to a file needs the file; one to an
anchor needs a heading of that page whose anchor GitHub would make so, or an explicit id."""

import pathlib
import re
import sys
import urllib.parse

source = pathlib.Path(sys.argv[1]).resolve()
FENCE = re.compile(r"^(```+|~~~+)[^\n]*\n.*?^\1[ \t]*$", re.M | re.S)
CODE = re.compile(r"(`+)(?!`)(?:(?!\n\n).)*?(?<!`)\1(?!`)", re.S)  # within a paragraph
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\[\]]*\])*\]\(<?([^()\s>]+)>?(?:\s+\"[^\"]*\")?\)")
HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*#*\s*$", re.M)
ID = re.compile(r"<\w+[^>]*\b(?:id|name)=\"([^\"]+)\"")
SKIPPED = {"build", ".git", "out", "shared", "node_modules"}


def without_code(text):
    """The text with blank code, so that lines keep their numbers."""
    text = FENCE.sub(lambda found: "\n" * found[0].count("\n"), text)
    return CODE.sub(lambda found: "\n" * found[0].count("\n"), text)


def slug(heading):
    """GitHub's anchor of a heading: lower case, no punctuation, hyphens for spaces."""
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading.replace("`", ""))
    return re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")


def anchors(page, known={}):
    if page not in known:
        text = FENCE.sub("", page.read_text(encoding="utf-8"))
        found, counts = set(ID.findall(text)), {}
        for heading in HEADING.findall(text):
            name = slug(heading)
            counts[name] = counts.get(name, -1) + 1
            found.add(f"{name}-{counts[name]}" if counts[name] else name)
        known[page] = found
    return known[page]


def problem(page, target):
    """Why a link of the page leads nowhere, or None."""
    if re.match(r"[a-z][a-z0-9+.-]*:", target):
        return None  # another site
    path, _, anchor = urllib.parse.unquote(target).partition("#")
    to = (page.parent / path).resolve() if path else page
    if not to.exists():
        return f"no file {path}"
    if anchor and to.suffix == ".md" and anchor not in anchors(to):
        return f"no heading with the anchor #{anchor} in {to.relative_to(source)}"
    return None


pages = [page for page in sorted(source.rglob("*.md"))
         if not SKIPPED & set(page.relative_to(source).parts[:-1]) and not any(
             part.startswith(("build", ".")) for part in page.relative_to(source).parts[:-1])]
problems, count = [], 0
for page in pages:
    text = without_code(page.read_text(encoding="utf-8"))
    for found in LINK.finditer(text):
        count += 1
        if why := problem(page, found[1]):
            line = text[:found.start()].count("\n") + 1
            problems.append(f"{page.relative_to(source)}:{line}: [{found[1]}]: {why}")
if count < 500:
    problems.append(f"only {count} links were found in {len(pages)} pages")
print("\n".join(problems) or f"{count} links of {len(pages)} pages lead somewhere")
sys.exit(bool(problems))
