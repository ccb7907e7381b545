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


def _label(result, name):
    units = result.numbers.get("units", {})
    unit = None
    if name.startswith(("stress", "von_mises")):
        unit = units.get("stress")
    elif name.startswith("displacement"):
        unit = units.get("length")
    return name.replace("_", " ") + (f" [{unit}]" if unit else "")


def _limits(values, vmin, vmax, least_share):
    """What is finite; the tail beyond the share of corners is cut off, since stresses at tips have no largest value."""
    finite = values[numpy.isfinite(values)]
    if finite.size == 0:
        return vmin, vmax
    low, high = numpy.quantile(finite, [1 - least_share, least_share])
    if low < 0 < high:
        low, high = -max(-low, high), max(-low, high)
    elif finite.min() >= 0:
        low = 0.0
    return low if vmin is None else vmin, high if vmax is None else vmax


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
        vmin, vmax = _limits(shown, vmin, vmax, 0.995)
        how = {"cmap": cmap or ("coolwarm" if vmin is not None and vmin < 0 else "viridis")}
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
