"""The command kerf of a wheel: the program, which lies in this package."""

import os
import pathlib
import sys


def main():
    program = str(pathlib.Path(__file__).with_name("kerf"))
    os.execv(program, [program, *sys.argv[1:]])
