"""Cases, results, arrays, functions of Python, errors, interruptions."""

import gc
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import kerf
import numpy

from plates import beam_with_a_hole, plate


class Cases(unittest.TestCase):
    def assertRaisesWith(self, case, where, words, of=kerf.CaseError):
        with self.assertRaises(of) as caught:
            kerf.Case(case).solve()
        self.assertIn(words, str(caught.exception))
        self.assertEqual(caught.exception.where, where)
        self.assertEqual(caught.exception.exit_code, of.exit_code)

    def test_errors_name_the_key(self):
        self.assertRaisesWith(plate() | {"mesh": {"size": -1}}, "mesh.size",
                              "mesh.size: size in [mesh] must be positive, not -1")
        self.assertRaisesWith(plate() | {"mehs": {}}, "mehs", 'did you mean "mesh"?')
        self.assertRaisesWith(plate() | {"boundary": [{"on": "topp", "pressure": 1}]}, "boundary[0].on",
                              'no label "topp"')
        self.assertRaisesWith(plate() | {"crack": [{"name": "c", "path": [[0, 0], [1, "a"]]}]}, "crack[0].path[1][1]",
                              "must be a number")
        self.assertRaisesWith(plate() | {"material": {"young": 1}}, "material", 'missing key "poisson"')
        self.assertRaisesWith(plate() | {"mesh": {"size": None}}, "mesh.size", "None is no value")
        self.assertRaisesWith(plate() | {"mesh": {1: 2}}, "mesh", "keys are strings")
        self.assertRaisesWith(plate() | {"mesh": {"size": 2**70}}, "mesh.size", "does not fit")
        self.assertRaisesWith(plate() | {"mesh": {"size": {1}}}, "mesh.size", "is no value of a case")

    def test_a_class_per_exit_code(self):
        self.assertRaisesWith(plate() | {"crack": [{"name": "c", "path": [[0.5, 0.5], [1.5, 0.5]]}]}, None, "crack 'c'",
                              kerf.GeometryError)
        with self.assertRaises(kerf.FilesError) as caught:
            kerf.Case("nowhere.toml")
        self.assertEqual(caught.exception.exit_code, 5)
        with self.assertRaises(kerf.CaseError):
            kerf.Case(plate()).validate()
        self.assertTrue(issubclass(kerf.SolveError, kerf.Error))

    def test_overrides(self):
        case = kerf.Case(plate(), set={"crack.c.contact": "open", "mesh.size": 0.5, "output.png": False})
        self.assertIn('"contact" = "open"', case.text().replace("contact =", '"contact" ='))
        with self.assertRaises(kerf.CaseError) as caught:
            kerf.Case(plate(), set={"crack.d.contact": "open"})
        self.assertIn("or a name: c", str(caught.exception))
        with self.assertRaises(kerf.CaseError):
            kerf.Case(plate(), set={"body.force[0]": lambda x, y: 0})

    def test_numpy_and_paths_are_values(self):
        case = plate()
        case["domain"]["outline"] = numpy.array(case["domain"]["outline"], dtype=numpy.float32)
        case["mesh"]["size"] = numpy.float64(0.25)
        case["crack"] = tuple(case["crack"])
        self.assertEqual(kerf.Case(case).text(), kerf.Case(plate() | {"domain": {
            "outline": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            "sides": ["bottom", "right", "top", "left"]}}).text())
        self.assertIn("left", kerf.Case(plate()).check())

    def test_a_case_that_contains_itself(self):
        case = plate()
        case["mesh"]["size"] = case
        self.assertRaises(kerf.CaseError, kerf.Case, case)


class Results(unittest.TestCase):
    def test_arrays_are_windows_that_hold_their_owner(self):
        result = kerf.Case(plate()).map()
        n, m, k = len(result.points), len(result.triangles), len(result.corner_points)
        self.assertEqual(result["mesh"]["triangles"], m)
        self.assertGreater(k, n)  # the crack has two sides
        self.assertEqual(result.stress.shape, (k, 4))
        self.assertEqual(result.error_indicator.shape, (m,))
        numpy.testing.assert_array_equal(result.corner_points, result.points[result.corner_vertex])
        self.assertTrue((result.corner_vertex[result.corner_triangles] == result.triangles).all())
        for name in ("points", "stress", "displacement", "topological_derivative", "corner_triangles"):
            array = getattr(result, name)
            self.assertFalse(array.flags.owndata or array.flags.writeable, name)
        least = numpy.ma.array(result.topological_derivative, mask=result.masked).min()
        self.assertLessEqual(least, result["map"]["min"]["value"])
        stress, opening = result.stress, result.crack("c")["jump_n"]
        before = stress.copy(), opening.copy()
        folder = result.folder
        del result
        gc.collect()
        self.assertFalse(folder.exists())  # files go with the result, arrays stay
        kerf.Case(plate()).solve()
        numpy.testing.assert_array_equal(stress, before[0])
        numpy.testing.assert_array_equal(opening, before[1])

    def test_cracks(self):
        result = kerf.Case(plate()).solve()
        crack = result.crack("c")
        self.assertAlmostEqual(crack["jump_n"].max(), result["cracks"][0]["max_opening"], delta=1e-15)
        self.assertFalse(crack["closed"].any())
        self.assertRaises(KeyError, result.crack, "d")
        self.assertNotIn("map", result)
        with self.assertRaises(AttributeError) as caught:
            result.topological_derivative
        self.assertIn("von_mises", str(caught.exception))

    def test_the_page(self):
        with tempfile.TemporaryDirectory() as folder:
            result = kerf.Case(plate()).solve(pathlib.Path(folder) / "out")
            self.assertTrue((result.folder / "state.vtu").exists())
            self.assertEqual(result.page(), (result.folder / "report.html").read_text())
            self.assertIn("srcdoc", result._repr_html_())
            self.assertRaises(kerf.FilesError, kerf.Case(plate()).solve, result.folder)
            kerf.Case(plate()).solve(result.folder, force=True)

    def test_other_libraries(self):
        result = kerf.Case(plate()).map()
        try:
            import meshio  # noqa: F401
        except ImportError:
            self.skipTest("meshio is not installed")
        mesh = result.to_meshio()
        self.assertEqual(len(mesh.cells_dict["triangle"]), len(result.triangles))
        numpy.testing.assert_array_equal(mesh.point_data["von_mises"], result.von_mises)

    def test_vtk(self):
        try:
            import vtkmodules  # noqa: F401
        except ImportError:
            self.skipTest("VTK's Python modules are not installed")
        result = kerf.Case(plate()).map()
        grid = result.to_vtk()
        self.assertEqual(grid.GetNumberOfCells(), len(result.triangles))
        values = grid.GetPointData().GetArray("topological_derivative")
        self.assertEqual(values.GetValue(3), result.topological_derivative[3])

    def test_matplotlib(self):
        try:
            import matplotlib

            matplotlib.use("Agg")
        except ImportError:
            self.skipTest("matplotlib is not installed")
        result = kerf.Case(plate()).solve()
        self.assertEqual(len(result.triangulation(scale=0.1).triangles), len(result.triangles))


class Functions(unittest.TestCase):
    def test_a_function_is_an_expression(self):
        written, called = plate(), plate()
        held = {"on": "bottom", "displacement": [0, 0]}
        written["boundary"] = [held, {"on": "top", "traction": ["0.1*x", "ny*(1 + x^2)"]}]
        called["boundary"] = [held, {"on": "top",
                                     "traction": [lambda x, y: 0.1 * x, lambda x, y, nx, ny: ny * (1 + x * x)]}]
        a, b = kerf.Case(written).map(), kerf.Case(called).map()
        self.assertAlmostEqual(a["state"]["energy"], b["state"]["energy"], delta=1e-12)
        numpy.testing.assert_allclose(a.stress, b.stress, atol=1e-10)
        self.assertTrue(any("functions of a program" in note for note in b["state"]["notes"]))
        self.assertFalse(any("functions of a program" in note for note in a["state"].get("notes", [])))
        self.assertIn('"function Functions.', kerf.Case(called).text())

    def test_numpy_functions_and_objects(self):
        case = plate() | {"body": {"force": [numpy.hypot, Field()]},
                          "boundary": [{"on": "bottom", "displacement": [0, 0]}]}
        self.assertTrue(numpy.isfinite(kerf.Case(case).solve()["state"]["energy"]))

    def test_what_a_function_raises(self):
        def fails(x, y):
            raise ZeroDivisionError("no luck")

        with self.assertRaises(kerf.CaseError) as caught:
            kerf.Case(plate() | {"body": {"force": [0, fails]}}).solve()
        self.assertIsInstance(caught.exception.__cause__, ZeroDivisionError)
        self.assertEqual(caught.exception.where, "body.force[1]")
        for wrong, words in [(lambda x, y: float("nan"), "not finite"), (lambda x, y: "a", "TypeError"),
                             (lambda x: x, "takes 2 arguments"), (lambda x, y, z: x, "takes 2 arguments")]:
            with self.assertRaises(kerf.CaseError) as caught:
                kerf.Case(plate() | {"body": {"force": [0, wrong]}}).solve()
            self.assertIn(words, str(caught.exception))

    def test_where_no_expression_goes(self):
        with self.assertRaises(kerf.CaseError) as caught:
            kerf.Case(plate() | {"mesh": {"size": lambda x, y: 0.1}})
        self.assertIn("must be a number, not a function", str(caught.exception))


class Field:
    def __call__(self, x, y):
        return 0.1 * x


class Optimizations(unittest.TestCase):
    case = beam_with_a_hole()

    def test_iterations_are_told(self):
        seen, phases = [], []
        result = kerf.Case(self.case).optimize(on_iteration=seen.append, on_phase=phases.append)
        self.assertEqual([row["iteration"] for row in seen], list(range(len(seen))))
        self.assertEqual(seen[-1]["objective"], result["optimize"]["objective"])
        self.assertIn("optimize", phases)

    def test_what_a_callback_raises_ends_it(self):
        def enough(row):
            raise StopIteration(row["iteration"])

        with self.assertRaises(StopIteration):
            kerf.Case(self.case).optimize(on_iteration=enough)
        self.assertEqual(kerf.Case(self.case).solve().status, "ok")


class Growth(unittest.TestCase):
    def test_steps_are_told(self):
        case = kerf.Case({
            "domain": {"outline": [[-4, -4], [4, -4], [4, 4], [-4, 4]], "sides": ["bottom", "right", "top", "left"]},
            "crack": [{"name": "c", "path": [[-0.5, 0], [0.5, 0]]}],
            "material": {"young": 1000.0, "poisson": 0.3},
            "boundary": [{"on": "bottom", "displacement_y": 0}, {"on": "top", "traction": [0, 1]}],
            "mesh": {"size": 1}, "solver": {"degree": 1},
            "grow": {"law": {"kind": "paris", "C": 1e-6, "m": 3}, "step": 0.2, "until": {"steps": 2}}})
        seen = []
        result = case.grow(on_step=seen.append)
        self.assertEqual([s["step"] for s in seen], [0, 1, 2])
        self.assertEqual(seen[-1]["cycles"], result["grow"]["steps"][-1]["cycles"])
        self.assertEqual([t["tip"] for t in seen[0]["tips"]], ["c:end", "c:start"])

        def enough(step):
            raise StopIteration(step["step"])

        with self.assertRaises(StopIteration):
            case.grow(on_step=enough)


class Inspections(unittest.TestCase):
    def test_worst_cracks(self):
        """Of a strip in tension: 1.1215 stress sqrt(pi a) at its sides, stress sqrt(pi a/2) inside."""
        strip = {
            "domain": {"outline": [[0, 0], [4, 0], [4, 8], [0, 8]], "sides": ["bottom", "right", "top", "left"]},
            "material": {"young": 100.0, "poisson": 0.3},
            "boundary": [{"on": "top", "traction": [0, 1]}, {"on": "bottom", "traction": [0, -1]}],
            "mesh": {"size": 0.5},
        }
        normal = {"map.perturbation": "edge_crack", "map.length": 0.2, "map.angle": 90}
        cracks = kerf.Case(strip, set=normal).inspect(0.1)["edge_cracks"]
        self.assertEqual(cracks["length"], 0.1)
        self.assertAlmostEqual(cracks["worst"][0]["K"], 1.1215 * math.sqrt(math.pi * 0.1), delta=1e-3)
        self.assertAlmostEqual(cracks["inside"][0]["K"], math.sqrt(math.pi * 0.05), delta=1e-4)
        self.assertEqual(cracks["inside"][0]["K_II"], 0)
        law = {"inspect": {"law": {"kind": "paris", "C": 1e-6, "m": 3, "K_c": 5.0}},
               "map": {"perturbation": "edge_crack", "length": 0.1}}
        worst = kerf.Case({**strip, **law}).inspect()["edge_cracks"]["worst"][0]
        self.assertGreater(worst["cycles"], 0)
        with self.assertRaises(kerf.CaseError):
            kerf.Case(strip).inspect(-1)


class Interruptions(unittest.TestCase):
    def test_ctrl_c(self):
        """It ends what is being computed: the map, which comes after it, does not begin."""
        case = kerf.Case(plate(0.004))  # tens of seconds
        phases, solving = [], threading.Event()

        def on_phase(name):
            phases.append(name)
            if "solve" in name:
                solving.set()

        def interrupt():
            if solving.wait(300):
                os.kill(os.getpid(), signal.SIGINT)

        thread = threading.Thread(target=interrupt)
        thread.start()
        with self.assertRaises(KeyboardInterrupt):
            case.map(on_phase=on_phase)
        thread.join()
        self.assertTrue(solving.is_set())
        self.assertNotIn("map", phases)
        self.assertEqual(kerf.Case(plate()).solve().status, "ok")

    def test_python_goes_on_meanwhile(self):
        count = 0
        done = threading.Event()
        thread = threading.Thread(target=lambda: (kerf.Case(plate(0.03)).map(), done.set()))
        thread.start()
        while not done.is_set():
            count += 1
            time.sleep(0.001)
        thread.join()
        self.assertGreater(count, 20)

    def test_threads_of_others_are_given_back(self):
        """OpenBLAS is made to use one thread while kerf computes, and then what it used before."""
        said = subprocess.run([sys.executable, "-c", """
import ctypes, kerf, sys
sys.path.insert(0, ".")
from plates import beam_with_a_hole, plate
blas = ctypes.CDLL("libopenblas.so.0")
blas.openblas_set_num_threads(2)
kerf.Case(plate()).solve()
print(blas.openblas_get_num_threads())
"""], capture_output=True, text=True)
        if "cannot open shared object" in said.stderr:
            self.skipTest("another BLAS")
        self.assertEqual(said.stdout, "2\n", said.stderr)


if __name__ == "__main__":
    unittest.main()
