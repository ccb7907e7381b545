"""Pictures with matplotlib."""

import numpy

from ._missing import needed


def matplotlib_triangulation(points, triangles):
    return needed("matplotlib.tri", "a triangulation").Triangulation(points[:, 0], points[:, 1], triangles)


def scalar_field(result, name):
    """Values and whether they are per triangle; a sentence with what there is for another name."""
    arrays = result._fields()
    whole, _, part = name.rpartition("_")
    if name == "error_indicator" and name in arrays:
        return arrays[name], True
    if name == "displacement" and name in arrays:
        return numpy.hypot(*arrays[name].T), False
    if whole == "displacement" and part in ("x", "y") and whole in arrays:
        return arrays[whole][:, "xy".index(part)], False
    if whole == "stress" and part in ("xx", "yy", "xy") and whole in arrays:
        s = arrays[whole]
        return {"xx": s[:, 0], "yy": s[:, 3], "xy": (s[:, 1] + s[:, 2]) / 2}[part], False
    if name in arrays and arrays[name].ndim == 1 and len(arrays[name]) == len(arrays["corner_points"]):
        return arrays[name], False
    known = ["mesh", "displacement", "displacement_x", "displacement_y", "stress_xx", "stress_yy", "stress_xy"]
    known += [one for one in arrays if arrays[one].ndim == 1 and one != "corner_vertex"]
    raise ValueError(f"there is nothing called {name!r} to plot; there is {', '.join(known)}")


def _axes(ax, what):
    if ax is not None:
        return ax
    needed("matplotlib", what)
    return needed("matplotlib.pyplot", what).subplots(layout="constrained")[1]


def plot_mesh(mesh, ax):
    ax = _axes(ax, "plot")
    ax.triplot(mesh.triangulation(), color="0.6", linewidth=0.4)
    for number, (name, edges) in enumerate([*mesh.labels.items(), *mesh.cracks.items()]):
        lines = numpy.full((len(edges), 3, 2), numpy.nan)  # a gap behind every edge
        lines[:, :2] = mesh.points[edges]
        ax.plot(*lines.reshape(-1, 2).T, color=f"C{number % 10}", label=name)
    ax.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    ax.set_aspect("equal")
    return ax


def _areas(arrays):
    a, b, c = numpy.moveaxis(arrays["corner_points"][arrays["corner_triangles"]], 1, 0)
    return numpy.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2


def _label(result, name):
    units = result.numbers.get("units", {})
    unit = None
    if name.startswith(("stress", "von_mises")):
        unit = units.get("stress")
    elif name.startswith("displacement"):
        unit = units.get("length")
    return name.replace("_", " ") + (f" [{unit}]" if unit else "")


def _limits(values, areas, vmin, vmax):
    """Colors end where 99.5 % of the area do: stresses at tips have no largest value, and tips most of the corners."""
    known = numpy.isfinite(values)
    if not known.any():
        return vmin, vmax
    order = numpy.argsort(values[known])
    values, share = values[known][order], numpy.cumsum(areas[known][order])
    share = share / share[-1]
    low, high = values[numpy.searchsorted(share, 0.005)], values[min(numpy.searchsorted(share, 0.995), len(values) - 1)]
    if low < 0 < high:
        low, high = -max(-low, high), max(-low, high)
    elif values[0] >= 0:
        low = 0.0
    elif values[-1] <= 0:
        high = 0.0
    return float(low) if vmin is None else vmin, float(high) if vmax is None else vmax


def plot(result, field, *, ax=None, scale=0.0, cmap=None, vmin=None, vmax=None, log=False, edges=False, colorbar=True):
    ax = _axes(ax, "plot")
    arrays = result._fields()
    triangulation = result.triangulation(scale)
    if field != "mesh":
        values, per_triangle = scalar_field(result, field)
        shown = values
        if "masked" in arrays and field in ("topological_derivative", "lower", "upper"):
            hidden = arrays["masked"][arrays["corner_triangles"]].any(axis=1)
            triangulation.set_mask(hidden)
            shown = numpy.where(arrays["masked"], numpy.nan, values)
        of_triangles = shown if per_triangle else shown[arrays["corner_triangles"]].mean(axis=1)
        vmin, vmax = _limits(of_triangles, _areas(arrays), vmin, vmax)
        both_signs = vmin is not None and vmax is not None and vmin < 0 < vmax
        how = {"cmap": cmap or ("coolwarm" if both_signs else "viridis")}
        if log:
            positive = shown[numpy.isfinite(shown) & (shown > 0)]
            colors = needed("matplotlib.colors", "plot")
            how["norm"] = colors.LogNorm(vmin if vmin else max(positive.min(), 1e-6 * vmax), vmax)
        else:
            how.update(vmin=vmin, vmax=vmax)
        if per_triangle:
            drawn = ax.tripcolor(triangulation, facecolors=values, **how)
        else:
            drawn = ax.tripcolor(triangulation, values, shading="gouraud", **how)
        if colorbar:
            ax.figure.colorbar(drawn, ax=ax, label=_label(result, field))
    if edges or field == "mesh":
        triangulation.set_mask(None)
        ax.triplot(triangulation, color="0.3", linewidth=0.3)
    for crack in result.cracks:
        if scale == 0 and crack.profile:
            ax.plot(*crack.at.T, color="black", linewidth=1.2)
    ax.set_aspect("equal")
    return ax
