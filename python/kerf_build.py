"""What pip asks of a project (PEP 517), on CMake: nothing is fetched, everything comes from this machine.

The options of CMake are those of KERF_CMAKE_ARGS; what ./dev unpacked into build/headers is used. cmake/portable.py adds the
libraries that a wheel for other machines needs.
"""

import base64
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tomllib
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parent.parent
VERSION = (SOURCE / "VERSION").read_text().strip()
PROJECT = tomllib.loads((SOURCE / "pyproject.toml").read_text(encoding="utf-8"))["project"]
NAME = PROJECT["name"].replace("-", "_")
INFO = f"{NAME}-{VERSION}.dist-info"
TAG = f"cp{sys.version_info.major}{sys.version_info.minor}"


def _metadata():
    author = PROJECT["authors"][0]
    lines = ["Metadata-Version: 2.1", f"Name: {PROJECT['name']}", f"Version: {VERSION}", f"Summary: {PROJECT['description']}",
             f"Author: {author['name']}", f"Author-email: {author['name']} <{author['email']}>", f"License: {PROJECT['license']}",
             f"Keywords: {','.join(PROJECT['keywords'])}"]
    lines += [f"Classifier: {one}" for one in PROJECT["classifiers"]]
    lines += [f"Project-URL: {name}, {url}" for name, url in PROJECT.get("urls", {}).items()]
    lines += [f"Requires-Python: {PROJECT['requires-python']}"]
    lines += [f"Requires-Dist: {one}" for one in PROJECT["dependencies"]]
    for extra, packages in PROJECT.get("optional-dependencies", {}).items():
        lines += [f"Provides-Extra: {extra}", *(f'Requires-Dist: {one}; extra == "{extra}"' for one in packages)]
    lines += ["License-File: LICENSE", "Description-Content-Type: text/markdown"]
    readme = (SOURCE / PROJECT["readme"]).read_text(encoding="utf-8")
    readme = re.sub(r"\[([^\]]+)\]\((?!https?:)[^)]+\)", r"\1", readme)  # links to files that no wheel has
    return "\n".join(lines) + "\n\n" + readme


def package(build):
    """The files of a wheel by their names in it: the package out of a build folder, and the program."""
    files = {f"kerf/{path.name}": path.resolve() for path in sorted((build / "python" / "kerf").iterdir())
             if path.name != "__pycache__"}
    if not any(name.startswith("kerf/_kerf.") for name in files):
        sys.exit(f"{build} has no Python module; ./dev python says what it needs")
    files["kerf/kerf"] = build / "kerf"
    return files


def write_wheel(folder, files, platform):
    """A wheel of `files` (path in the wheel: bytes); returns its name."""
    files = dict(files)
    files[f"{INFO}/METADATA"] = _metadata().encode()
    files[f"{INFO}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: kerf\nRoot-Is-Purelib: false\nTag: {TAG}-{TAG}-{platform}\n".encode()
    files[f"{INFO}/entry_points.txt"] = "".join(
        ["[console_scripts]\n", *(f"{name} = {call}\n" for name, call in PROJECT["scripts"].items())]).encode()
    files[f"{INFO}/LICENSE"] = (SOURCE / "LICENSE").read_bytes()
    record = ""
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(content)}\n"
    files[f"{INFO}/RECORD"] = (record + f"{INFO}/RECORD,,\n").encode()
    wheel_name = f"{NAME}-{VERSION}-{TAG}-{TAG}-{platform}.whl"
    with zipfile.ZipFile(pathlib.Path(folder) / wheel_name, "w") as wheel:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path)  # of 1980: the same bytes every time
            entry.external_attr = (0o100755 if content[:4] == b"\x7fELF" else 0o100644) << 16
            wheel.writestr(entry, content, zipfile.ZIP_DEFLATED, 9)
    return wheel_name


def _compiled():
    """The build folder, with the module, those that it loads, and the program."""
    build = pathlib.Path(os.environ.get("KERF_BUILD", SOURCE / "build" / "wheel"))
    options = ["-DCMAKE_BUILD_TYPE=Release", "-DKERF_PYTHON=ON", "-DKERF_TESTS=OFF", "-DKERF_BENCH=OFF",
               f"-DPython3_EXECUTABLE={sys.executable}"]
    if (SOURCE / "build" / "headers").exists():
        options.append(f"-DKERF_HEADERS_ROOT={SOURCE / 'build' / 'headers'}")
    if shutil.which("ninja"):
        options += ["-G", "Ninja"]
    if shutil.which("ccache"):
        options.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
    options += shlex.split(os.environ.get("KERF_CMAKE_ARGS", ""))
    subprocess.run(["cmake", "-S", SOURCE, "-B", build, *options], check=True)
    subprocess.run(["cmake", "--build", build, "-j", str(os.cpu_count() or 1), "--target", "kerf_python", "kerf"], check=True)
    return build


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return write_wheel(wheel_directory, {name: path.read_bytes() for name, path in package(_compiled()).items()}, platform)


def get_requires_for_build_wheel(config_settings=None):
    return []
