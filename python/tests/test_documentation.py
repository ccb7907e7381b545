"""What the documentation says is true: examples of docstrings, and the tutorial."""

import doctest
import importlib
import os
import pathlib
import runpy
import tempfile
import unittest
import warnings

import kerf


class Documentation(unittest.TestCase):
    def test_docstrings(self):
        for name in ("kerf", "kerf._case", "kerf._errors", "kerf._functions", "kerf._result", "kerf._sweep"):
            failed, tried = doctest.testmod(importlib.import_module(name))
            self.assertEqual(failed, 0, name)
        self.assertGreater(doctest.testmod(kerf).attempted, 5)

    def test_tutorials(self):
        scripts = sorted((pathlib.Path(os.environ["KERF_SOURCE"]) / "docs" / "tutorials").glob("sweep.py"))
        self.assertTrue(scripts)
        for script in scripts:
            with self.subTest(script.name), tempfile.TemporaryDirectory() as folder:
                here = os.getcwd()
                os.chdir(folder)
                try:
                    with warnings.catch_warnings():
                        warnings.simplefilter("default")
                        runpy.run_path(str(script), run_name="__main__")
                finally:
                    os.chdir(here)


if __name__ == "__main__":
    unittest.main()
