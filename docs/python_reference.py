#!/usr/bin/env python3
"""Writes docs/python-reference.md from the stubs of the Python module (python/kerf/__init__.pyi): signatures, docstrings
and attributes. Run it from anywhere; --check says whether the committed page is up to date."""

import ast
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
STUBS, PAGE = ROOT / "python/kerf/__init__.pyi", ROOT / "docs/python-reference.md"
HEAD = """# Python reference

Made from `python/kerf/__init__.pyi` by `docs/python_reference.py`; change the docstrings there. [python.md](python.md) shows
how it is used, [results.md](results.md) lists the numbers of a result, [case-files](case-files/index.md) the keys of a case.
"""


def prose(text):
    """A docstring as Markdown: literals, and examples as code."""
    out, example = [], []

    def flush():
        if example:
            out.extend(["", "```python", *example, "```", ""])
            example.clear()

    for line in text.splitlines():
        if line.startswith((">>>", "...")) or (example and line.strip()):
            example.append(line)
        else:
            flush()
            out.append(re.sub(r"``(.+?)``", r"`\1`", line))
    flush()
    return re.sub(r"\n{3,}", "\n\n", "\n".join(out)).strip()


def annotation(node):
    text = ast.unparse(node)
    text = re.sub(r"NDArray\[np\.(\w+)\]", r"array of \1", text)
    text = text.replace("array of bool_", "array of bool")
    return text.replace("NDArray[Any]", "array").replace("str | PathLike[str]", "path")


def signature(node, name):
    """On one line, or an argument a line; self is left out."""
    arguments = node.args
    parts = []
    positional = [*arguments.posonlyargs, *arguments.args]
    defaults = [None] * (len(positional) - len(arguments.defaults)) + list(arguments.defaults)
    for one, default in zip(positional, defaults):
        if one.arg == "self":
            continue
        parts.append(argument(one, default))
    if arguments.kwonlyargs:
        parts.append("*")
        parts += [argument(one, default) for one, default in zip(arguments.kwonlyargs, arguments.kw_defaults)]
    returned = f" -> {annotation(node.returns)}" if node.returns and node.name != "__init__" else ""
    line = f"{name}({', '.join(parts)}){returned}"
    if len(line) <= 110:
        return line
    return f"{name}(\n" + "".join(f"    {part},\n" for part in parts) + f"){returned}"


def argument(node, default):
    text = node.arg + (f": {annotation(node.annotation)}" if node.annotation else "")
    return text if default is None else f"{text} = {ast.unparse(default)}"


def is_property(node):
    return any(isinstance(one, ast.Name) and one.id == "property" for one in node.decorator_list)


def function(nodes, name, level):
    """One heading for all its overloads."""
    text = next((ast.get_docstring(node) for node in nodes if ast.get_docstring(node)), None)
    signatures = "\n".join(signature(node, name) for node in nodes)
    return f"{'#' * level} `{nodes[0].name}`\n\n```python\n{signatures}\n```\n\n{prose(text) if text else ''}".rstrip() + "\n"


def attributes(body):
    """Rows of a table: variables with the string behind them, and properties."""
    rows = []
    for node, following in zip(body, [*body[1:], None]):
        if isinstance(node, ast.AnnAssign):
            words = ""
            if isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant):
                words = following.value.value.strip()
            rows.append((node.target.id, annotation(node.annotation), words))
        elif isinstance(node, ast.FunctionDef) and is_property(node):
            rows.append((node.name, annotation(node.returns), " ".join((ast.get_docstring(node) or "").split())))
    return rows


def class_page(node):
    bases = [ast.unparse(base) for base in node.bases]
    out = [f"## {node.name}\n"]
    text = ast.get_docstring(node)
    if text:
        out.append(prose(text) + "\n")
    if bases:
        out.append(f"Derived from `{', '.join(bases)}`.\n")
    methods = {}
    for inner in node.body:
        if isinstance(inner, ast.FunctionDef) and not is_property(inner):
            methods.setdefault(inner.name, []).append(inner)
    if "__init__" in methods:
        out.append("```python\n" + signature(methods.pop("__init__")[0], f"kerf.{node.name}") + "\n```\n")
    rows = attributes(node.body)
    if rows:
        out.append("| attribute | type | |\n|---|---|---|\n" + "".join(
            f"| `{name}` | `{kind.replace(' | ', ' or ')}` | {prose(words)} |\n" for name, kind, words in rows))
    for name, nodes in methods.items():
        if name.startswith("__") and not any(ast.get_docstring(one) for one in nodes):
            continue
        out.append(function(nodes, f".{name}", 3))
    return "\n".join(out)


def page():
    tree = ast.parse(STUBS.read_text(encoding="utf-8"))
    functions, classes = {}, []
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            functions.setdefault(node.name, []).append(node)
        elif isinstance(node, ast.ClassDef):
            classes.append(class_page(node))
    head = HEAD + "\n" + prose(ast.get_docstring(tree).partition("\n\n")[2]) + "\n"
    return "\n".join([head, "## Functions\n", *(function(nodes, f"kerf.{name}", 3) for name, nodes in functions.items()),
                      *classes])


def main():
    text = page()
    if "--check" in sys.argv[1:]:
        if not PAGE.exists() or PAGE.read_text(encoding="utf-8") != text:
            sys.exit("docs/python-reference.md is not that of the stubs: run docs/python_reference.py")
        return
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
