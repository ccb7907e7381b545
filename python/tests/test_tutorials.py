"""Tutorials run, docs/python.md says what is so, and everything public is documented."""

import ast
import contextlib
import inspect
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import kerf

SOURCE = pathlib.Path(os.environ["KERF_SOURCE"])


class Tutorials(unittest.TestCase):
    def run_script(self, name):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, SOURCE / "docs" / "tutorials" / name], cwd=folder, capture_output=True,
                                  text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_parameter_study(self):
        self.run_script("parameter_study.py")

    def test_k_of_a(self):
        self.run_script("k_of_a.py")

    def test_own_optimizer(self):
        self.run_script("own_optimizer.py")

    def test_calibration(self):
        self.run_script("calibration.py")


class Pages(unittest.TestCase):
    def test_python_page(self):
        """Its blocks of code, one after the other in a folder of their own. A block for a library that is missing ends
        with its sentence."""
        text = (SOURCE / "docs" / "python.md").read_text(encoding="utf-8")
        blocks = re.findall(r"^```python\n(.*?)^```$", text, re.M | re.S)
        self.assertGreater(len(blocks), 5)
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                names = {"__name__": "page"}
                for block in blocks:
                    try:
                        with contextlib.redirect_stdout(io.StringIO()):
                            exec(compile(block, "docs/python.md", "exec"), names)
                    except ImportError as error:
                        self.assertRegex(str(error), "which is not installed: pip install|No module named '(scipy|joblib)'")
            finally:
                os.chdir(here)

    def test_everything_is_documented(self):
        """The stubs have what there is, with the arguments that it takes, and a docstring or a type."""
        tree = ast.parse((pathlib.Path(kerf.__file__).parent / "__init__.pyi").read_text(encoding="utf-8"))
        stubs = {node.name: node for node in tree.body if hasattr(node, "name")}
        self.assertEqual(set(kerf.__all__) - {"__version__"}, set(stubs))
        for name, node in stubs.items():
            one = getattr(kerf, name)
            self.assertTrue(inspect.getdoc(one), name)
            if isinstance(node, ast.FunctionDef):
                self.same_arguments(one, node, name)
                continue
            there = {inner.name: inner for inner in node.body if isinstance(inner, ast.FunctionDef)}
            for method, value in vars(one).items():
                if method.startswith("_") or not inspect.isfunction(value):
                    continue
                self.assertIn(method, there, f"{name}.{method} is not in the stubs")
                self.same_arguments(value, there[method], f"{name}.{method}")

    def same_arguments(self, function, stub, name):
        known = inspect.signature(function).parameters
        expected = [a.arg for a in (*stub.args.args, *stub.args.kwonlyargs)]
        self.assertEqual(list(known), expected, name)
        keywords = {a.arg for a in stub.args.kwonlyargs}
        self.assertEqual({k for k, p in known.items() if p.kind == p.KEYWORD_ONLY}, keywords, name)


if __name__ == "__main__":
    unittest.main()
