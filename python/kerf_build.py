"""What pip asks of a project (PEP 517), on CMake: nothing is fetched, everything comes from this machine.

The options of CMake are those of KERF_CMAKE_ARGS; what ./dev unpacked into build/headers is used.
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
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parent.parent
VERSION = re.search(r"project\(kerf VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text()).group(1)
INFO = f"kerf-{VERSION}.dist-info"
METADATA = f"""Metadata-Version: 2.1
Name: kerf
Version: {VERSION}
Summary: Topological derivatives for plane elastic bodies with cracks in contact
Requires-Python: >=3.10
Requires-Dist: numpy
"""


def _compiled():
    """The build folder, with the module and those that it loads."""
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
    subprocess.run(["cmake", "--build", build, "-j", str(os.cpu_count() or 1), "--target", "kerf_python"], check=True)
    return build


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    build = _compiled()
    tag = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    files = {f"kerf/{path.name}": path.resolve().read_bytes()
             for path in sorted((build / "python" / "kerf").iterdir()) if path.name != "__pycache__"}
    files[f"{INFO}/METADATA"] = METADATA.encode()
    files[f"{INFO}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: kerf\nRoot-Is-Purelib: false\nTag: {tag}-{tag}-{platform}\n".encode()
    record = ""
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(content)}\n"
    files[f"{INFO}/RECORD"] = (record + f"{INFO}/RECORD,,\n").encode()
    name = f"kerf-{VERSION}-{tag}-{tag}-{platform}.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in files.items():
            wheel.writestr(path, content)
    return name


def get_requires_for_build_wheel(config_settings=None):
    return []
