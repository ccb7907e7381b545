"""What Sphinx does not do by itself for these documents, which are read on GitHub, too: formulas in ```math set by KaTeX
without a network, (T.3) as a link to that equation, [Author year] as a link to the bibliography, pages that open from disk."""

import pathlib
import re

from docutils import nodes

KATEX = pathlib.Path("/usr/share/javascript/katex")
EQUATION = re.compile(r"\(([A-Z]\.\d+)\)")
GUIDES = ["guide/index", "glossary", "cpp-reference", "support", "roadmap"]
SOURCE = re.compile(r"\[([^\[\]]*\b(?:1[89]|20)\d\d)\]")
IMPORT = re.compile(r'^import \w+ from "[^"]*";\n', re.M)
ROOTED = re.compile(r'(?:src|href)="/[^"]*"|<script[^>]*type="module"')
ABSOLUTE = re.compile(r"@import url\((/[^)]*)\);")
ENTRY = re.compile(r"^- \*\*\[(.*?)\]\*\*", re.M)


def slug(key):
    return "source-" + re.sub(r"[^a-z0-9]+", "-", key.lower()).strip("-")


def collect(app):
    """Which page defines which equation, and what the bibliography holds."""
    theory = pathlib.Path(app.srcdir, "theory")
    app.kerf_equations = {tag: f"theory/{page.stem}" for page in sorted(theory.glob("*.md"))
                          for tag in re.findall(r"\\tag\{(.*?)\}", page.read_text(encoding="utf-8"))}
    app.kerf_sources = set(ENTRY.findall((theory / "bibliography.md").read_text(encoding="utf-8")))


def toctree(pages, *options):
    return "\n".join(["", "```{toctree}", ":hidden:", *options, "", *pages, "```", ""])


def read(app, docname, source):
    """```math, as GitHub wants it, is a directive for MyST; entries of the bibliography get a target."""
    text = re.sub(r"^( *)```math$", r"\1```{math}\n\1:nowrap:", source[0], flags=re.M)
    if docname == "theory/bibliography":
        text = ENTRY.sub(lambda found: f'- <span id="{slug(found[1])}"></span>**[{found[1]}]**', text)
    if docname == "index" and pathlib.Path(app.srcdir, "python").with_suffix(".md").exists():  # it comes with the module
        text = text.replace("\ncase-files/index\nresults\n", "\ncase-files/index\npython\npython-reference\nresults\n")
    if docname == "index":  # guides that no list of the page has yet
        there = [guide for guide in GUIDES if pathlib.Path(app.srcdir, guide + ".md").exists() and f"\n{guide}\n" not in text]
        look_up = "\n```{toctree}\n:caption: Look up\n"
        text = text.replace(look_up, (toctree(there, ":caption: Guides") if there else "") + look_up)
    if docname == "theory/README":  # the chapters in the order of its table
        text += toctree(re.findall(r"^\|.*\]\((\w+)\.md\)", text, re.M))
    if docname == "validation/index":
        text += toctree(sorted(set(re.findall(r"\]\(([\w-]+)\.md\)", text))))
    source[0] = text


def link(app, doctree, docname):
    """(T.3) and [Author year] in prose become links."""
    def target(found):
        if found.re is EQUATION:
            page = app.kerf_equations.get(found[1])
            return page and app.builder.get_relative_uri(docname, page) + "#eq-" + found[1]
        keys = [key.strip() for key in found[1].split(";")]
        known = [key for key in keys if key in app.kerf_sources]
        if not known or docname == "theory/bibliography":
            return None
        return app.builder.get_relative_uri(docname, "theory/bibliography") + "#" + slug(known[0])

    for text in list(doctree.findall(nodes.Text)):
        if isinstance(text.parent, (nodes.literal, nodes.literal_block, nodes.math, nodes.math_block, nodes.reference)):
            continue
        pieces, at, whole = [], 0, text.astext()
        hits = sorted([*EQUATION.finditer(whole), *SOURCE.finditer(whole)], key=lambda found: found.start())
        for found in hits:
            uri = target(found) if found.start() >= at else None
            if uri:
                pieces += [nodes.Text(whole[at:found.start()]), nodes.reference(found[0], found[0], refuri=uri, internal=True)]
                at = found.end()
        if pieces:
            text.parent.replace(text, pieces + [nodes.Text(whole[at:])])


def inline(writer, node):
    writer.body.append(writer.starttag(node, "span", "", CLASS="math") + writer.encode(node.astext()) + "</span>")
    raise nodes.SkipNode


def block(writer, node):
    tag = re.search(r"\\tag\{(.*?)\}", node.astext())
    where = f' id="eq-{tag[1]}"' if tag else ""
    writer.body.append(f'<div class="math"{where}>{writer.encode(node.astext())}</div>\n')
    raise nodes.SkipNode


def page(app, pagename, templatename, context, doctree):
    """KaTeX only where there are formulas."""
    if doctree and any(True for kind in (nodes.math, nodes.math_block) for _ in doctree.findall(kind)):
        app.add_css_file("katex/katex.min.css")
        app.add_js_file("katex/katex.min.js")
        app.add_js_file("math.js")


def copy_katex(app, error):
    if error or app.builder.format != "html":
        return
    import shutil
    to = pathlib.Path(app.outdir, "_static/katex")
    to.mkdir(parents=True, exist_ok=True)
    for name in ("katex.min.css", "katex.min.js"):
        shutil.copyfile(KATEX / name, to / name)
    shutil.copytree(KATEX / "fonts", to / "fonts", dirs_exist_ok=True, symlinks=False)


def open_from_disk(app, error):
    """Debian's furo imports a module and takes a style from the root of a server; a page opened from disk can do neither.
    Here the module stands in the script, and the style in the style sheet."""
    if error or app.builder.format != "html":
        return
    static = pathlib.Path(app.outdir, "_static")
    script, module = static / "scripts/furo.js", static / "scripts/gumshoe-patched.js"
    text = script.read_text(encoding="utf-8")
    if IMPORT.search(text):
        script.write_text(module.read_text(encoding="utf-8") + IMPORT.sub("", text), encoding="utf-8")
    sheet = static / "styles/furo.css"
    text = sheet.read_text(encoding="utf-8")

    def style(found):
        file = pathlib.Path("/usr/share", found[1].lstrip("/"))
        return file.read_text(encoding="utf-8") if file.exists() else ""

    sheet.write_text(ABSOLUTE.sub(style, text), encoding="utf-8")
    for page in pathlib.Path(app.outdir).rglob("*.html"):
        if found := ROOTED.search(page.read_text(encoding="utf-8")):
            raise RuntimeError(f"{page} cannot be opened from disk: {found[0]}")


def setup(app):
    if not (KATEX / "katex.min.js").exists():
        raise RuntimeError(f"{KATEX} is not there: install libjs-katex and fonts-katex")
    app.add_html_math_renderer("katex", (inline, None), (block, None))
    app.connect("builder-inited", collect)
    app.connect("source-read", read)
    app.connect("doctree-resolved", link)
    app.connect("html-page-context", page)
    app.connect("build-finished", copy_katex)
    app.connect("build-finished", open_from_disk)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
