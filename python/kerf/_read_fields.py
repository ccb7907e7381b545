"""The fields of a folder of results, from state.vtu and map.vtu, or from report.bin."""

import xml.etree.ElementTree

import numpy

from ._errors import FilesError

_types = {"Float64": "<f8", "Float32": "<f4", "Int32": "<i4", "Int64": "<i8", "UInt8": "u1", "UInt32": "<u4", "UInt64": "<u8"}
_kept = ("von_mises", "topological_derivative", "lower", "upper", "error_indicator")


def read_fields(folder):
    """Arrays by the names of a result, or nothing and a sentence that says why."""
    try:
        if (folder / "state.vtu").exists():
            return _with_map(folder, _of_vtu(folder / "state.vtu")), None
        if (folder / "report.bin").exists():
            return _of_page(folder / "report.bin"), None
    except (ValueError, KeyError, IndexError, xml.etree.ElementTree.ParseError) as error:
        raise FilesError(f"{folder}: the fields cannot be read ({error}); make the run again") from error
    return {}, (f"{folder} has no fields: neither state.vtu (output.vtk) nor report.bin (output.html); run the case again "
                "with one of them")


def _with_map(folder, arrays):
    if not (folder / "map.vtu").exists():
        return arrays
    found = _of_vtu(folder / "map.vtu")
    if "topological_derivative" in found and numpy.array_equal(found["corner_points"], arrays["corner_points"]):
        arrays.update({name: found[name] for name in ("masked", "angle", *_kept) if name in found})
    return arrays


def _of_vtu(path):
    raw = path.read_bytes()
    head, _, rest = raw.partition(b"<AppendedData")
    root = xml.etree.ElementTree.fromstring(head + b"</VTKFile>")
    if root.get("compressor") or b'encoding="raw"' not in rest[:100] or root.get("header_type") != "UInt64":
        raise ValueError(f"{path.name} was not written by kerf: it is compressed, or not raw")
    first = len(raw) - len(rest) + rest.index(b"_") + 1

    def values(array):
        at = first + int(array.get("offset"))
        size = int.from_bytes(raw[at:at + 8], "little")
        found = numpy.frombuffer(raw, _types[array.get("type")], offset=at + 8,
                                 count=size // numpy.dtype(_types[array.get("type")]).itemsize)
        width = int(array.get("NumberOfComponents", 1))
        return found.reshape(-1, width) if width > 1 else found

    piece = root.find("UnstructuredGrid/Piece")
    cells = {array.get("Name"): values(array) for array in piece.find("Cells")}
    begin = numpy.concatenate([[0], cells["offsets"][:-1]])
    triangles = cells["connectivity"][begin[:, None] + numpy.arange(3)]  # of quadratic ones the corners come first
    count = int(triangles.max()) + 1
    arrays = _of_corners(values(piece.find("Points")[0])[:count, :2], triangles)
    for array in [*piece.find("PointData"), *piece.find("CellData")]:
        _take(arrays, array, values(array), count)
    return arrays


def _take(arrays, array, found, count):
    name = array.get("Name")
    if name in ("u", "displacement"):
        arrays["displacement"] = found[:count, :2]
    elif name in ("sigma", "stress"):
        width = found.shape[1]
        names = [array.get(f"ComponentName{k}") for k in range(width)]
        if not {"xx", "yy", "xy"} <= set(names):
            names = ["xx", "yy", "xy"] if width == 3 else ["xx", "yy", "zz", "xy", "yz", "xz"]
        arrays["stress"] = _stress(*(found[:count, names.index(one)] for one in ("xx", "yy", "xy")))
    elif name in ("gamma", "rotation"):
        arrays["rotation"] = found[:count]
    elif name in _kept:
        arrays[name] = found if name == "error_indicator" else found[:count]
    elif name in ("mask", "masked"):  # 1: the expansion cannot hold, 2: beside what is singular
        arrays["masked"] = found[:count] != 0
    elif name == "angle_deg":
        arrays["angle"] = numpy.radians(found)


def _of_page(path):
    raw = path.read_bytes()
    head, _, rest = raw.partition(b"\n\n")
    lines = head.decode().splitlines()
    if lines[0] != "kerf arrays 1":
        raise ValueError(f"{path.name} is no file of kerf's arrays")
    found, at = {}, 0
    for line in lines[1:]:
        name, kind, width, rows = line.split()
        count = int(width) * int(rows)
        one = numpy.frombuffer(rest, {"f32": "<f4", "u32": "<u4"}[kind], count=count, offset=at)
        found[name], at = one.reshape(-1, int(width)) if int(width) > 1 else one, at + 4 * count
    arrays = _of_corners(found["points"].astype(float), found["triangles"])
    arrays["displacement"] = found["u"].astype(float)
    arrays["stress"] = _stress(*found["stress"].astype(float).T)
    for name, its in [*zip(_kept, _kept), ("topological_derivative", "map")]:
        if its in found:
            arrays[name] = found[its].astype(float)
    if "left_out" in found:
        arrays["masked"] = found["left_out"] != 0
    if "angle" in found:
        arrays["angle"] = numpy.radians(found["angle"].astype(float))
    return arrays


def _stress(xx, yy, xy):
    return numpy.column_stack([xx, xy, xy, yy])


def _of_corners(points, triangles):
    """The mesh, from the corners that the fields live at."""
    triangles = numpy.ascontiguousarray(triangles, dtype=numpy.int32)
    vertices, number = numpy.unique(points, axis=0, return_inverse=True)
    number = number.ravel().astype(numpy.int32)
    return {"points": vertices, "triangles": number[triangles], "corner_points": numpy.ascontiguousarray(points),
            "corner_triangles": triangles, "corner_vertex": number}
