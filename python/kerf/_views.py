"""Parts of documents and results by their names and as attributes."""

import collections.abc

import numpy


def _name_of(item):
    return item.get("name") if isinstance(item, dict) else getattr(item, "name", None)


class Named(list):
    # Docstrings of what users see stand in __init__.pyi (_documented.py).

    def __getitem__(self, key):
        if not isinstance(key, str):
            return super().__getitem__(key)
        for item in self:
            if _name_of(item) == key:
                return item
        raise KeyError(f"there is no {key!r}; there are: {', '.join(map(repr, self.names)) or 'none at all'}")

    def __contains__(self, item):
        return item in self.names if isinstance(item, str) else super().__contains__(item)

    @property
    def names(self):
        return [name for name in map(_name_of, self) if name is not None]


class Section(collections.abc.Mapping):
    def __init__(self, numbers):
        self._numbers = numbers

    def __getitem__(self, key):
        return self._numbers[key]

    def __iter__(self):
        return iter(self._numbers)

    def __len__(self):
        return len(self._numbers)

    def __getattr__(self, name):
        numbers = self.__dict__.get("_numbers", {})
        if name in numbers:
            return viewed(numbers[name])
        raise AttributeError(f"there is no {name!r} here; there is {', '.join(numbers)}")

    def __dir__(self):
        return [*super().__dir__(), *self._numbers]

    def __repr__(self):
        return f"<kerf.{type(self).__name__}: {', '.join(f'{k} {brief(v)}' for k, v in self._numbers.items())}>"

    def to_dict(self):
        return self._numbers


def viewed(value):
    if isinstance(value, dict):
        return Section(value)
    if isinstance(value, list) and value and all(isinstance(one, dict) for one in value):
        return Named(map(Section, value))
    return value


def brief(value):
    """A value in a few characters."""
    if isinstance(value, bool) or value is None or isinstance(value, (str, int)):
        return str(value)
    if isinstance(value, float):
        return f"{value + 0.0:.4g}"  # without the sign of a zero
    if isinstance(value, dict):
        return "{...}"
    return f"[{len(value)}]"


def named(value):
    """A document whose lists of tables can be asked by name."""
    if isinstance(value, dict):
        return {key: named(one) for key, one in value.items()}
    if isinstance(value, list):
        items = [named(one) for one in value]
        return Named(items) if items and all(isinstance(one, dict) for one in items) else items
    return value


def copied(value):
    """The same document, of which nothing is shared but its functions."""
    if isinstance(value, dict):
        return {key: copied(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return type(value)([copied(one) for one in value])
    return value.copy() if isinstance(value, numpy.ndarray) else value


def same(a, b):
    """Whether two documents say the same."""
    if isinstance(a, dict) and isinstance(b, dict):
        return list(a) == list(b) and all(same(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, numpy.ndarray) or isinstance(b, numpy.ndarray):
        return type(a) is type(b) and numpy.array_equal(a, b)
    return a is b or (type(a) is type(b) and bool(a == b))
