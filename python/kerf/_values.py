"""Values at points."""

import numpy

from . import _kerf

at_corners = ("displacement", "stress", "rotation", "von_mises", "topological_derivative", "masked", "lower", "upper")


class Values:
    # Docstrings of what users see stand in __init__.pyi (_documented.py).

    def __init__(self, points, arrays):
        self._arrays = {"points": points, **arrays}

    def __getitem__(self, name):
        return self._arrays[name]

    def __getattr__(self, name):
        arrays = self.__dict__.get("_arrays", {})
        if name in arrays:
            return arrays[name]
        raise AttributeError(f"these values have no {name!r}; they have {', '.join(arrays)}")

    def __dir__(self):
        return [*super().__dir__(), *self._arrays]

    def __repr__(self):
        return f"<kerf.Values at {self.inside.size} points, {self.inside.sum()} inside: {', '.join(self._arrays)}>"

    def to_pandas(self):
        from ._tables import field_table

        flat = {name: one.reshape(self.inside.size, *one.shape[self.inside.ndim:]) for name, one in self._arrays.items()}
        return field_table(flat.pop("points"), flat)


def values_at(points, outcome, arrays):
    """By the solution itself, or where there are only its values at corners, linear between these."""
    points = numpy.asarray(points, dtype=float)
    if points.ndim == 0 or points.shape[-1] != 2:
        raise ValueError(f"points are x and y along the last axis, as of shape (n, 2), not {points.shape}")
    flat = points.reshape(-1, 2)
    if outcome is not None and outcome.can_read:
        found = outcome.at(flat)
        if "topological_derivative" in arrays and "topological_derivative" not in found:  # of a clamped hole
            between = _between_corners(flat, arrays)
            found.update({name: between[name] for name in ("topological_derivative", "masked")})
    else:
        found = _between_corners(flat, arrays)
    found["inside"] = found.pop("triangle") >= 0
    return Values(points, {name: one.reshape(points.shape[:-1] + one.shape[1:]) for name, one in found.items()})


def _between_corners(points, arrays):
    triangle = numpy.array(_kerf.triangles_at(arrays["points"], arrays["triangles"], points), dtype=numpy.int32)
    a, b, c = numpy.moveaxis(arrays["points"][arrays["triangles"][triangle]], 1, 0)
    double = _cross(b - a, c - a)
    weights = numpy.stack([_cross(b - points, c - points), _cross(c - points, a - points), _cross(a - points, b - points)])
    weights /= double
    weights[:, triangle < 0] = numpy.nan
    corners = arrays["corner_triangles"][triangle].T
    out = {"triangle": triangle}
    for name in at_corners:
        if name == "masked" and name in arrays:
            out[name] = (triangle >= 0) & arrays[name][corners].any(axis=0)
        elif name in arrays:
            values = arrays[name][corners]  # (3, n) or (3, n, k)
            share = weights.reshape(weights.shape + (1,) * (values.ndim - 2))
            out[name] = numpy.where(abs(share) < 1e-12, 0, share * values).sum(axis=0)  # a corner may have no value
    return out


def _cross(a, b):
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
