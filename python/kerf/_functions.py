"""Functions of Python in the place of expressions."""

import hashlib
import inspect

import numpy


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


def called_with_arrays(function, place):
    """What a function says that is written for arrays alone: arrays of one number."""
    out = function(*(numpy.array([value]) for value in place))
    found = numpy.asarray(out, dtype=float)
    return found.item() if found.size == 1 else out


def two_numbers(value):
    """The components of a vector, however a function returns them."""
    found = numpy.asarray(value, dtype=float).ravel()
    if found.size != 2:
        raise TypeError(f"a function in the place of a vector returns both components, (x, y), not {value!r}")
    return float(found[0]), float(found[1])


def functions_in(document):
    """Functions by what files call them."""
    if isinstance(document, dict):
        document = list(document.values())
    if isinstance(document, (list, tuple)):
        return {words: one for item in document for words, one in functions_in(item).items()}
    return {look_at(document)[1]: document} if callable(document) else {}


def put_back(document, functions):
    """A document that was read from a file, with functions for what files call them."""
    if isinstance(document, dict):
        return {key: put_back(one, functions) for key, one in document.items()}
    if isinstance(document, list):
        return [put_back(one, functions) for one in document]
    return functions.get(document, document) if isinstance(document, str) else document
