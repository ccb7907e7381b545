#!/usr/bin/env python3
"""portable.py BUILD FOLDER [archive] [wheel]: what runs beside other distributions' libraries, out of a build folder: an archive
that is unpacked anywhere, and a wheel for this Python. Both bring the libraries that kerf loads, apart from those of glibc, and
one font. Debian's packages say which library belongs to whom, and under which licence.

gmsh and PETSc stay out: gmsh alone brings 87 libraries, 92 MB, twice as much as all others together.
"""

import hashlib
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(SOURCE / "python"))
import kerf_build  # noqa: E402

MACHINE = platform.machine()
FONTS = [pathlib.Path("/usr/share/fonts/truetype/dejavu") / name for name in
         ("DejaVuSans.ttf", "DejaVuSans-Bold.ttf", "DejaVuSans-Oblique.ttf")]
# Of libraries whose templates are compiled in.
HEADERS = [pathlib.Path("/usr/include") / name for name in
           ("eigen3/Eigen/Core", "CGAL/version.h", "boost/version.hpp", "CLI/CLI.hpp", "nlohmann/json.hpp", "spdlog/spdlog.h",
            "pybind11/pybind11.h")]


def said_by(*command, **how):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True, **how).stdout


def is_elf(path):
    with open(path, "rb") as file:
        return file.read(4) == b"\x7fELF"


def loaded_by(binaries):
    """The libraries that these load, and those that these load: name to file. As if the reference BLAS and LAPACK were the only
    ones: kerf's factors are made by its own kernels, UMFPACK alone calls a BLAS, and OpenBLAS is 40 MB."""
    triplet = said_by("gcc", "-print-multiarch").strip()
    places = ":".join(f"/usr/lib/{triplet}/{kind}" for kind in ("blas", "lapack"))
    found = {}
    for binary in binaries:
        for line in said_by("ldd", binary, env={**os.environ, "LD_LIBRARY_PATH": places}).splitlines():
            if "not found" in line:
                sys.exit(f"{binary}: {line.strip()}")
            if match := re.match(r"\s*(\S+) => (/\S+)", line):
                found[match[1]] = pathlib.Path(match[2])
    return found


def package_of(path):
    """The Debian package that a file belongs to. Its database has names from before /lib became /usr/lib."""
    whole = path.resolve()
    for name in {path, whole, pathlib.Path(str(whole).removeprefix("/usr")), pathlib.Path("/usr" + str(whole))}:
        asked = subprocess.run(["dpkg", "-S", str(name)], capture_output=True, text=True)
        if asked.returncode == 0:
            return asked.stdout.split(":")[0]
    sys.exit(f"{path} belongs to no package of Debian: nobody says under which licence it is")


def needed_glibc(files):
    """The newest version of glibc's symbols that these ask for, as (2, 36)."""
    versions = re.findall(r"Name: GLIBC_(\d+)\.(\d+)", said_by("readelf", "-VW", *files))
    return max((int(major), int(minor)) for major, minor in versions)


class Libraries:
    """The libraries that some binaries load, without glibc's and without `left_out`."""

    def __init__(self, binaries, left_out=()):
        self.owners = {}
        self.files = {}
        for name, file in sorted(loaded_by(binaries).items()):
            owner = package_of(file)
            if owner != "libc6" and name not in left_out:
                self.files[name], self.owners[name] = file, owner

    def copy(self, folder):
        """Into a folder, where they find each other."""
        folder.mkdir(parents=True)
        for name, file in self.files.items():
            shutil.copyfile(file, folder / name)
            (folder / name).chmod(0o755)
            find_in(folder / name, "$ORIGIN")

    def write_licences(self, folder):
        """Of each package one file, as Debian has it, with the licences that it only names."""
        folder.mkdir(parents=True)
        version = dict(line.split("\t", 1) for line in said_by("dpkg-query", "-W", "-f", "${Package}\t${Version}\t${source:Package}\n").splitlines())
        packages = sorted({*self.owners.values(), *(package_of(file) for file in [*FONTS, *HEADERS] if file.exists())})
        named = set()
        for package in packages:
            text = pathlib.Path(f"/usr/share/doc/{package}/copyright").read_text(encoding="utf-8", errors="replace")
            (folder / f"{package}.txt").write_text(text, encoding="utf-8")
            named |= set(re.findall(r"/usr/share/common-licenses/([\w.-]*\w)", text))
        for name in sorted(named):
            common = pathlib.Path("/usr/share/common-licenses") / name
            if common.exists():
                shutil.copyfile(common, folder / name)
        rows = [f"{package}\t{version[package]}" for package in packages]
        (folder / "sources.tsv").write_text("\n".join(["package of Debian\tversion\tsource package", *rows]) + "\n", encoding="utf-8")


def find_in(binary, where):
    # RPATH, not RUNPATH: somebody's LD_LIBRARY_PATH comes after it.
    subprocess.run(["patchelf", "--force-rpath", "--set-rpath", where, str(binary)], check=True)


def write_font(folder):
    for font in FONTS:
        shutil.copyfile(font, folder / font.name)
    shutil.copyfile(SOURCE / "cmake/fonts.conf", folder / "fonts.conf")


def install(build, stage, components):
    for component in components:
        said_by("cmake", "--install", build, "--prefix", stage, "--component", component, "--strip")


def make_archive(build, folder, scratch):
    name = f"kerf-{kerf_build.VERSION}-{MACHINE}"
    stage = scratch / name
    install(build, stage, ["program", "vtk"])
    programs, modules = sorted((stage / "bin").iterdir()), sorted((stage / "lib/kerf").glob("*.so"))
    libraries = Libraries([*programs, *modules])
    for program in programs:
        find_in(program, "$ORIGIN/../lib")
    for module in modules:
        find_in(module, "$ORIGIN/..")
    libraries.copy(scratch / "libraries")
    for library in sorted((scratch / "libraries").iterdir()):
        library.rename(stage / "lib" / library.name)
    write_font(stage / "lib/kerf")
    libraries.write_licences(stage / "share/doc/kerf/licences")
    shutil.copyfile(SOURCE / "LICENSE", stage / "LICENSE")
    glibc = ".".join(map(str, needed_glibc([p for p in stage.rglob("*") if p.is_file() and is_elf(p)])))
    text = (SOURCE / "cmake/archive.txt.in").read_text(encoding="utf-8")
    for key, value in {"VERSION": kerf_build.VERSION, "MACHINE": MACHINE, "GLIBC": glibc}.items():
        text = text.replace(f"@{key}@", value)
    (stage / "README").write_text(text, encoding="utf-8")
    date = os.environ.get("SOURCE_DATE_EPOCH") or int((SOURCE / "VERSION").stat().st_mtime)
    archive = folder / f"{name}.tar.xz"
    said_by("tar", "-C", scratch, "--sort=name", "--owner=0", "--group=0", "--numeric-owner", f"--mtime=@{date}", "-cJf", archive,
            name, env={**os.environ, "XZ_OPT": "-9 -T0"})
    size = sum(p.stat().st_size for p in stage.rglob("*") if p.is_file())
    report(archive, f"{len(libraries.files)} libraries, {size / 1e6:.0f} MB unpacked, glibc {glibc} or newer")


def make_wheel(build, folder, scratch):
    package = scratch / "wheel/kerf"
    package.mkdir(parents=True)
    for name, file in kerf_build.package(build).items():
        if not name.endswith("kerf_gmsh.so"):
            shutil.copyfile(file, scratch / "wheel" / name)
    binaries = [p for p in sorted(package.iterdir()) if is_elf(p)]
    for binary in binaries:
        said_by("strip", "--strip-unneeded", binary)
    # Of the libraries of C++ a process has one copy, the newest: the system's, which every wheel takes (PEP 600).
    libraries = Libraries(binaries, left_out=("libstdc++.so.6", "libgcc_s.so.1"))
    inside = scratch / f"wheel/{kerf_build.NAME}.libs"
    libraries.copy(inside)
    # Names of their own: a process of Python may have loaded another library of the same name, of another version.
    own = {}
    for name, file in libraries.files.items():
        mark = hashlib.sha256(file.read_bytes()).hexdigest()[:8]
        own[name] = re.sub(r"\.so", f"-{mark}.so", name, count=1)
        (inside / name).rename(inside / own[name])
        said_by("patchelf", "--set-soname", own[name], inside / own[name])
    exchanges = [word for pair in own.items() for word in ("--replace-needed", *pair)]
    for binary in [*binaries, *sorted(inside.iterdir())]:
        said_by("patchelf", *exchanges, binary)
    for binary in binaries:
        find_in(binary, f"$ORIGIN/../{inside.name}")
    write_font(package)
    libraries.write_licences(scratch / "wheel" / kerf_build.INFO / "licences")
    files = {str(p.relative_to(scratch / "wheel")): p for p in sorted((scratch / "wheel").rglob("*")) if p.is_file()}
    glibc = needed_glibc([p for p in files.values() if is_elf(p)])
    name = kerf_build.write_wheel(folder, {name: path.read_bytes() for name, path in files.items()},
                                  f"manylinux_{glibc[0]}_{glibc[1]}_{MACHINE}")
    size = sum(p.stat().st_size for p in files.values())
    report(folder / name, f"{len(libraries.files)} libraries, {size / 1e6:.0f} MB unpacked")


def report(file, words):
    print(f"{file}: {file.stat().st_size / 1e6:.1f} MB; {words}", flush=True)


def main():
    build, folder = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    folder.mkdir(parents=True, exist_ok=True)
    for kind in sys.argv[3:] or ["archive", "wheel"]:
        with tempfile.TemporaryDirectory() as scratch:
            {"archive": make_archive, "wheel": make_wheel}[kind](build, folder, pathlib.Path(scratch))


if __name__ == "__main__":
    main()
