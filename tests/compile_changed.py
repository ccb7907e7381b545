"""Compiles changed copies of sources as the build compiles the sources themselves, for tests that follow the documents.

Where the build puts the files of a wing together (KERF_UNITY), the whole unit is compiled, with the copies in the places
of what they are copies of: linked before the libraries, its object stands for that of the library.
"""
import json
import re
import subprocess


class Sources:
    def __init__(self, source, build):
        self.source, self.build = source, build
        self.units = {}  # of each source: the file that is compiled, its command, all sources in it
        with open(build + "/compile_commands.json", encoding="utf-8") as file:
            for entry in json.load(file):
                unit, parts = entry["file"], [entry["file"]]
                if "/Unity/unity_" in unit:
                    with open(unit, encoding="utf-8") as text:
                        parts = re.findall(r'#include "(.*)"', text.read())
                for part in parts:  # the first is that of the library, before those of tests
                    self.units.setdefault(part, (unit, entry["command"], parts))

    def compile(self, copy, paths, alike, folder):
        """Objects in `folder` of the files `paths` below `copy`; of a new one, alike[path] is a source that is compiled the
        same way."""
        changed = {}  # of each unit its paths
        for path in paths:
            unit = self.units[f"{self.source}/{alike.get(path, path)}"]
            changed.setdefault(unit[0], (unit, []))[1].append(path)
        objects = []
        for (unit, command, parts), here in changed.values():
            files = [part for part in parts if part != unit or unit[len(self.source) + 1:] in here]
            files = [f"{copy}/{part[len(self.source) + 1:]}" if part[len(self.source) + 1:] in here else part for part in files]
            files += [f"{copy}/{path}" for path in here if path in alike]
            target = f"{folder}/changed_{len(objects)}"
            with open(target + ".cpp", "w", encoding="utf-8") as text:
                text.writelines(f'#include "{file}"\n' for file in files)
            objects.append(self.compile_as(unit, command, target + ".cpp", target + ".o", copy))
        return objects

    def compile_like(self, like, file, target, copy):
        """One file, compiled as the source `like`; the object `target`."""
        unit, command, _ = self.units[f"{self.source}/{like}"]
        return self.compile_as(unit, command, file, target, copy)

    def compile_as(self, unit, command, file, target, copy):
        words = command.split()
        words[words.index("-o") + 1] = target
        # The copy first: headers that no step touches are found in the sources.
        words = [file if word == unit else word for word in words]
        first = next(i for i, word in enumerate(words) if word.startswith("-I"))
        words[first:first] = [f"-I{copy}/include", f"-I{copy}"]
        subprocess.run(" ".join(words), shell=True, check=True, cwd=self.build)
        return target

    def link_command(self, target):
        said = subprocess.run(["ninja", "-C", self.build, "-t", "commands", target], check=True, capture_output=True, text=True)
        return said.stdout.strip().splitlines()[-1]

    def run(self, command):
        subprocess.run(command, shell=True, check=True, cwd=self.build)
