"""Docstrings: they stand in __init__.pyi, once, for editors, for help() and for docs/python-reference.md."""

import ast
import pathlib
import sys


def document(public):
    """Gives what is public its module and the docstrings that the stubs have."""
    for one in public.values():
        one.__module__ = "kerf"
    stubs = pathlib.Path(__file__).with_name("__init__.pyi")
    if sys.flags.optimize > 1 or not stubs.exists():  # -OO: no docstrings are wanted
        return
    for node in ast.parse(stubs.read_text(encoding="utf-8")).body:
        if getattr(node, "name", None) in public:
            _give(public[node.name], node)


def _give(to, node):
    text = ast.get_docstring(node)
    if isinstance(to, classmethod):
        to = to.__func__
    if text:
        to.__doc__ = text
    for inner in node.body if isinstance(node, ast.ClassDef) else []:
        if getattr(inner, "name", None) in vars(to):
            _give(vars(to)[inner.name], inner)
