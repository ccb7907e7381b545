"""Libraries that kerf does without until they are asked for."""

import importlib

_packages = {"matplotlib": "matplotlib", "pandas": "pandas", "pyvista": "pyvista", "meshio": "meshio", "vtkmodules": "vtk"}


def needed(module, what):
    """The module, or an ImportError that says how to get it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = _packages.get(module.partition(".")[0], module)
        raise ImportError(f"{what} needs {package}, which is not installed: pip install {package}, or apt install "
                          f"python3-{package}", name=error.name) from error
