"""What kerf raises: one class per exit code of the program."""

import re


class Error(Exception):
    exit_code = 4

    def __init__(self, message):
        super().__init__(message)
        self.where = _where(message)


class CaseError(Error, ValueError):
    exit_code = 2


class GeometryError(Error, ValueError):
    exit_code = 3


class SolveError(Error, ArithmeticError):
    exit_code = 4
    result = None


class FilesError(Error, OSError):
    exit_code = 5


_classes = {of.exit_code: of for of in (CaseError, GeometryError, SolveError, FilesError)}
_place = re.compile(r"((?:--set )?[\w.-]+(?:\[\d+\])*(?:\.[\w-]+(?:\[\d+\])*)*|[^\n]*?:\d+:\d+): ")


def _where(message):
    found = _place.match(message)
    return found.group(1) if found else None


def made(code, message):
    return _classes.get(code, Error)(message)


def raise_from(message, raised, by_callback):
    if by_callback:
        raise raised
    raise CaseError(f"{message}: {type(raised).__name__}: {raised}") from raised
