"""kerf: topological derivatives for plane elastic bodies with cracks in contact.

Units are those of the case: lengths as its coordinates, stresses as ``young``. Forces, energies and the topological
derivative are per unit of thickness. Angles are radians unless a name says degrees.
"""

import pathlib
from collections.abc import Callable, Iterable, Iterator, KeysView, Mapping
from os import PathLike
from typing import Any, Generic, Literal, SupportsIndex, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_T = TypeVar("_T")

def load(folder: str | PathLike[str]) -> Result:
    """The result that lies in a folder of an earlier run, of the program or of Python, or is the file result.json.

    Fields come from ``state.vtu`` and ``map.vtu``; without these from ``report.bin``, which has single precision and, of
    large meshes, fewer triangles. ``at`` is linear between corners, and what is masked includes what lies beside singular
    points. ``status`` may be any, nothing is raised for one that is not ok. A folder without fields still has all numbers
    and cracks; what needs fields then raises ``FilesError`` with a sentence that says why.

    Raises ``FilesError`` where there is no ``result.json``, or it is none of kerf's.
    """

class Case:
    """What is computed: a case file, its text, or a dict with the same tables and keys.

    ``source`` is the path of a case file; or the text of one, which has more than one line; or a dict; or another case.
    ``set`` changes keys, as ``--set`` of the program does: ``{"mesh.size": 0.02, "crack.c.contact": "open"}``. ``name``
    is what results call it. ``folder`` is where files lie that a text or a dict names, the working folder by default.

    In a dict, a function may stand where a file has an expression: ``f(x, y)``, or ``f(x, y, nx, ny)`` on boundaries,
    returns a number; in the place of a vector (traction, displacement, force, target) it may return both components. It
    is called for one point at a time, with floats, or with arrays of one number where it takes only arrays.

    A case is read like a dict of its tables: ``case["mesh"]["size"] = 0.02``, ``case["crack"]["c"]["contact"]``,
    ``del case["map"]``. Changes count from the next use on, which is when mistakes in them are found. Cases can be
    copied and pickled; a copy shares nothing with its origin.

    Raises ``CaseError`` with the place of what is wrong, ``GeometryError`` and ``FilesError``.

    >>> case = Case({
    ...     "domain": {"outline": [[0, 0], [1, 0], [1, 1], [0, 1]], "sides": ["bottom", "right", "top", "left"]},
    ...     "crack": [{"name": "c", "path": [[0.3, 0.5], [0.7, 0.5]]}],
    ...     "material": {"young": 1.0, "poisson": 0.3},
    ...     "boundary": [{"on": ["bottom", "top"], "traction": lambda x, y, nx, ny: (0, ny)}],
    ...     "mesh": {"size": 0.2},
    ... }, name="plate")
    >>> case
    <kerf.Case 'plate': 1 crack, sides bottom, right, top, left, bdms 2>
    >>> case["mesh"]["size"] = 0.1
    >>> case["crack"]["c"]["path"]
    [[0.3, 0.5], [0.7, 0.5]]
    """

    def __init__(
        self,
        source: Case | str | PathLike[str] | dict[str, Any],
        *,
        set: Mapping[str, Any] | None = None,
        name: str | None = None,
        folder: str | PathLike[str] | None = None,
    ) -> None: ...
    def __getitem__(self, table: str) -> Any:
        """A table, to be read and changed. Lists of tables (``crack``, ``boundary``, ``hole``) take names, too."""
    def __setitem__(self, table: str, value: Any) -> None: ...
    def __delitem__(self, table: str) -> None: ...
    def __contains__(self, table: object) -> bool: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def keys(self) -> KeysView[str]: ...
    def get(self, table: str, default: Any = None) -> Any: ...
    def to_dict(self) -> dict[str, Any]:
        """All tables as a dict of its own, with what was set."""
    @property
    def name(self) -> str:
        """What results call it: the name of the file, or ``name``."""
    @property
    def title(self) -> str:
        """The title that the case gives itself, or its name."""
    def text(self) -> str:
        """The case as a file has it, with all that was set; functions stand there as their names."""
    def check(self) -> str:
        """The geometry in numbers and what each label selected; solves nothing."""
    def mesh(self) -> Mesh:
        """The mesh that a run begins with; it may mesh anew where contact ends and where ``mesh.adapt`` asks.

        Raises ``GeometryError``.
        """
    def designs(self, *, threads: int | None = None) -> Designs:
        """The designs that ``[[optimize.hole]]``, ``crack`` and ``inclusion`` draw, for an optimizer of your own.

        Raises ``CaseError`` for a level set, which has no variables.
        """
    def run(
        self,
        folder: str | PathLike[str] | None = None,
        *,
        threads: int | None = None,
        force: bool = False,
        on_phase: Callable[[str], object] | None = None,
        on_iteration: Callable[[dict[str, Any]], object] | None = None,
        on_step: Callable[[dict[str, Any]], object] | None = None,
        resume: bool = False,
    ) -> Result:
        """Every job that the case names: solve, map, validate, grow, optimize.

        ``folder`` gets the files of the program, and must be new, or hold results and ``force`` be true. Without it
        files go to a temporary folder, which goes with the result. ``threads`` is their number, all cores by default;
        results do not depend on it, bit for bit. ``on_phase(name)`` is called as each phase begins; what a callback
        raises ends the job and is raised here.

        Raises ``SolveError`` where the result is not ok; its ``result`` is what was found. Ctrl-C ends the job.
        """
    def solve(
        self,
        folder: str | PathLike[str] | None = None,
        *,
        threads: int | None = None,
        force: bool = False,
        on_phase: Callable[[str], object] | None = None,
    ) -> Result:
        """The state alone. Arguments as of ``run``."""
    def map(
        self,
        folder: str | PathLike[str] | None = None,
        *,
        threads: int | None = None,
        force: bool = False,
        on_phase: Callable[[str], object] | None = None,
    ) -> Result:
        """The state and the map of the topological derivative. Arguments as of ``run``."""
    def inspect(
        self,
        length: float | None = None,
        folder: str | PathLike[str] | None = None,
        *,
        threads: int | None = None,
        force: bool = False,
        on_phase: Callable[[str], object] | None = None,
    ) -> Result:
        """The state and the worst cracks: ``result["edge_cracks"]`` has ``worst``, along the boundary, and ``inside``.

        ``length`` is that of the cracks; without it they are those of ``[map]``, whose perturbation is "edge_crack".
        Other arguments as of ``run``.
        """
    def validate(
        self,
        folder: str | PathLike[str] | None = None,
        *,
        threads: int | None = None,
        force: bool = False,
        on_phase: Callable[[str], object] | None = None,
    ) -> Result:
        """The expansion against computations with changes of finite size. Arguments as of ``run``."""
    def grow(
        self,
        folder: str | PathLike[str] | None = None,
        *,
        threads: int | None = None,
        force: bool = False,
        on_phase: Callable[[str], object] | None = None,
        on_step: Callable[[dict[str, Any]], object] | None = None,
        resume: bool = False,
    ) -> Result:
        """The state, and its cracks grown from their tips.

        ``on_step`` is called with a dict of numbers after every step: ``step``, ``cycles``, ``load``, ``tips``.
        ``resume`` goes on with the checkpoint in the folder. Other arguments as of ``run``.
        """
    def optimize(
        self,
        folder: str | PathLike[str] | None = None,
        *,
        threads: int | None = None,
        force: bool = False,
        on_phase: Callable[[str], object] | None = None,
        on_iteration: Callable[[dict[str, Any]], object] | None = None,
        resume: bool = False,
    ) -> Result:
        """The best design.

        ``on_iteration`` is called with a dict of numbers after every iteration: ``iteration``, ``objective``,
        ``volume_fraction``, ``violation``, ``optimality``, ``variables`` and more, as history.csv has them. ``resume``
        goes on with the checkpoint in the folder, which a case with functions of Python cannot. Other arguments as of
        ``run``. ``designs`` is for an optimizer of your own.
        """

class Mesh:
    """Points and triangles, with what edges and triangles belong to, by names."""

    points: NDArray[np.float64]
    """(n, 2)"""
    triangles: NDArray[np.int32]
    """(m, 3), numbers of points, counter-clockwise"""
    labels: dict[str, NDArray[np.int32]]
    """per side of the boundary its edges, (k, 2), numbers of points"""
    cracks: dict[str, NDArray[np.int32]]
    """per crack its edges, (k, 2), along its path; both faces share the points"""
    regions: dict[str, NDArray[np.bool_]]
    """per region whether each triangle lies in it, (m,)"""
    def triangulation(self) -> Any:
        """A ``matplotlib.tri.Triangulation``."""
    def plot(self, ax: Any = None) -> Any:
        """Draws it with matplotlib, sides and cracks in colors; returns the axes."""

class Result:
    """What a job leaves: numbers, fields, cracks, files.

    ``result["state"]["energy"]`` and all other numbers are those of ``result.json`` (results.md), and ``numbers`` is the
    whole. Fields live at corners: a vertex on a crack has a corner on either side, so that what jumps there does; at the
    border of two regions, too. Arrays are windows into the memory of the result, which they keep alive; they cannot be
    written to.

    A result can be pickled, as joblib, dask and multiprocessing do: the copy has numbers, arrays and designs, and ``at``
    is linear between corners; its folder is the same.
    """

    folder: pathlib.Path
    """where the files are"""
    numbers: dict[str, Any]
    """result.json"""
    points: NDArray[np.float64]
    """(n, 2), vertices of the mesh"""
    triangles: NDArray[np.int32]
    """(m, 3), by numbers of points"""
    corner_points: NDArray[np.float64]
    """(k, 2), where fields are known"""
    corner_triangles: NDArray[np.int32]
    """(m, 3), the same triangles by numbers of corners"""
    corner_vertex: NDArray[np.int32]
    """(k,), the point of every corner"""
    displacement: NDArray[np.float64]
    """(k, 2), a length"""
    stress: NDArray[np.float64]
    """(k, 4): s11, s12, s21, s22; s12 and s21 differ by what the mesh errs"""
    rotation: NDArray[np.float64]
    """(k,), (d2 u1 - d1 u2)/2, radians"""
    von_mises: NDArray[np.float64]
    """(k,), a stress"""
    error_indicator: NDArray[np.float64]
    """(m,), of the stress per triangle; not with ``output.estimate = false``"""
    topological_derivative: NDArray[np.float64]
    """(k,), with a map everywhere: change of J per area of a small hole, or per what the perturbation says"""
    masked: NDArray[np.bool_]
    """(k,), where the expansion cannot hold at the radius of the map"""
    lower: NDArray[np.float64]
    """(k,), with ``map.bounds``"""
    upper: NDArray[np.float64]
    """(k,), with ``map.bounds``"""
    angle: NDArray[np.float64]
    """(m,), of the ellipse or the crack that the map asks about, radians"""
    @property
    def status(self) -> str:
        """"ok", or why not: "not converged", "infeasible", "failed"; then ``reason`` says more."""
    @property
    def reason(self) -> str | None:
        """A sentence, where the status is not ok."""
    @property
    def cracks(self) -> Named[Crack]:
        """The cracks, by number and by name: ``result.cracks["c"].tips["end"].K_I``."""
    @property
    def load_cases(self) -> Named[Section]:
        """What the load cases do to the body, by number and by name: ``result.load_cases["wind"].compliance``; as dicts
        of ``result["load_cases"]``. Empty without load cases."""
    @property
    def design(self) -> Case:
        """The design of an optimization as a case, with the same loads. Raises ``CaseError`` without one."""
    @property
    def grown(self) -> Case:
        """The body with its grown cracks as a case. Raises ``CaseError`` without one."""
    def __getitem__(self, section: str) -> Any: ...
    def __contains__(self, section: str) -> bool: ...
    def at(self, points: ArrayLike) -> Values:
        """Displacement, stress and T at any points, of shape (n, 2), or (..., 2).

        They are read off the solution that the run keeps, without another solve, exactly as probes and ``map.points``
        have them: the recovered displacement, the element's own stress, the expansion at that point. On a crack they
        are those of one of its sides. A loaded or unpickled result has values at corners alone, and is linear between
        these; T of a clamped hole always is.

        Raises ``ValueError`` for another shape, ``FilesError`` where a loaded folder has no fields.
        """
    def summary(self) -> str:
        """What the program prints at the end."""
    def crack(self, name: str) -> dict[str, NDArray[Any]]:
        """Along a crack, in the order of its path, at r points: ``s`` (r,), arc length; ``at`` (r, 2); ``jump_n``,
        ``jump_t``, left face minus right face; ``sigma_n``, ``sigma_t``; ``fluid_pressure``, ``gap``; ``closed``.
        Raises ``KeyError``."""
    def page(self) -> str:
        """The report as HTML. Raises ``FilesError`` where there is none."""
    def plot(
        self,
        field: str = "von_mises",
        *,
        ax: Any = None,
        scale: float = 0.0,
        cmap: Any = None,
        vmin: float | None = None,
        vmax: float | None = None,
        log: bool = False,
        edges: bool = False,
        colorbar: bool = True,
    ) -> Any:
        """Draws a field with matplotlib and returns the axes.

        ``field``: "von_mises", "displacement" (its length), "displacement_x", "displacement_y", "stress_xx", "stress_yy",
        "stress_xy", "rotation", "topological_derivative" (masked parts are left white), "lower", "upper",
        "error_indicator" or "mesh". ``scale`` times the displacement deforms the body. Colors end where 99.5 % of the
        area do, since stresses at tips have no largest value, unless ``vmin`` and ``vmax`` say otherwise.

        Raises ``ImportError`` with a sentence without matplotlib, ``ValueError`` for another field.
        """
    def triangulation(self, scale: float = 0) -> Any:
        """For matplotlib: ``plt.tripcolor(r.triangulation(), r.von_mises)``. ``scale`` times the displacement deforms
        it."""
    def to_pandas(self, table: str = "fields") -> Any:
        """A DataFrame: "fields", a row per corner; "tips", a row per crack tip with K, G, T and their margins;
        "load_cases"; "history" of an optimization; or the name of a crack, its profile.

        Raises ``ImportError`` without pandas, ``ValueError`` for another table.
        """
    def to_pyvista(self) -> Any:
        """A ``pyvista.UnstructuredGrid`` with the fields; displacements have a third component, 0."""
    def to_meshio(self) -> Any:
        """A ``meshio.Mesh`` with the fields."""
    def to_vtk(self) -> Any:
        """A ``vtkUnstructuredGrid`` with the fields."""

class Values:
    """Values at the points that ``Result.at`` was asked for, of their leading shape (...). NaN outside the body."""

    points: NDArray[np.float64]
    """(..., 2)"""
    inside: NDArray[np.bool_]
    """(...), whether the body holds the point"""
    displacement: NDArray[np.float64]
    """(..., 2), a length"""
    stress: NDArray[np.float64]
    """(..., 4): s11, s12, s21, s22"""
    rotation: NDArray[np.float64]
    """(...), radians"""
    von_mises: NDArray[np.float64]
    """(...), a stress"""
    topological_derivative: NDArray[np.float64]
    """(...), with a map of this body"""
    masked: NDArray[np.bool_]
    """(...), where that cannot hold at the radius of the map"""
    def __getitem__(self, name: str) -> NDArray[Any]: ...
    def to_pandas(self) -> Any:
        """A DataFrame with a row per point: x, y, u_x, u_y, s_xx, s_yy, s_xy and the rest."""

class Section(Mapping[str, Any]):
    """A part of a result: a dict that cannot be written to, whose keys are attributes, too."""

    def __getitem__(self, key: str) -> Any: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def __getattr__(self, name: str) -> Any: ...
    def to_dict(self) -> dict[str, Any]:
        """As it stands in result.json."""

class Crack(Section):
    """A crack: what ``result["cracks"]`` says of it, its tips, and its profile as arrays."""

    name: str
    """what the case calls it"""
    length: float
    """a length"""
    max_opening: float
    """a length"""
    max_pressure: float
    """of contact, a stress"""
    tips: Named[Tip]
    """"start" and "end", as far as these are tips"""
    profile: dict[str, NDArray[Any]]
    """as ``Result.crack``; each of its arrays is an attribute, too"""

class Tip(Section):
    """A crack tip. What was not computed is None, and ``note`` may say why."""

    name: str
    """"start" or "end" of the path of its crack"""
    at: list[float]
    """x, y"""
    K_I: float | None
    """stress times the root of a length; opening"""
    K_II: float | None
    """the same; sliding"""
    G: float | None
    """energy release rate, energy per area"""
    T: float | None
    """T-stress, a stress"""
    margin: Section
    """of ``K_I``, ``K_II``, ``G``, ``T``: the truth is expected within value +- margin"""

class Named(list[_T], Generic[_T]):
    """A list whose items can be asked for by number and by name."""

    @overload  # type: ignore[override]
    def __getitem__(self, key: str | SupportsIndex) -> _T:
        """The item of that number or name. Raises ``KeyError`` that lists the names, or ``IndexError``."""
    @overload
    def __getitem__(self, key: slice) -> list[_T]: ...
    @property
    def names(self) -> list[str]:
        """Those of the items, in their order."""

class Designs:
    """The designs that numbers draw: variables, J, constraints, and their exact derivatives.

    Designs are evaluated one after the other, each on the mesh of an earlier one, moved: values are smooth in the
    variables, and derivatives are those of these values, to rounding. Where a mesh would suffer it is made anew, and
    values shift by what the mesh errs.
    """

    names: list[str]
    """of the n variables: "h.x", "h.y", "h.radius" """
    lower: NDArray[np.float64]
    """(n,)"""
    upper: NDArray[np.float64]
    """(n,)"""
    start: NDArray[np.float64]
    """(n,), that of the case"""
    constraints: list[str]
    """what is wrong when each of the c constraints is violated, in words"""
    def __len__(self) -> int: ...
    def evaluate(self, x: ArrayLike, *, gradient: bool = True) -> DesignValues:
        """Draws, meshes and solves the design ``x``, of shape (n,).

        A design that cannot be drawn, meshed or solved comes back with ``failure``. Raises ``CaseError`` outside of the
        bounds.
        """
    def new_mesh(self) -> None:
        """From now on meshes are made anew, as after a step that was taken."""
    def scipy(self) -> dict[str, Any]:
        """The arguments of ``scipy.optimize.minimize(**designs.scipy(), method="SLSQP")``: ``fun`` (with gradients),
        ``jac``, ``x0``, ``bounds``, ``constraints``. A design that cannot be evaluated gets a value that is worse than
        the last one."""

class DesignValues:
    """What is known of a design."""

    value: float
    """what is minimized: J, weighted over load cases, and the price of the area"""
    gradient: NDArray[np.float64] | None
    """(n,), of ``value``"""
    constraints: NDArray[np.float64]
    """(c,), to be at most 0; relative: 1 is a large violation"""
    jacobian: NDArray[np.float64] | None
    """(c, n)"""
    objective: float
    """J alone"""
    volume_fraction: float
    """area over that of the body without the drawn holes"""
    bounds: NDArray[np.float64]
    """values of the functionals in ``[[optimize.bound]]``, the worst load case"""
    triangles: int
    """of the mesh"""
    failure: str | None
    """why the design cannot be evaluated: the values are then not numbers"""

@overload
def sweep(
    case: Case | str | PathLike[str] | dict[str, Any],
    over: Mapping[str, Iterable[Any]],
    *,
    folder: str | PathLike[str],
    write: None = None,
    set: Mapping[str, Any] | None = None,
    jobs: int | None = None,
    threads: int = 1,
    client: Any = None,
    on_run: Callable[[str], object] | None = None,
) -> Sweep:
    """Runs the case once for every combination of values: ``over={"crack.c.path": [...], "material.poisson": [...]}``.

    Every run has a folder of its own under ``folder``, as ``kerf run`` makes it. The same call again keeps what is done
    and has the same case, and runs the rest; failures are kept and listed, and do not end the sweep. Runs are processes
    of this machine, ``jobs`` at a time (one per core); with ``client``, of dask.distributed, tasks of its workers, which
    must see the folder. With ``write="snakemake"`` or ``"slurm"`` nothing is run: a script is written, and what to type
    is returned. ``on_run(name)`` is called after every run.

    Raises ``CaseError`` for keys and values that no case takes.
    """
@overload
def sweep(
    case: Case | str | PathLike[str] | dict[str, Any],
    over: Mapping[str, Iterable[Any]],
    *,
    folder: str | PathLike[str],
    write: Literal["snakemake", "slurm"],
    set: Mapping[str, Any] | None = None,
    jobs: int | None = None,
    threads: int = 1,
    client: Any = None,
    on_run: Callable[[str], object] | None = None,
) -> str: ...

class Sweep:
    """What a sweep left."""

    folder: pathlib.Path
    """where every run has a folder of its own: ``kerf.load(sweep.folder / row["run"])``"""
    rows: list[dict[str, Any]]
    """of its table: numbers and words"""
    failures: list[dict[str, Any]]
    """the rows of runs that failed"""
    def column(self, name: str) -> list[Any]:
        """One column of the table: ``"cracks.c.tips[1].K_I"``."""
    def __len__(self) -> int: ...
    def summary(self) -> str:
        """What ``kerf sweep`` prints at the end."""
    def to_pandas(self) -> Any:
        """A DataFrame with a row per run."""

class Error(Exception):
    """Whatever kerf cannot do."""

    exit_code: int
    """that of the program"""
    where: str | None
    """the path of the key (``crack[0].path``) or ``file:line:column``; None where no key is to blame"""

class CaseError(Error, ValueError):
    """A case that cannot be read, or asked for what it does not name. Exit code 2."""

class GeometryError(Error, ValueError):
    """A body that cannot be: the message names the crack, the hole, the label. Exit code 3."""

class SolveError(Error, ArithmeticError):
    """Not solvable, not converged, infeasible, too large, or stopped. Exit code 4."""

    result: Result | None
    """what was found"""

class FilesError(Error, OSError):
    """A file that cannot be read or written. Exit code 5."""
