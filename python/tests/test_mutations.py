"""200 cases that nobody would write: whatever a dict holds, the interpreter lives, and what kerf says is one of its
errors."""

import copy
import random
import signal
import unittest

import kerf

from plates import plate


class Late(Exception):
    pass


def late(signal_number, frame):
    raise Late


def raises(x, y):
    raise RuntimeError("mutated")


def cases():
    """What is mutated."""
    full = plate(0.3) | {
        "hole": [{"name": "h", "circle": {"center": [0.2, 0.2], "radius": 0.1}}],
        "region": [{"name": "r", "circle": {"center": [0.8, 0.8], "radius": 0.1}, "young": 10.0, "poisson": 0.2}],
        "body": {"force": [0, lambda x, y: 0.1 * (x - 0.5)]},
        "functional": {"kind": "stress_power", "p": 2, "weight": "1 + x"},
        "map": {"perturbation": "hole", "points": [[0.3, 0.8]]},
        "probe": [{"name": "p", "points": [[0.4, 0.6]]}],
        "solver": {"element": "bdms", "degree": 1},
        "define": {"a": "x + y"},
    }
    full["boundary"].append({"on": "left", "displacement": [0, "0*a"]})
    optimized = {
        "domain": {"outline": [[0, 0], [2, 0], [2, 1], [0, 1]], "sides": ["bottom", "right", "top", "left"]},
        "material": {"young": 1.0, "poisson": 0.3},
        "boundary": [{"on": "left", "displacement": [0, 0]}, {"on": "right", "traction": [0, -1]}],
        "mesh": {"size": 0.3},
        "functional": {"kind": "compliance"},
        "validate": {"points": [[0.5, 0.5]], "radii": [0.1, 0.05]},
    }
    return [plate(0.3), full, optimized]


values = [None, True, 0, -1, 1, 1e-300, 1e308, float("nan"), float("inf"), 10**30, "", "x", "1/0", "nan", "a", "\0", "\ud800",
          "top", [], {}, [[]], [0, 0], [[0, 0], [1, 1]], (), set(), b"x", object(), raises, max, lambda: 0, len,
          lambda x, y: None, lambda x, y: x / 0 if x > 0.5 else 1.0, kerf, kerf.Case]


def places(node, path=()):
    """Every place in a case, the whole of it left out."""
    if len(path) > 8:  # a case that contains itself
        return
    below = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, value in below:
        yield (*path, key)
        yield from places(value, (*path, key))


def mutated(case, chance):
    for _ in range(chance.randint(1, 2)):
        all_places = list(places(case))
        if not all_places:
            return case
        *way, last = chance.choice(all_places)
        node = case
        for key in way:
            node = node[key]
        how = chance.randrange(10)
        if how == 0:
            del node[last]
        elif how == 1 and isinstance(node, list):
            node.insert(last, copy.copy(node[last]))
        elif how == 2 and isinstance(node, dict):
            node[chance.choice(["", "sze", "path", "name", "\0", "on", 7])] = node.pop(last)
        elif how == 3:
            node[last] = case  # contains itself
        elif how > 5 and isinstance(node[last], (int, float)):
            node[last] *= chance.choice([-1, 0, 1e-3, 0.9, 1.1, 3, 1e6])
        else:
            node[last] = chance.choice(values)
    return case


class Mutations(unittest.TestCase):
    def test_the_interpreter_lives(self):
        before = signal.signal(signal.SIGALRM, late)
        self.addCleanup(signal.signal, signal.SIGALRM, before)
        ends = {}
        for number in range(200):
            chance = random.Random(number)
            case = mutated(chance.choice(cases()), chance)
            try:
                signal.setitimer(signal.ITIMER_REAL, 1)
                try:
                    end = type(kerf.Case(case).run(threads=1)).__name__
                finally:
                    signal.setitimer(signal.ITIMER_REAL, 0)
            except kerf.Error as error:
                self.assertTrue(str(error), number)
                end = type(error).__name__
            except Late:
                end = "Late"
            ends[end] = ends.get(end, 0) + 1
        self.assertEqual(sum(ends.values()), 200)
        self.assertGreater(ends["CaseError"], 80, ends)
        self.assertGreater(ends["Result"], 8, ends)
        self.assertEqual(kerf.Case(plate()).solve().status, "ok")


if __name__ == "__main__":
    unittest.main()
