"""kerf: topological derivatives for plane elastic bodies with cracks in contact.

A case is a file, or a dict with the same keys:

>>> import kerf
>>> plate = {
...     "domain": {"outline": [[0, 0], [1, 0], [1, 1], [0, 1]], "sides": ["bottom", "right", "top", "left"]},
...     "crack": [{"name": "c", "path": [[0.3, 0.5], [0.7, 0.5]]}],
...     "material": {"young": 1.0, "poisson": 0.3},
...     "boundary": [{"on": ["bottom", "top"], "traction": [0, "ny"]}],
...     "mesh": {"size": 0.2},
... }
>>> result = kerf.Case(plate).solve()
>>> result.status
'ok'
>>> round(result["state"]["energy"], 2)
-0.6
>>> result.displacement.shape[1]
2

An error says which key is wrong:

>>> plate["mesh"]["size"] = -1
>>> kerf.Case(plate)
Traceback (most recent call last):
  ...
kerf.CaseError: mesh.size: size in [mesh] must be positive, not -1
"""

try:
    from ._kerf import __version__
except ImportError as _error:  # the C library refused before an instruction of the module ran (python/CMakeLists.txt)
    if "ISA level" not in str(_error):
        raise
    raise ImportError("kerf: this processor lacks AVX2, which this kerf was built for; build it with KERF_ARCH=x86-64",
                      name="kerf") from _error

from ._case import Case
from ._designs import Designs, DesignValues
from ._documented import document
from ._errors import CaseError, Error, FilesError, GeometryError, SolveError
from ._mesh import Mesh
from ._result import Crack, Result, Tip, load
from ._sweep import Sweep, sweep
from ._values import Values
from ._views import Named, Section

__all__ = ["Case", "CaseError", "Crack", "DesignValues", "Designs", "Error", "FilesError", "GeometryError", "Mesh",
           "Named", "Result", "Section", "SolveError", "Sweep", "Tip", "Values", "__version__", "load", "sweep"]

document({_name: globals()[_name] for _name in __all__ if _name != "__version__"})
del document
