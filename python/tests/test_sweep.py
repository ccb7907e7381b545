"""Sweeps in Python and by the program: kept, resumed, failed, written for clusters."""

import csv
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest
import warnings

import kerf

from plates import plate

PROGRAM = os.environ["KERF_PROGRAM"]
PATHS = [[[0.3, 0.5], [0.7, 0.5]], [[0.3, 0.4], [0.7, 0.6]]]
QUICK = {"output": {"vtk": False, "png": False}}


def table(folder):
    with open(folder / "sweep.csv", newline="") as file:
        return list(csv.DictReader(file))


class Sweeps(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        self.times = {}

    def sweep(self, over, case=None, **how):
        made = []
        out = kerf.sweep(case or plate(), over, folder=self.folder / "s", set=QUICK, on_run=made.append, **how)
        return out, made

    def program(self, *arguments, **how):
        return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, **how)

    def case_file(self):
        path = self.folder / "plate.toml"
        path.write_text(kerf.Case(plate(), name="plate").text())
        return path

    def test_every_value_with_every_other(self):
        out, made = self.sweep({"crack.c.path": PATHS, "material.poisson": [0.2, 0.4]}, jobs=2)
        self.assertEqual((len(out), len(made), out.failures), (4, 4, []))
        self.assertEqual(out.column("status"), ["ok"] * 4)
        single = kerf.Case(plate(), set={"crack.c.path": PATHS[1], "material.poisson": 0.2} | QUICK).run()
        row = out.rows[2]
        self.assertEqual(row["state.energy"], single["state"]["energy"])
        self.assertEqual(row["cracks.c.tips[1].K_I"], single["cracks"][0]["tips"][1]["K_I"])
        page = (out.folder / "sweep.html").read_text()
        self.assertIn("<svg", page)
        self.assertIn("srcdoc", out._repr_html_())

    def test_what_is_done_is_kept(self):
        self.assertEqual(len(self.sweep({"material.poisson": [0.2, 0.3]})[1]), 2)
        self.assertEqual(self.sweep({"material.poisson": [0.2, 0.3]})[1], [])
        out, made = self.sweep({"material.poisson": [0.3, 0.2, 0.1]})
        self.assertEqual((made, len(out)), (["poisson=0.1"], 3))
        changed = plate() | {"material": {"young": 2.0, "poisson": 0.3}}
        self.assertEqual(len(self.sweep({"material.poisson": [0.3, 0.2, 0.1]}, changed)[1]), 3)
        (out.folder / "poisson=0.1" / "result.json").unlink()
        self.assertEqual(self.sweep({"material.poisson": [0.3, 0.2, 0.1]}, changed)[1], ["poisson=0.1"])

    def test_failures_are_kept_and_listed(self):
        outside = [[0.3, 0.5], [1.7, 0.5]]
        out, made = self.sweep({"crack.c.path": [PATHS[0], outside]})
        self.assertEqual((len(made), len(out.failures)), (2, 1))
        self.assertIn("leaves the body", out.failures[0]["reason"])
        self.assertIn("leaves the body", out.summary())
        self.assertIn("leaves the body", (out.folder / "sweep.html").read_text())
        wrong, _ = self.sweep({"mesh.size": [0.25, -1]})
        self.assertIn("mesh.size", wrong.failures[0]["reason"])

    def test_a_process_that_is_killed_is_a_failure_and_run_again(self):
        def killed(x, y):
            if not (self.folder / "again").exists():
                os.kill(os.getpid(), 9)
            return 0.0

        case = plate() | {"body": {"force": [killed, 0]}}
        out, _ = self.sweep({"mesh.size": [0.3]}, case)
        self.assertIn("signal 9", out.failures[0]["reason"])
        (self.folder / "again").touch()
        out, made = self.sweep({"mesh.size": [0.3]}, case)
        self.assertEqual((len(made), out.failures), (1, []))

    def test_functions(self):
        case = plate() | {"boundary": [{"on": ["bottom", "top"], "traction": [0, lambda x, y, nx, ny: 2 * ny]}]}
        out, _ = self.sweep({"material.poisson": [0.2, 0.3]}, case)
        self.assertEqual(out.failures, [])
        self.assertEqual(self.sweep({"material.poisson": [0.2, 0.3]}, case)[1], [])
        case["boundary"][0]["traction"][1] = lambda x, y, nx, ny: 3 * ny
        self.assertEqual(len(self.sweep({"material.poisson": [0.2, 0.3]}, case)[1]), 2)
        with self.assertRaises(kerf.CaseError):
            self.sweep({"material.poisson": [0.2]}, case, write="slurm")

    def test_wrong_sweeps(self):
        self.assertRaises(kerf.CaseError, self.sweep, {})
        self.assertRaises(kerf.CaseError, self.sweep, {"mesh.size": []})
        self.assertRaises(kerf.CaseError, self.sweep, {"mesh.size": [0.3, 0.3]})

    def test_the_program(self):
        case, out = self.case_file(), self.folder / "p"
        over = ["--over", "material.poisson=[0.2, 0.3]", "--over", f"crack.c.path=[{PATHS[0]}]"]
        how = [case, "-o", out, "--jobs", 2, "--set", "output.png=false", "--set", "output.vtk=false"]
        first = self.program("sweep", *how, *over)
        self.assertEqual((first.returncode, first.stderr.count("of 2 runs")), (0, 2), first.stderr)
        again = self.program("sweep", *how, *over)
        self.assertEqual((again.returncode, again.stderr.count("of 2 runs")), (0, 0), again.stderr)
        self.assertIn("2 of 2 runs done", again.stdout)
        rows = table(out)
        same, _ = self.sweep({"material.poisson": [0.2, 0.3]})
        self.assertEqual([float(row["state.energy"]) for row in rows], same.column("state.energy"))
        failed = self.program("sweep", *how, "--over", "material.poisson=[0.3, 0.7]")
        self.assertEqual(failed.returncode, 4)
        self.assertIn("1 of 2 runs failed", failed.stderr)
        self.assertIn("failed: poisson=0.7", failed.stdout)
        for wrong, words in [("mesh.size=0.1", "write a list"), ("mesh.size", "values are missing"),
                             ("crack.d.path=[1]", "or a name: c"), ("mesh.size=[1,", "--over mesh.size")]:
            said = self.program("sweep", *how, "--over", wrong)
            self.assertEqual(said.returncode, 2, said.stderr)
            self.assertIn(words, said.stderr)

    def test_slurm(self):
        """The script that an array job runs, with the number of a task as Slurm sets it."""
        case, out = self.case_file(), self.folder / "p"
        how = ["sweep", case, "-o", out, "--over", "mesh.size=[0.3, 0.25]", "--over", "material.poisson=[0.3, 0.7]"]
        said = self.program(*how, "--write", "slurm")
        self.assertIn("sbatch sweep.sbatch", said.stdout)
        codes = [subprocess.run(["bash", "sweep.sbatch"], cwd=out, env=os.environ | {
            "SLURM_ARRAY_TASK_ID": str(task), "PATH": f"{pathlib.Path(PROGRAM).parent}:{os.environ['PATH']}"}).returncode
            for task in (1, 2, 3, 5)]
        self.assertEqual(codes, [0, 2, 0, 2])
        said = self.program(*how, "--collect")
        self.assertIn("2 of 4 runs done, 1 failed, 1 not yet run", said.stdout)

    def test_snakemake(self):
        if not shutil.which("snakemake"):
            self.skipTest("snakemake is not installed")
        out = self.folder / "p"
        typed = kerf.sweep(self.case_file(), {"mesh.size": [0.3, 0.25], "material.poisson": [0.3, 0.7]}, folder=out,
                           write="snakemake")
        self.assertIn("snakemake --cores 2", typed)
        done = subprocess.run(["snakemake", "--cores", "2", "--quiet"], cwd=out, capture_output=True, text=True,
                              env=os.environ | {"PATH": f"{pathlib.Path(PROGRAM).parent}:{os.environ['PATH']}"})
        rows = table(out)
        self.assertEqual((done.returncode, [row["status"] for row in rows]), (0, ["ok", "failed"] * 2), done.stderr)

    def test_dask(self):
        try:
            import distributed
        except ImportError:
            self.skipTest("dask.distributed is not installed")
        warnings.simplefilter("ignore")  # of dask's own
        self.addCleanup(warnings.resetwarnings)
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, \
                distributed.Client(cluster) as client:
            case = plate() | {"body": {"force": [lambda x, y: 0.0, 0]}}
            out, made = self.sweep({"material.poisson": [0.1, 0.2, 0.3, 0.7]}, case, client=client)
        self.assertEqual((len(made), out.column("status")), (4, ["ok"] * 3 + ["failed"]))


if __name__ == "__main__":
    unittest.main()
