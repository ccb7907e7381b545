"""The module says what the program says, to the last bit: every case of cases/, on a coarse mesh, from its file and as a
dict, whatever the number of BLAS threads that Python was given."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import tomllib
import unittest

import kerf

PROGRAM, CASES = os.environ["KERF_PROGRAM"], pathlib.Path(os.environ["KERF_CASES"])
LARGE = {"bridge", "cracked_plate", "l_bracket", "mbb", "tracking_map"}  # and coarser still


def coarse(case, factor):
    """Overrides that make the case small."""
    size = case.get("mesh", {}).get("size", 0.1)
    out = {"mesh.size": factor * size, "output": {"vtk": False, "png": False, "html": False}}
    tip = case.get("mesh", {}).get("crack_tip_size")
    if tip:
        out["mesh.crack_tip_size"] = factor * tip
    if "adapt" in case.get("mesh", {}):
        out["mesh.adapt.max_triangles"] = 1000
    if "optimize" in case:
        out["optimize.max_iterations"] = 1
    return out


def numbers(folder):
    result = json.loads((pathlib.Path(folder) / "result.json").read_text())
    del result["time_s"], result["peak_memory_mb"]
    return result


def module(case, job, where):
    """What a run leaves, or its exit code where it leaves nothing."""
    try:
        getattr(case, job)(where, threads=1)
    except kerf.Error as error:
        if not (where / "result.json").exists():
            return error.exit_code
    return numbers(where)


class Bits(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def program(self, path, job, changes, where):
        sets = [word for key, value in changes.items() for word in ("--set", f"{key}={kerf._kerf.toml(value)}")]
        done = subprocess.run([PROGRAM, job, path, "-o", where, "--quiet", "--threads", "2", *sets],
                              capture_output=True, text=True)
        return numbers(where) if (where / "result.json").exists() else done.returncode

    def test_every_case(self):
        solved = 0
        for path in sorted(CASES.glob("*.toml")):
            with self.subTest(path.name):
                case = tomllib.loads(path.read_text())
                if case["domain"].get("file", "").endswith(".geo"):
                    continue  # gmsh's own mesh takes a minute
                changes = coarse(case, 4 if path.stem in LARGE else 2.5)
                said = self.program(path, "run", changes, self.folder / f"{path.stem}_program")
                of_dict = kerf.Case(case, name=path.stem, folder=path.parent, set=changes)
                self.assertEqual(said, module(of_dict, "run", self.folder / f"{path.stem}_module"))
                solved += isinstance(said, dict)
        self.assertGreater(solved, 20)

    def test_a_file(self):
        path = CASES / "edge_crack.toml"
        changes = coarse(tomllib.loads(path.read_text()), 2.5)
        said = self.program(path, "run", changes, self.folder / "program")
        self.assertEqual(said, module(kerf.Case(path, set=changes), "run", self.folder / "module"))


if __name__ == "__main__":
    unittest.main()
