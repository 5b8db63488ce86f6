# What the extension module gives; crates/stiffarm-py/src documents each. Results come as the text of their JSON,
# with whether Ctrl-C stopped the work.

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "MOST_POSTURES",
    "Cell",
    "Objective",
    "__version__",
    "axes_table",
    "certificate",
    "check",
    "compensate",
    "coverage",
    "csv_of_stream",
    "degrees",
    "evaluate",
    "flange_pose",
    "identify",
    "identify_with_flange_fixed",
    "index_names",
    "indices",
    "inverse",
    "jacobian",
    "json_of_toml",
    "map",
    "nearest",
    "observation_matrix",
    "place_workpiece",
    "posture_text",
    "predict",
    "radians",
    "read_postures",
    "register",
    "robots",
    "select",
    "select_candidates",
    "select_curve",
    "select_drop",
    "select_space_filling",
    "set_threads",
    "simulate",
    "simulate_measurements",
    "stream_of_columns",
    "toml_of_json",
    "urdf_table",
    "validate",
]

MOST_POSTURES: int
__version__: str

_Floats: TypeAlias = NDArray[np.float64]
_Given: TypeAlias = str | tuple[str, bytes]
_GivenPostures: TypeAlias = str | tuple[str, bytes] | tuple[list[str], _Floats]
_Groups: TypeAlias = Sequence[tuple[str, _GivenPostures]]
_Progress: TypeAlias = Callable[[str, int, int], Any] | None
_Found: TypeAlias = tuple[str, bool]
_Keys: TypeAlias = Mapping[str, Any]

@final
class Cell:
    def __new__(cls, name: str, text: bytes, files: Mapping[str, bytes], folder: str | None = None) -> Cell: ...
    @staticmethod
    def built_in(name: str) -> Cell: ...
    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def text(self) -> bytes: ...
    @property
    def files(self) -> dict[str, bytes]: ...
    @property
    def inputs(self) -> dict[str, str]: ...
    @property
    def robot_name(self) -> str: ...
    @property
    def joint_count(self) -> int: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def spring_names(self) -> list[str]: ...
    @property
    def limits(self) -> _Floats: ...
    @property
    def bounds(self) -> _Floats: ...
    @property
    def prior(self) -> _Floats | None: ...
    @property
    def noise_std(self) -> float: ...
    @property
    def characteristic_length(self) -> float | None: ...
    @property
    def measuring_point_names(self) -> list[str]: ...
    @property
    def measuring_points(self) -> _Floats: ...
    @property
    def loading_point(self) -> _Floats: ...
    def __reduce__(self) -> tuple[type[Cell], tuple[str, bytes, dict[str, bytes]]]: ...

@final
class Objective:
    def __new__(cls, cell: Cell, index: str, postures: int, given: _Floats) -> Objective: ...
    @property
    def index(self) -> str: ...
    def value(self, q: _Floats) -> float: ...
    def log_and_gradient(self, q: _Floats) -> tuple[float, _Floats]: ...
    def smoothed(self, q: _Floats, sharpness: float) -> tuple[float, float, _Floats]: ...

def axes_table(
    name: str,
    joint_names: Sequence[str],
    points: Sequence[Sequence[float]],
    directions: Sequence[Sequence[float]],
    flange: _Floats,
    limits: Sequence[Sequence[float]] | None = None,
) -> str: ...
def certificate(
    cell: Cell,
    index: str,
    postures: _GivenPostures,
    given: _GivenPostures | None,
    samples: int | None,
    progress: _Progress,
) -> _Found: ...
def compensate(cell: Cell, stiffness: _Given, path: _Given, along: _Keys, progress: _Progress) -> _Found: ...
def coverage(
    cell: Cell,
    postures: _GivenPostures,
    runs: int,
    seed: int,
    fit: _Keys,
    bootstrap: int | None,
    progress: _Progress,
) -> _Found: ...
def csv_of_stream(table: object) -> str: ...
def degrees(angles: _Floats) -> _Floats: ...
def evaluate(cell: Cell, groups: _Groups) -> _Found: ...
def flange_pose(cell: Cell, q: _Floats) -> _Floats: ...
def identify(
    cell: Cell,
    measurements: Sequence[_Given],
    postures: _GivenPostures | None,
    registration: _Given | None,
    exclude: Sequence[str],
    fit: _Keys,
    bootstrap: int | None,
    seed: int,
    brief: bool,
    progress: _Progress,
) -> _Found: ...
def identify_with_flange_fixed(
    cell: Cell,
    measurements: _Given,
    postures: _GivenPostures | None,
    exclude: Sequence[str],
    fit: _Keys,
    angle_noise_deg: float | None,
) -> str: ...
def index_names() -> list[tuple[str, str, bool]]: ...
def indices(cell: Cell, angles: _Floats, names: Sequence[str]) -> dict[str, _Floats]: ...
def inverse(cell: Cell, flange: _Floats) -> tuple[str, list[tuple[_Floats, bool, float, bool]]]: ...
def jacobian(cell: Cell, q: _Floats, at: Sequence[float] | None = None) -> _Floats: ...
def json_of_toml(text: str) -> str: ...
def map(
    cell: Cell,
    stiffness: _Given,
    region: _Keys,
    rpy_deg: Sequence[float] | None,
    free_turn: int | None,
    force_n: Sequence[float] | None,
    moment_nm: Sequence[float] | None,
    direction: Sequence[float] | None,
    progress: _Progress,
) -> _Found: ...
def nearest(cell: Cell, flange: _Floats, start: _Floats) -> _Floats: ...
def observation_matrix(cell: Cell, angles: _Floats, length: float | None = None) -> _Floats: ...
def place_workpiece(
    cell: Cell,
    stiffness: _Given,
    path: _Given,
    axes: str | None,
    region: _Keys,
    yaw_deg: Sequence[float],
    refine: int,
    free_turn: int | None,
    progress: _Progress,
) -> _Found: ...
def posture_text(names: Sequence[str], angles: _Floats) -> str: ...
def predict(
    cell: Cell,
    stiffness: _Given,
    path: _Given | None,
    along: _Keys,
    model: str,
    matrix: bool,
    cell_load: bool,
    load_case: str | None,
    progress: _Progress,
) -> _Found: ...
def radians(angles: _Floats, degrees: bool) -> _Floats: ...
def read_postures(cell: Cell, from_: str) -> tuple[list[str], _Floats]: ...
def register(pairs: _Given, std_mm: float | None, exclude: Sequence[str]) -> str: ...
def select(
    cell: Cell,
    index: str,
    count: int,
    initial: _GivenPostures | None,
    given: _GivenPostures | None,
    max_iterations: int,
    budget: _Keys,
    angle_step_deg: float,
    load: _Keys,
    certificate: bool,
    sensitivity: bool,
    prices: bool,
    accept: Callable[[_Floats], Any] | None,
    progress: _Progress,
) -> _Found: ...
def select_candidates(
    cell: Cell, index: str, count: int, candidates: _Given, seed: int | None, certificate: bool, progress: _Progress
) -> _Found: ...
def select_curve(
    cell: Cell, index: str, largest: int, budget: _Keys, certificate: bool, progress: _Progress
) -> _Found: ...
def select_drop(cell: Cell, index: str, given: _GivenPostures, drop: int, progress: _Progress) -> _Found: ...
def select_space_filling(
    cell: Cell, count: int, seed: int | None, angle_step_deg: float, progress: _Progress
) -> _Found: ...
def check(cell: Cell) -> _Found: ...
def robots() -> list[tuple[str, str, float | None, float | None]]: ...
def set_threads(threads: int) -> None: ...
def simulate(
    cell: Cell,
    groups: _Groups,
    runs: int | None,
    levels: Sequence[float] | None,
    elastic: str | None,
    seed: int,
    errors: _Keys,
    progress: _Progress,
) -> _Found: ...
def simulate_measurements(cell: Cell, postures: _GivenPostures, seed: int, readings: bool) -> str: ...
def stream_of_columns(names: Sequence[str], columns: Sequence[Sequence[Any]], requested: object) -> object: ...
def toml_of_json(json: str) -> str: ...
def urdf_table(
    text: str, name: str, base: str | None = None, tip: str | None = None
) -> tuple[str, str, str, list[str]]: ...
def validate(
    cell: Cell,
    stiffness: _Given | None,
    measurements: Sequence[_Given],
    postures: _GivenPostures | None,
    registration: _Given | None,
    model: str,
    tolerance_mm: float | None,
    only: Sequence[str],
    folds: int,
    fit: _Keys,
    progress: _Progress,
) -> _Found: ...
