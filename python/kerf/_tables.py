"""Results as tables of pandas."""

import csv

from ._missing import needed


def field_table(points, fields):
    """A row per point: x, y and what there is, in scalar columns."""
    pandas = needed("pandas", "a table")
    columns = {"x": points[:, 0], "y": points[:, 1]}
    for name, values in fields.items():
        if name == "displacement":
            columns.update(u_x=values[:, 0], u_y=values[:, 1])
        elif name == "stress":
            columns.update(s_xx=values[:, 0], s_yy=values[:, 3], s_xy=(values[:, 1] + values[:, 2]) / 2)
        else:
            columns[name] = values
    return pandas.DataFrame(columns)


def tip_table(cracks):
    pandas = needed("pandas", "a table")
    rows = []
    for crack in cracks:
        for tip in crack.tips:
            row = {"crack": crack.name, "tip": tip.name, "x": tip.at[0], "y": tip.at[1]}
            row.update({name: tip.get(name) for name in ("K_I", "K_II", "G", "T")})
            row.update({f"{name}_margin": value for name, value in (tip.get("margin") or {}).items()})
            rows.append(row)
    return pandas.DataFrame(rows)


def flat_rows(rows):
    """Numbers and words of records, "von_mises.value" of what lies within."""
    return needed("pandas", "a table").json_normalize(rows)


def history_table(path):
    pandas = needed("pandas", "a table")
    with open(path, newline="") as file:
        return pandas.DataFrame([{key: _number(cell) for key, cell in row.items()} for row in csv.DictReader(file)])


def _number(cell):
    try:
        return float(cell) if cell else float("nan")
    except ValueError:
        return cell
