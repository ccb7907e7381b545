"""Results: values at points, cracks and load cases by name, loading, tables, pictures, designs."""

import copy
import math
import os
import pathlib
import pickle
import shutil
import tempfile
import unittest

import kerf
import numpy

from plates import beam_with_a_hole, plate


def linear():
    """A body whose displacement is linear: u = (a x, b y) with stress (1, 2)."""
    return {
        "domain": {"outline": [[0, 0], [2, 0], [2, 1], [0, 1]], "sides": ["bottom", "right", "top", "left"]},
        "material": {"young": 10.0, "poisson": 0.25, "state": "plane stress"},
        "boundary": [{"on": "left", "displacement_x": 0}, {"on": "bottom", "displacement_y": 0},
                     {"on": "right", "traction": [1, 0]}, {"on": "top", "traction": [0, 2]}],
        "mesh": {"size": 0.5},
        "map": {"perturbation": "hole"},
    }


class Points(unittest.TestCase):
    def check_linear(self, result, tolerance):
        points = numpy.array([[[0.3, 0.4], [1.7, 0.9]], [[0, 0], [3, 0.5]]])
        at = result.at(points)
        self.assertEqual(at.inside.tolist(), [[True, True], [True, False]])
        x, y = points[at.inside].T
        numpy.testing.assert_allclose(at.displacement[at.inside], numpy.column_stack([0.05 * x, 0.175 * y]), atol=tolerance)
        numpy.testing.assert_allclose(at.stress[at.inside], [[1, 0, 0, 2]] * 3, atol=tolerance)
        numpy.testing.assert_allclose(at.von_mises[at.inside], math.sqrt(3), atol=tolerance)
        self.assertEqual(at.stress.shape, (2, 2, 4))
        for name in ("displacement", "stress", "von_mises", "topological_derivative"):
            self.assertTrue(numpy.isnan(at[name][1, 1]).all(), name)
        self.assertFalse(at.masked[1, 1])
        T = at.topological_derivative[at.inside]
        numpy.testing.assert_allclose(T, T[0], rtol=1e3 * tolerance)
        return T[0]

    def test_a_linear_field(self):
        """Also linear between corners; T of a hole in plane stress, per its area, is -((s1 + s2)^2 + 2 (s1 - s2)^2)/(2 E)
        of the potential energy."""
        result = kerf.Case(linear()).map()
        T = -(3**2 + 2 * 1**2) / (2 * 10)
        self.assertAlmostEqual(self.check_linear(result, 1e-10), T, delta=1e-8)
        self.assertAlmostEqual(self.check_linear(pickle.loads(pickle.dumps(result)), 1e-9), T, delta=1e-8)
        single = result.at([0.3, 0.4])
        self.assertEqual((single.displacement.shape, single.stress.shape, single.von_mises.shape), ((2,), (4,), ()))
        self.assertIn("1 points, 1 inside", repr(single))

    def test_as_probes_and_map_points(self):
        """The same numbers, to the last bit but for rounding."""
        case = kerf.Case(plate() | {"probe": [{"name": "p", "points": [[0.2, 0.31], [0.52, 0.77]]}],
                                    "output": {"png": False, "vtk": False}})
        with tempfile.TemporaryDirectory() as folder:
            result = case.run(pathlib.Path(folder) / "out")
            rows = numpy.genfromtxt(result.folder / "probe_p.csv", delimiter=",", names=True)
        at = result.at([[0.2, 0.31], [0.52, 0.77]])
        numpy.testing.assert_allclose(at.displacement[:, 1], rows["u_y"], rtol=1e-13)
        numpy.testing.assert_allclose(at.stress[:, 3], rows["s_yy"], rtol=1e-13)
        numpy.testing.assert_allclose(at.topological_derivative, rows["topological_derivative"], rtol=1e-13)

    def test_a_clamped_hole(self):
        """Its predicted change is known at corners: there exactly."""
        hole = {"perturbation": "clamped_hole", "radius": 0.01}
        result = kerf.Case(linear() | {"mesh": {"size": 0.2}, "map": hole}).map()
        free = numpy.flatnonzero(~result.masked)
        at = result.at(result.corner_points[free])
        numpy.testing.assert_allclose(at.topological_derivative, result.topological_derivative[free], rtol=1e-9)

    def test_both_sides_of_a_crack(self):
        """What jumps there does: just above and below the middle, by the opening."""
        result = kerf.Case(plate(0.1)).solve()
        above, below = result.at([[0.5, 0.5 + 1e-9], [0.5, 0.5 - 1e-9]]).displacement
        middle = numpy.interp(0.2, result.cracks["c"].s, result.cracks["c"].jump_n)
        self.assertAlmostEqual(above[1] - below[1], middle, delta=0.01 * middle)

    def test_wrong_shapes(self):
        result = kerf.Case(plate(0.5)).solve()
        self.assertRaisesRegex(ValueError, "along the last axis", result.at, [1, 2, 3])
        self.assertRaisesRegex(AttributeError, "they have points, displacement", lambda: result.at([0, 0]).masked)
        self.assertEqual(result.at(numpy.empty((0, 2))).stress.shape, (0, 4))
        self.assertFalse(result.at([float("nan"), 0]).inside)

    def test_the_factor_is_gone(self):
        """Results keep the solution alone: every further one adds much less than its solve took."""
        case = kerf.Case(plate(0.03))
        first = case.solve()
        before = resident()
        kept = [case.solve() for _ in range(4)]
        self.assertLess((resident() - before) / 4, 0.5 * first["peak_memory_mb"])
        self.assertTrue(all(one.at([0.2, 0.2]).inside for one in kept))


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


class Names(unittest.TestCase):
    def test_cracks_and_tips(self):
        case = plate(0.1) | {"crack": [{"name": "c", "path": [[0.3, 0.5], [0.7, 0.5]]},
                                       {"name": "edge", "path": [[0, 0.2], [0.2, 0.2]]},
                                       {"name": "back", "path": [[0.8, 0.8], [1, 0.8]]}]}
        result = kerf.Case(case).solve()
        self.assertEqual(result.cracks.names, ["c", "edge", "back"])
        c = result.cracks["c"]
        self.assertEqual(c.tips.names, ["start", "end"])
        self.assertEqual(c.tips["end"].K_I, result["cracks"][0]["tips"][1]["K_I"])
        self.assertEqual(c.tips["end"].at, [0.7, 0.5])
        self.assertEqual(c.tips["end"].margin.K_I, c.tips["end"]["margin"]["K_I"])
        self.assertEqual(result.cracks["edge"].tips.names, ["end"])
        self.assertEqual(result.cracks["back"].tips.names, ["start"])
        self.assertEqual(c.max_opening, c["max_opening"])
        numpy.testing.assert_array_equal(c.jump_n, result.crack("c")["jump_n"])
        self.assertRegex(repr(c.tips["end"]), r"'end' at \(0.7, 0.5\): K_I 1\.\d+, K_II 0\.\d+, G 1\.\d+")
        self.assertIn("K_I", repr(result))
        self.assertIn(f"{result['mesh']['triangles']} triangles, ", repr(result))
        with self.assertRaisesRegex(AttributeError, "there is"):
            c.tips["end"].K_III
        with self.assertRaisesRegex(KeyError, "'start', 'end'"):
            c.tips["left"]

    def test_load_cases(self):
        case = plate() | {"boundary": [{"on": "bottom", "displacement": [0, 0]}], "functional": {"kind": "compliance"},
                          "optimize": {"method": "level-set", "volume": {"at_most": 0.9}}, "load_case": [
            {"name": "pull", "boundary": [{"on": "top", "traction": [0, 1]}]},
            {"name": "shear", "weight": 2, "boundary": [{"on": "top", "traction": [1, 0]}]}]}
        result = kerf.Case(case).solve()
        self.assertEqual(result.load_cases.names, ["pull", "shear"])
        self.assertEqual(result.load_cases["shear"].compliance, result["load_cases"][1]["compliance"])
        self.assertEqual(result.load_cases["shear"].weight, 2)
        self.assertGreater(result.load_cases[0].max_von_mises.value, 0)
        self.assertEqual(len(kerf.Case(plate()).solve().load_cases), 0)


class Loading(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def test_a_folder(self):
        made = kerf.Case(plate(0.1)).map(self.folder / "out")
        loaded = kerf.load(self.folder / "out")
        self.assertEqual(loaded.numbers, made.numbers)
        self.assertEqual(loaded.summary(), made.summary())
        self.assertEqual(loaded.cracks["c"].tips["end"].K_I, made.cracks["c"].tips["end"].K_I)
        numpy.testing.assert_array_equal(loaded.crack("c")["jump_n"], made.crack("c")["jump_n"])
        self.assertIn("loaded from", repr(loaded))
        self.assertEqual(kerf.load(self.folder / "out" / "result.json").status, "ok")
        if not (self.folder / "out" / "state.vtu").exists():
            self.skipTest("VTK is not installed")
        numpy.testing.assert_array_equal(loaded.corner_points, made.corner_points)
        numpy.testing.assert_array_equal(loaded.displacement, made.displacement)
        numpy.testing.assert_array_equal(loaded.von_mises, made.von_mises)
        numpy.testing.assert_array_equal(loaded.topological_derivative, made.topological_derivative)
        numpy.testing.assert_array_equal(loaded.error_indicator, made.error_indicator)
        self.assertTrue(loaded.masked[made.masked].all())
        self.assertLess(loaded.masked.mean(), 0.9)
        points = [[0.2, 0.31], [0.52, 0.77]]
        a, b = loaded.at(points), copy.deepcopy(made).at(points)
        numpy.testing.assert_allclose(a.displacement, b.displacement, rtol=1e-12)
        numpy.testing.assert_allclose(a.displacement, made.at(points).displacement, atol=0.01)  # the mesh is coarse

    def test_without_vtk(self):
        """The page's arrays, in single precision; without a page a sentence."""
        case = kerf.Case(plate())
        case["output"] = {"vtk": False}
        made = case.map(self.folder / "page")
        loaded = kerf.load(self.folder / "page")
        numpy.testing.assert_allclose(loaded.displacement, made.displacement, rtol=1e-6, atol=1e-7)
        self.assertTrue(loaded.masked[made.masked].all())
        numpy.testing.assert_allclose(loaded.at([0.2, 0.31]).von_mises, copy.deepcopy(made).at([0.2, 0.31]).von_mises,
                                      rtol=1e-5)
        case["output"] = {"vtk": False, "html": False}
        case.solve(self.folder / "bare")
        bare = kerf.load(self.folder / "bare")
        self.assertLess(bare["state"]["energy"], 0)
        for asked in (lambda: bare.at([0, 0]), bare.plot, bare.to_pandas):
            self.assertRaisesRegex(kerf.FilesError, "has no fields: neither state.vtu", asked)
        self.assertRaisesRegex(AttributeError, "neither state.vtu", lambda: bare.von_mises)

    def test_angles_are_radians(self):
        case = kerf.Case(plate() | {"map": {"perturbation": "crack"}})
        for name, vtk in (("vtk", True), ("page", False)):
            case["output"] = {"vtk": vtk, "png": False}
            made = case.map(self.folder / name)
            numpy.testing.assert_allclose(kerf.load(made.folder).angle, made.angle, rtol=1e-6, atol=1e-7)

    def test_what_is_no_result(self):
        self.assertRaisesRegex(kerf.FilesError, "no result.json in it", kerf.load, self.folder)
        for text in ("{}", "[1, 2", '{"schema": 1}'):
            (self.folder / "result.json").write_text(text)
            self.assertRaises(kerf.FilesError, kerf.load, self.folder)


class Designs(unittest.TestCase):
    case = beam_with_a_hole(name="h")

    def test_gradients(self):
        """Central differences, on a mesh that moves along."""
        designs = kerf.Case(self.case).designs(threads=1)
        self.assertEqual(designs.names, ["h.x", "h.y", "h.radius"])
        numpy.testing.assert_array_equal(designs.start, [1.0, 0.5, 0.15])
        values = designs.evaluate(designs.start)
        self.assertAlmostEqual(values.volume_fraction, 1 - math.pi * 0.15**2 / 2, delta=1e-12)
        self.assertEqual(len(values.constraints), len(designs.constraints))
        for k in range(3):
            step = 1e-4 * numpy.eye(3)[k]
            up, down = (designs.evaluate(designs.start + s * step, gradient=False) for s in (1, -1))
            self.assertAlmostEqual((up.value - down.value) / 2e-4, values.gradient[k],
                                   delta=1e-4 * abs(values.gradient).max())
            numpy.testing.assert_allclose((up.constraints - down.constraints) / 2e-4, values.jacobian[:, k], atol=1e-3)

    def test_failures_and_mistakes(self):
        designs = kerf.Case(self.case).designs()
        with self.assertRaisesRegex(kerf.CaseError, "outside of its bounds"):
            designs.evaluate([0, 0, 0])
        with self.assertRaisesRegex(kerf.CaseError, "has 3 numbers"):
            designs.evaluate([1, 0.5])
        with self.assertRaisesRegex(kerf.CaseError, "no table"):
            kerf.Case(plate()).designs()

    def test_scipy(self):
        try:
            import scipy.optimize
        except ImportError:
            self.skipTest("SciPy is not installed")
        designs = kerf.Case(self.case).designs()
        found = scipy.optimize.minimize(**designs.scipy(), method="SLSQP", options={"maxiter": 8})
        self.assertLess(found.fun, designs.evaluate(designs.start).value)

    def test_a_design_is_a_case(self):
        """Solved again it has the objective that the optimization found, but for the mesh."""
        result = kerf.Case(self.case).optimize()
        again = pickle.loads(pickle.dumps(result)).design.solve()
        design = result.design
        self.assertEqual(design.text(), pickle.loads(pickle.dumps(design)).text())
        self.assertAlmostEqual(again["state"]["compliance"] / result["optimize"]["objective"], 1, delta=0.02)
        with self.assertRaisesRegex(kerf.CaseError, "has no design"):
            kerf.Case(plate()).solve().design

    def test_functions_come_back(self):
        case = self.case | {"boundary": [self.case["boundary"][0], {"on": "right", "traction": lambda x, y: (0, -1)}]}
        result = kerf.Case(case).optimize()
        self.assertIs(result.design["boundary"][1]["traction"], case["boundary"][1]["traction"])
        with self.assertRaisesRegex(kerf.CaseError, "was made with functions of Python"):
            pickle.loads(pickle.dumps(result)).design


class Libraries(unittest.TestCase):
    def test_plots(self):
        try:
            import matplotlib

            matplotlib.use("Agg")
            import matplotlib.pyplot as plt
        except ImportError:
            self.assertRaisesRegex(ImportError, "needs matplotlib, which is not installed: pip",
                                   kerf.Case(plate()).solve().plot)
            self.skipTest("matplotlib is not installed")
        result = kerf.Case(plate()).map()
        for field in ("von_mises", "displacement", "displacement_x", "stress_xy", "topological_derivative",
                      "error_indicator", "mesh"):
            axes = result.plot(field, scale=0.1 if field == "displacement" else 0, edges=field == "stress_xy")
            axes.figure.canvas.draw()
            plt.close(axes.figure)
        axes = result.plot("von_mises", log=True, ax=plt.figure().add_subplot())
        self.assertRaisesRegex(ValueError, "there is mesh, displacement", result.plot, "temperature")
        kerf.Case(plate()).mesh().plot(axes)
        plt.close("all")

    def test_tables(self):
        try:
            import pandas
        except ImportError:
            self.assertRaisesRegex(ImportError, "needs pandas, which is not installed: pip",
                                   kerf.Case(plate()).solve().to_pandas)
            self.skipTest("pandas is not installed")
        result = kerf.Case(plate()).map()
        fields = result.to_pandas()
        self.assertIsInstance(fields, pandas.DataFrame)
        self.assertEqual(len(fields), len(result.corner_points))
        self.assertEqual(list(fields)[:7], ["x", "y", "u_x", "u_y", "s_xx", "s_yy", "s_xy"])
        tips = result.to_pandas("tips")
        self.assertEqual(tips["K_I"][1], result.cracks["c"].tips["end"].K_I)
        self.assertEqual(len(result.to_pandas("c")), len(result.crack("c")["s"]))
        self.assertEqual(len(result.at([[0.2, 0.2], [0.3, 0.3]]).to_pandas()), 2)
        self.assertRaisesRegex(ValueError, "there is fields, tips", result.to_pandas, "nodes")

    def test_pyvista(self):
        result = kerf.Case(plate()).map()
        try:
            import pyvista  # noqa: F401
        except ImportError:
            self.assertRaisesRegex(ImportError, "needs pyvista, which is not installed: pip", result.to_pyvista)
            self.skipTest("PyVista is not installed")
        grid = result.to_pyvista()
        self.assertEqual(grid.n_cells, len(result.triangles))
        numpy.testing.assert_array_equal(grid.point_data["von_mises"], result.von_mises)


if __name__ == "__main__":
    unittest.main()
