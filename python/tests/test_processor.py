"""A processor without what the module was built for gets an ImportError with the program's sentence, no illegal instruction."""

import os
import subprocess
import sys
import unittest

import kerf._kerf

LEVEL = os.environ["KERF_ARCH"]


class Processors(unittest.TestCase):
    @unittest.skipUnless(LEVEL in ("x86-64-v2", "x86-64-v3", "x86-64-v4"), f"built for {LEVEL}")
    def test_the_module_carries_the_mark_that_the_c_library_reads(self):
        notes = subprocess.run(["readelf", "-n", kerf._kerf.__file__], capture_output=True, text=True, check=True).stdout
        needed = next(line for line in notes.splitlines() if "ISA needed" in line)
        self.assertEqual(needed.split()[-1], LEVEL)

    def refused(self, words):
        """The last line of what an import says where the C library refuses the module with these words."""
        script = f"""
import sys
class Refusal:
    def find_spec(self, name, *_):
        if name == "kerf._kerf":
            raise ImportError({words!r})
sys.meta_path.insert(0, Refusal())
import kerf
"""
        run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
        self.assertEqual(run.returncode, 1)
        return run.stderr.splitlines()[-1]

    def test_a_refusal_is_told_in_the_words_of_the_program(self):
        self.assertEqual(self.refused("_kerf.so: CPU ISA level is lower than required"),
                         "ImportError: kerf: this processor lacks AVX2, which this kerf was built for; "
                         "build it with KERF_ARCH=x86-64")
        self.assertEqual(self.refused("libcholmod.so: not found"), "ImportError: libcholmod.so: not found")


if __name__ == "__main__":
    unittest.main()
