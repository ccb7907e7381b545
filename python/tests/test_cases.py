"""Cases as documents: sources, tables that are read and written, copies, pickles, meshes, two-component functions."""

import copy
import multiprocessing
import pathlib
import pickle
import tempfile
import unittest

import kerf
import numpy

from plates import plate

TEXT = """
title = "A plate"
[domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1.0
poisson = 0.3
[[boundary]]
on = ["bottom", "top"]
traction = [0, "ny"]
[mesh]
size = 0.5
"""


def pull(x, y, nx, ny):
    return 0.1 * x, ny * (1 + x * x)


def energy_of(case):
    return case.solve(threads=1)["state"]["energy"]


def result_of(case):
    return case.map(threads=1)


def fails(case):
    case["mesh"]["size"] = -1
    return case.solve()


class Sources(unittest.TestCase):
    def test_text_path_dict_and_case(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "plate.toml"
            path.write_text(TEXT)
            by_path, by_text = kerf.Case(path), kerf.Case(TEXT, name="plate")
            by_dict = kerf.Case(by_path.to_dict(), name="plate")
            for case in (by_path, by_text, by_dict, kerf.Case(by_path)):
                self.assertEqual((case.name, case.title, case.text()), ("plate", "A plate", by_path.text()))
        changed = kerf.Case(by_text, set={"mesh.size": 0.25})
        self.assertEqual((changed["mesh"]["size"], by_text["mesh"]["size"]), (0.25, 0.5))

    def test_mistakes_in_a_text_have_a_place(self):
        with self.assertRaises(kerf.CaseError) as caught:
            kerf.Case(TEXT.replace("size", "sice"), name="mine")
        self.assertEqual(caught.exception.where, "mine:13:1")

    def test_repr_counts(self):
        self.assertEqual(repr(kerf.Case(plate(), name="p")),
                         "<kerf.Case 'p': 1 crack, sides bottom, right, top, left, bdms 2>")


class Tables(unittest.TestCase):
    def test_read_and_write(self):
        case = kerf.Case(plate(), set={"mesh.size": 0.5})
        self.assertEqual(case["mesh"]["size"], 0.5)
        self.assertEqual(case["crack"]["c"]["path"], [[0.3, 0.5], [0.7, 0.5]])
        self.assertEqual([*case], ["domain", "crack", "material", "boundary", "mesh", "map"])
        case["mesh"]["size"] = 0.25
        case["crack"]["c"]["contact"] = "open"
        del case["map"]
        written = plate(0.25) | {"crack": [plate()["crack"][0] | {"contact": "open"}]}
        del written["map"]
        self.assertEqual(case.text(), kerf.Case(written).text())
        self.assertEqual(energy_of(case), energy_of(kerf.Case(written)))
        self.assertNotIn("map", case)

    def test_names_that_are_not_there(self):
        case = kerf.Case(plate())
        with self.assertRaisesRegex(KeyError, "it has domain, crack"):
            case["functional"]
        with self.assertRaisesRegex(KeyError, "there is no 'd'; there are: 'c'"):
            case["crack"]["d"]
        self.assertIsNone(case.get("functional"))

    def test_mistakes_are_found_at_the_next_use(self):
        case = kerf.Case(plate())
        case["mesh"]["size"] = -1
        with self.assertRaises(kerf.CaseError) as caught:
            case.solve()
        self.assertEqual(caught.exception.where, "mesh.size")
        case["mesh"]["size"] = numpy.float64(0.5)
        self.assertLess(energy_of(case), 0)

    def test_arrays_are_seen_to_change(self):
        case = kerf.Case(plate(0.5))
        path = numpy.array([[0.3, 0.5], [0.7, 0.5]])
        case["crack"]["c"]["path"] = path
        before = energy_of(case)
        path[1, 0] = 0.5
        self.assertLess(abs(energy_of(case)), abs(before))  # a shorter crack

    def test_functions_stay(self):
        case = kerf.Case(plate(0.5) | {"boundary": [{"on": ["bottom", "top"], "traction": [0, numpy.hypot]}]})
        self.assertIs(case["boundary"][0]["traction"][1], numpy.hypot)

    def test_sweeps_take_what_was_changed(self):
        with tempfile.TemporaryDirectory() as folder:
            case = kerf.Case(TEXT)
            case["material"]["young"] = 2.0
            rows = kerf.sweep(case, {"mesh.size": [0.5, 0.25]}, folder=folder, jobs=1)
            self.assertEqual(rows.column("state.energy")[1], energy_of(kerf.Case(case, set={"mesh.size": 0.25})))
            kept = kerf.Case(pathlib.Path(folder) / "case.toml")
            self.assertEqual(kept["material"]["young"], 2.0)
            self.assertEqual(kerf.load(rows.folder / rows.rows[0]["run"])["state"]["energy"], rows.rows[0]["state.energy"])

    def test_a_dict_is_not_shared(self):
        document = plate()
        case = kerf.Case(document)
        document["mesh"]["size"] = -1
        case["material"]["young"] = 2.0
        self.assertEqual(case["mesh"]["size"], 0.25)
        self.assertEqual(document["material"]["young"], 1.0)


class Copies(unittest.TestCase):
    def test_they_share_nothing(self):
        case = kerf.Case(plate())
        case["mesh"]["size"] = 0.5
        for one in (copy.copy(case), copy.deepcopy(case), pickle.loads(pickle.dumps(case)), kerf.Case(case)):
            self.assertEqual(one.text(), case.text())
            one["mesh"]["size"] = 0.1
            one["crack"].append({"name": "d", "path": [[0.3, 0.2], [0.7, 0.2]]})
        self.assertEqual(case["mesh"]["size"], 0.5)
        self.assertEqual(case["crack"].names, ["c"])

    def test_files_are_found_from_elsewhere(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "plate.toml"
            path.write_text(TEXT + '[[probe]]\nname = "p"\nfile = "points.csv"\n')
            (path.parent / "points.csv").write_text("x,y\n0.5,0.5\n")
            again = pickle.loads(pickle.dumps(kerf.Case(path)))
            self.assertEqual(again.text(), kerf.Case(path).text())

    def test_spawned_processes(self):
        """Cases go there and numbers, results and errors come back."""
        case = kerf.Case(plate(0.5) | {"boundary": [TwoComponents.held, {"on": "top", "traction": pull}]})
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            self.assertEqual(pool.apply(energy_of, [case]), energy_of(case))
            there, here = pool.apply(result_of, [case]), case.map()
            with self.assertRaises(kerf.CaseError) as caught:
                pool.apply(fails, [case])
        self.assertEqual(caught.exception.where, "mesh.size")
        self.assertEqual(there["state"]["energy"], here["state"]["energy"])
        numpy.testing.assert_array_equal(there.stress, here.stress)
        numpy.testing.assert_array_equal(there.crack("c")["jump_n"], here.crack("c")["jump_n"])
        self.assertEqual(repr(there), repr(here))
        self.assertEqual(there.summary().splitlines()[0], here.summary().splitlines()[0])
        at = there.at(here.corner_points[:1])
        self.assertTrue(at.inside[0])

    def test_joblib(self):
        try:
            import joblib
        except ImportError:
            self.skipTest("joblib is not installed")
        cases = [kerf.Case(plate(size)) for size in (0.5, 0.4)]
        found = joblib.Parallel(2)(joblib.delayed(energy_of)(case) for case in cases)
        self.assertEqual(found, [energy_of(case) for case in cases])


class Meshes(unittest.TestCase):
    def test_names_and_numbers(self):
        case = kerf.Case(plate(0.2) | {"region": [{"name": "stiff", "circle": {"center": [0.5, 0.8], "radius": 0.1},
                                                   "young": 2.0, "poisson": 0.3}]})
        mesh = case.mesh()
        a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
        areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
        self.assertAlmostEqual(areas.sum(), 1, delta=1e-12)
        self.assertEqual(list(mesh.labels), ["bottom", "right", "top", "left"])
        top = mesh.points[mesh.labels["top"]]
        numpy.testing.assert_array_equal(top[..., 1], 1)
        self.assertAlmostEqual(abs(top[:, 1, 0] - top[:, 0, 0]).sum(), 1, delta=1e-12)
        crack = mesh.points[mesh.cracks["c"]]
        numpy.testing.assert_array_equal(crack[1:, 0], crack[:-1, 1])  # along its path
        numpy.testing.assert_allclose([crack[0, 0], crack[-1, 1]], [[0.3, 0.5], [0.7, 0.5]])
        self.assertAlmostEqual(areas[mesh.regions["stiff"]].sum(), numpy.pi * 0.01, delta=2e-3)
        result = case.solve()
        self.assertEqual(len(result.triangles), len(mesh.triangles))
        self.assertIn(f"{len(mesh.triangles)} triangles", repr(mesh))


class TwoComponents(unittest.TestCase):
    held = {"on": "bottom", "displacement": [0, 0]}

    def with_traction(self, traction):
        return kerf.Case(plate() | {"boundary": [self.held, {"on": "top", "traction": traction}]})

    def test_as_two_functions(self):
        a = self.with_traction(["0.1*x", "ny*(1 + x^2)"]).map()
        for function in (pull, lambda x, y, nx, ny: numpy.stack([0.1 * x, ny * (1 + x * x)]), for_arrays):
            b = self.with_traction(function).map()
            self.assertAlmostEqual(a["state"]["energy"], b["state"]["energy"], delta=1e-12)
            numpy.testing.assert_allclose(a.stress, b.stress, atol=1e-10)
            self.assertTrue(any("functions of a program" in note for note in b["state"]["notes"]))

    def test_body_forces_supports_and_targets(self):
        vectors = {"body": {"force": lambda x, y: (x, -1)},
                   "boundary": [{"on": "bottom", "displacement": lambda x, y: (0.01 * x, 0)}],
                   "functional": {"kind": "displacement_tracking", "target": lambda x, y: (x, y)}}
        parts = {"body": {"force": ["x", -1]}, "boundary": [{"on": "bottom", "displacement": ["0.01*x", 0]}],
                 "functional": {"kind": "displacement_tracking", "target": ["x", "y"]}}
        a, b = kerf.Case(plate() | vectors).solve(), kerf.Case(plate() | parts).solve()
        self.assertAlmostEqual(a["functional"]["value"], b["functional"]["value"], delta=1e-12)
        self.assertAlmostEqual(a["state"]["energy"], b["state"]["energy"], delta=1e-12)

    def test_no_guarantee_of_what_is_sampled(self):
        """The body force of an expression is enclosed, and its energy bounds are guaranteed; not those of a function."""
        with_bounds = {"bounds": {"compliance": True}}
        said = [kerf.Case(plate() | with_bounds | {"boundary": [self.held, {"on": "top", "traction": traction}]})
                .solve()["bounds"]["compliance"]["guaranteed"] for traction in ([0, "1"], lambda x, y: (0, 1))]
        self.assertEqual(said, [True, False])

    def test_what_is_wrong_with_it(self):
        for wrong, words in [(lambda x, y: 1.0, "returns both components"), (lambda x, y: (1, 2, 3), "both components"),
                             (lambda x, y: (0, float("nan")), "not finite"), (lambda x, y: ("a", 1), "ValueError")]:
            with self.assertRaises(kerf.CaseError) as caught:
                self.with_traction(wrong).solve()
            self.assertEqual(caught.exception.where, "boundary[1].traction")
            self.assertIn(words, str(caught.exception))
        with self.assertRaises(kerf.CaseError):
            kerf.Case(plate() | {"boundary": [{"on": "top", "pressure": lambda x, y: (0, 1)}]}).solve()


def for_arrays(x, y, nx, ny):
    out = numpy.empty((2, len(x)))
    out[0], out[1] = 0.1 * x, ny * (1 + x * x)
    return out


if __name__ == "__main__":
    unittest.main()
