#!/usr/bin/env python3
"""Which tests are quick, by what ctest measured (BUILD/Testing/Temporary/CTestCostData.txt).

costs.py record BUILD   writes the measured part of tests/slow_tests.txt anew: every test that takes more than 0.6 seconds,
                        so that slower processors find none to take too long
costs.py check BUILD    fails where a quick test takes more than 2.5 seconds, or a line of tests/slow_tests.txt or of the
                        tables of tests/README.md names none. Machines differ: one took 1.9 to 2.4 seconds for tests
                        that were recorded below 0.6 to 1 on another.

Either runs what took longer by the clock again, alone, and takes the least processor time of three runs: a busy machine
makes no test slow.
"""
import fnmatch
import json
import os
import re
import resource
import subprocess
import sys

limit, recorded = 2.5, 0.6  # seconds
lanes = os.path.join(os.path.dirname(os.path.abspath(__file__)), "slow_tests.txt")
measured = "# Measured: written by tests/costs.py record.\n"


def tests(build):
    """The tests of GoogleTest by name: command, working directory, labels, seconds as measured last."""
    said = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1"], check=True, capture_output=True, text=True)
    found = {}
    for test in json.loads(said.stdout)["tests"]:
        properties = {p["name"]: p["value"] for p in test["properties"]}
        if "command" in test and any(word.startswith("--gtest_filter=") for word in test["command"]):
            found[test["name"]] = {"command": test["command"], "folder": properties["WORKING_DIRECTORY"],
                                   "labels": properties.get("LABELS", []), "seconds": 0.0}
    with open(os.path.join(build, "Testing/Temporary/CTestCostData.txt"), encoding="utf-8") as file:
        for line in file:
            if line.startswith("---"):
                break
            name, _, cost = line.rsplit(maxsplit=2)
            if name in found:
                found[name]["seconds"] = float(cost)
    return found


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def alone(test, enough):
    """Processor seconds of the test and of the programs that it starts, the least of three runs."""
    least = float("inf")
    for _ in range(3):
        begin = processor_seconds()
        subprocess.run(test["command"], cwd=test["folder"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        least = min(least, processor_seconds() - begin)
        if least <= enough:
            break
    return least


def matches(name, pattern):
    return fnmatch.fnmatchcase(name, pattern)


def record(build):
    with open(lanes, encoding="utf-8") as file:
        head, _, rest = file.read().partition(measured)
    tail = rest[rest.index("\n\n"):]
    by_hand = re.findall(r"^(?:slow|nightly) +(\S+)", head, re.M)
    slow = []
    for name, test in sorted(tests(build).items()):
        if any(matches(name, pattern) for pattern in by_hand):
            continue
        # A slow one stays slow unless it took less; what is in doubt is measured alone.
        known = "slow" in test["labels"] and not 0 < test["seconds"] < recorded
        if known or test["seconds"] > recorded and alone(test, recorded) > recorded:
            slow.append(name)
    with open(lanes, "w", encoding="utf-8") as file:
        file.write(head + measured + "\n".join("slow " + name for name in slow) + tail)
    print(f"{len(slow)} tests take more than {recorded:g} s")
    return 0


def check(build):
    every = tests(build)
    bad = 0
    for name, test in every.items():
        if "quick" in test["labels"] and test["seconds"] > limit:
            seconds = alone(test, limit)
            if seconds > limit:
                print(f"{name} takes {seconds:.2f} s: make it quicker, or add it to tests/slow_tests.txt")
                bad += 1
    with open(lanes, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            words = line.split()
            if words and words[0] != "#" and not any(matches(name, words[1]) for name in every):
                print(f"tests/slow_tests.txt:{number}: no test is called {words[1]}")
                bad += 1
    with open(os.path.join(os.path.dirname(lanes), "README.md"), encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            for pattern in re.findall(r"`([^` ]+\.[A-Z][^` ]*)`", line) if line.startswith("|") else []:
                if not any("quick" in test["labels"] and matches(name, pattern) for name, test in every.items()):
                    print(f"tests/README.md:{number}: no quick test is called {pattern}")
                    bad += 1
    if not bad:
        quick = sum("quick" in test["labels"] for test in every.values())
        print(f"each of {quick} quick tests takes at most {limit:g} s alone")
    return 1 if bad else 0


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in ("record", "check"):
        sys.exit(__doc__)
    sys.exit({"record": record, "check": check}[sys.argv[1]](sys.argv[2]))
