import pathlib
from collections.abc import Callable, Iterable, Mapping
from os import PathLike
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import NDArray

__version__: str

class Error(Exception):
    exit_code: int
    where: str | None

class CaseError(Error, ValueError): ...
class GeometryError(Error, ValueError): ...
class SolveError(Error, ArithmeticError):
    result: Result | None
class FilesError(Error, OSError): ...

class Case:
    def __init__(
        self,
        source: str | PathLike[str] | dict[str, Any],
        *,
        set: Mapping[str, Any] | None = ...,
        name: str | None = ...,
        folder: str | PathLike[str] | None = ...,
    ) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    def text(self) -> str: ...
    def check(self) -> str: ...
    def run(
        self,
        folder: str | PathLike[str] | None = ...,
        *,
        threads: int | None = ...,
        force: bool = ...,
        on_phase: Callable[[str], object] | None = ...,
        on_iteration: Callable[[dict[str, Any]], object] | None = ...,
        resume: bool = ...,
    ) -> Result: ...
    def solve(
        self,
        folder: str | PathLike[str] | None = ...,
        *,
        threads: int | None = ...,
        force: bool = ...,
        on_phase: Callable[[str], object] | None = ...,
    ) -> Result: ...
    def map(
        self,
        folder: str | PathLike[str] | None = ...,
        *,
        threads: int | None = ...,
        force: bool = ...,
        on_phase: Callable[[str], object] | None = ...,
    ) -> Result: ...
    def inspect(
        self,
        length: float | None = ...,
        folder: str | PathLike[str] | None = ...,
        *,
        threads: int | None = ...,
        force: bool = ...,
        on_phase: Callable[[str], object] | None = ...,
    ) -> Result: ...
    def validate(
        self,
        folder: str | PathLike[str] | None = ...,
        *,
        threads: int | None = ...,
        force: bool = ...,
        on_phase: Callable[[str], object] | None = ...,
    ) -> Result: ...
    def grow(
        self,
        folder: str | PathLike[str] | None = ...,
        *,
        threads: int | None = ...,
        force: bool = ...,
        on_phase: Callable[[str], object] | None = ...,
        on_step: Callable[[dict[str, Any]], object] | None = ...,
        resume: bool = ...,
    ) -> Result: ...
    def optimize(
        self,
        folder: str | PathLike[str] | None = ...,
        *,
        on_iteration: Callable[[dict[str, Any]], object] | None = ...,
        resume: bool = ...,
        threads: int | None = ...,
        force: bool = ...,
        on_phase: Callable[[str], object] | None = ...,
    ) -> Result: ...

class Result:
    folder: pathlib.Path
    numbers: dict[str, Any]
    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    corner_points: NDArray[np.float64]
    corner_triangles: NDArray[np.int32]
    corner_vertex: NDArray[np.int32]
    displacement: NDArray[np.float64]
    stress: NDArray[np.float64]
    rotation: NDArray[np.float64]
    von_mises: NDArray[np.float64]
    error_indicator: NDArray[np.float64]
    topological_derivative: NDArray[np.float64]
    masked: NDArray[np.bool_]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    angle: NDArray[np.float64]
    @property
    def status(self) -> str: ...
    @property
    def reason(self) -> str | None: ...
    def __getitem__(self, section: str) -> Any: ...
    def __contains__(self, section: str) -> bool: ...
    def summary(self) -> str: ...
    def crack(self, name: str) -> dict[str, NDArray[Any]]: ...
    def page(self) -> str: ...
    def triangulation(self, scale: float = ...) -> Any: ...
    def to_meshio(self) -> Any: ...
    def to_vtk(self) -> Any: ...

class Sweep:
    folder: pathlib.Path
    rows: list[dict[str, Any]]
    failures: list[dict[str, Any]]
    def column(self, name: str) -> list[Any]: ...
    def __len__(self) -> int: ...
    def summary(self) -> str: ...
    def to_pandas(self) -> Any: ...

@overload
def sweep(
    case: Case | str | PathLike[str] | dict[str, Any],
    over: Mapping[str, Iterable[Any]],
    *,
    folder: str | PathLike[str],
    write: None = ...,
    set: Mapping[str, Any] | None = ...,
    jobs: int | None = ...,
    threads: int = ...,
    client: Any = ...,
    on_run: Callable[[str], object] | None = ...,
) -> Sweep: ...
@overload
def sweep(
    case: Case | str | PathLike[str] | dict[str, Any],
    over: Mapping[str, Iterable[Any]],
    *,
    folder: str | PathLike[str],
    write: Literal["snakemake", "slurm"],
    set: Mapping[str, Any] | None = ...,
    jobs: int | None = ...,
    threads: int = ...,
    client: Any = ...,
    on_run: Callable[[str], object] | None = ...,
) -> str: ...
