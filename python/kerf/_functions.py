"""Functions of Python in the place of expressions."""

import hashlib
import inspect


def look_at(function):
    """How many arguments kerf gives to it (2: x, y; 4: x, y, nx, ny), and what it is called in files."""
    return _arguments(function), f"function {_name(function)} {_identity(function)}".rstrip()


def _arguments(function):
    count = getattr(function, "nin", None)  # of numpy's ufuncs
    if count is not None:
        return count
    try:
        parameters = list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError):  # some that are built in do not tell
        return 2
    places = [p for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    needed = sum(p.default is p.empty for p in places)
    if any(p.kind == p.VAR_POSITIONAL for p in parameters):
        return 4 if needed > 2 else 2
    if needed > 2:
        return needed
    return min(len(places), 2)


def _name(function):
    return getattr(function, "__qualname__", None) or getattr(function, "__name__", None) or type(function).__name__


def _identity(function):
    """Of its code, so that a case with another function is another case."""
    code = getattr(function, "__code__", None)
    if code is None:
        return ""
    cells = [repr(cell.cell_contents) for cell in getattr(function, "__closure__", None) or () if _is_set(cell)]
    constants = [repr(c) for c in code.co_consts if not inspect.iscode(c)]
    text = repr((code.co_code, constants, code.co_names, getattr(function, "__defaults__", None), cells))
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def _is_set(cell):
    try:
        cell.cell_contents
    except ValueError:
        return False
    return True
