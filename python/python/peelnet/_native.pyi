"""Types of the native half; `help(peelnet.extract)` and so on have the texts."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, Protocol, TypeAlias, final, overload

import numpy as np
from numpy.typing import NDArray

__version__: str

_Path: TypeAlias = str | PathLike[str]
_SceneLike: TypeAlias = Scene | _Path
_Scenes: TypeAlias = _SceneLike | Iterable[_SceneLike]
_Vec3: TypeAlias = tuple[float, float, float]
_Size: TypeAlias = tuple[int, int]
_Recipe: TypeAlias = Literal[
    "thesis", "small", "medium", "large", "anchored-small", "anchored-medium", "nmt", "dfaoit"
]

class _Bar(Protocol):
    total: Any

    def update(self, n: Any = ..., /) -> Any: ...
    def close(self) -> Any: ...

_Progress: TypeAlias = bool | _Bar | None

class PeelnetError(Exception): ...

@final
class Camera:
    def __new__(
        cls,
        position: Sequence[float],
        target: Sequence[float],
        *,
        up: Sequence[float] = ...,
        fov_y_degrees: float = 45.0,
        near: float = 0.1,
        far: float = 100.0,
    ) -> Camera: ...
    @property
    def position(self) -> _Vec3: ...
    @property
    def target(self) -> _Vec3: ...
    @property
    def up(self) -> _Vec3: ...
    @property
    def fov_y_degrees(self) -> float: ...
    @property
    def near(self) -> float: ...
    @property
    def far(self) -> float: ...
    def orbited(self, degrees: float) -> Camera: ...

@final
class Scene:
    def __new__(
        cls, path: _Path, *, time: float | None = None, files_from: Sequence[_Path] = ...
    ) -> Scene: ...
    @staticmethod
    def from_bytes(
        name: _Path, data: bytes, *, files: Mapping[str, bytes] | None = None, time: float | None = None
    ) -> Scene: ...
    def at(self, time: float) -> Scene: ...
    @property
    def name(self) -> str: ...
    @property
    def hash(self) -> str: ...
    @property
    def views(self) -> list[Camera]: ...
    @property
    def triangles(self) -> int: ...
    @property
    def background(self) -> _Vec3: ...
    @property
    def held_out(self) -> bool: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def timeline(self) -> list[float]: ...

@final
class Rows:
    def __len__(self) -> int: ...
    @property
    def columns(self) -> list[str]: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def to_numpy(self, columns: Sequence[str] | None = None) -> dict[str, NDArray[Any]]: ...

@final
class Dataset:
    def __new__(cls, path: _Path) -> Dataset: ...
    def __len__(self) -> int: ...
    @property
    def path(self) -> PathLike[str]: ...
    @property
    def hash(self) -> str: ...
    @property
    def pixels(self) -> int: ...
    @property
    def manifest(self) -> dict[str, Any]: ...
    def verify(self) -> None: ...
    def read(self) -> Rows: ...

@final
class Model:
    @staticmethod
    def load(path: _Path) -> Model: ...
    @staticmethod
    def shipped(recipe: _Recipe) -> Model: ...
    @staticmethod
    def from_bytes(data: bytes) -> Model: ...
    @classmethod
    def from_state_dict(cls, state: Mapping[str, Any], *, like: Model) -> Model: ...
    def save(self, path: _Path, *, force: bool = False) -> None: ...
    def to_bytes(self) -> bytes: ...
    def weights(self) -> dict[str, NDArray[np.float32]]: ...
    def state_dict(self) -> dict[str, Any]: ...
    def predict(self, inputs: NDArray[np.float32]) -> NDArray[np.float32]: ...
    @property
    def recipe(self) -> str: ...
    @property
    def method(self) -> str: ...
    @property
    def topology(self) -> str: ...
    @property
    def parameters(self) -> int: ...
    @property
    def inputs(self) -> list[str]: ...
    @property
    def hash(self) -> str: ...
    @property
    def meta(self) -> dict[str, Any]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, tuple[bytes]]: ...

@final
class Epoch:
    @property
    def epoch(self) -> int: ...
    @property
    def epochs(self) -> int: ...
    @property
    def train_loss(self) -> float: ...
    @property
    def held_out_loss(self) -> float | None: ...
    @property
    def seconds(self) -> float: ...
    @property
    def rows_per_s(self) -> float: ...
    @property
    def best(self) -> bool: ...

@final
class Training:
    @property
    def model(self) -> Model: ...
    @property
    def history(self) -> list[Epoch]: ...
    @property
    def end(self) -> str: ...
    @property
    def model_epoch(self) -> int: ...
    @property
    def resumed_from(self) -> int | None: ...

@final
class Choice:
    @property
    def method(self) -> str: ...
    @property
    def time_ms(self) -> float: ...
    @property
    def mse_linear(self) -> float: ...
    @property
    def bytes_per_pixel(self) -> float: ...

@final
class Recommendation:
    @property
    def best(self) -> Choice: ...
    @property
    def runner_up(self) -> Choice | None: ...
    @property
    def why(self) -> str: ...

def adapter_name(adapter: str = "auto") -> str: ...
def methods() -> list[str]: ...
def samples() -> list[str]: ...
@overload
def render(
    scene: _SceneLike,
    method: str = "abuffer",
    *,
    size: _Size = ...,
    view: int | None = None,
    camera: Camera | None = None,
    time: float | None = None,
    samples: int = 1,
    model: Model | _Path | None = None,
    dtype: Literal["float32"] = "float32",
    adapter: str = "auto",
) -> NDArray[np.float32]: ...
@overload
def render(
    scene: _SceneLike,
    method: str = "abuffer",
    *,
    size: _Size = ...,
    view: int | None = None,
    camera: Camera | None = None,
    time: float | None = None,
    samples: int = 1,
    model: Model | _Path | None = None,
    dtype: Literal["uint8"],
    adapter: str = "auto",
) -> NDArray[np.uint8]: ...
@overload
def extract(
    scenes: _Scenes,
    *,
    out: None = None,
    size: _Size = ...,
    views: int | None = None,
    pixels: float = 1.0,
    augment: int = 0,
    seed: int = 1,
    peel: str = "sbuffer",
    max_passes: int | None = None,
    format: str = "parquet",
    shard: str | None = None,
    resume: bool = False,
    adapter: str = "auto",
    progress: _Progress = None,
) -> Rows: ...
@overload
def extract(
    scenes: _Scenes,
    *,
    out: _Path,
    size: _Size = ...,
    views: int | None = None,
    pixels: float = 1.0,
    augment: int = 0,
    seed: int = 1,
    peel: str = "sbuffer",
    max_passes: int | None = None,
    format: str = "parquet",
    shard: None = None,
    resume: bool = False,
    adapter: str = "auto",
    progress: _Progress = None,
) -> Dataset: ...
@overload
def extract(
    scenes: _Scenes,
    *,
    out: _Path,
    size: _Size = ...,
    views: int | None = None,
    pixels: float = 1.0,
    augment: int = 0,
    seed: int = 1,
    peel: str = "sbuffer",
    max_passes: int | None = None,
    format: str = "parquet",
    shard: str,
    resume: bool = False,
    adapter: str = "auto",
    progress: _Progress = None,
) -> Dataset | None: ...
def seal(path: _Path) -> Dataset: ...
def train(
    data: Dataset | _Path | Iterable[Dataset | _Path],
    *,
    recipe: str = "medium",
    out: _Path | None = None,
    epochs: int | None = None,
    batch: int | None = None,
    lr: float | None = None,
    schedule: str | None = None,
    hidden: Sequence[int] | None = None,
    patience: int | None = None,
    loss: str | None = None,
    seed: int = 1,
    max_rows: int | None = None,
    stream: bool = False,
    buffer_rows: int | None = None,
    split: str = "scene",
    threads: int | None = None,
    resume: bool = False,
    loss_curve: Sequence[_Path] | None = None,
    callback: Callable[[Epoch], object] | None = None,
    progress: _Progress = None,
    force: bool = False,
) -> Training: ...
def export(
    model: Model | _Path,
    language: str = "wgsl",
    *,
    precision: str = "f32",
    verify: bool = True,
    adapter: str = "auto",
) -> str: ...
def bench(
    scenes: _Scenes,
    methods: Sequence[str] | None = None,
    *,
    models: Sequence[Model | _Path] | None = None,
    size: _Size = ...,
    views: int | None = None,
    frames: int = 5,
    samples: int = 1,
    adapter: str = "auto",
    progress: _Progress = None,
) -> Any: ...
def recommend(
    scene: _SceneLike,
    *,
    budget_ms: float | None = None,
    max_error: float | None = None,
    max_bytes: float | None = None,
    results: Any = None,
    size: _Size = ...,
    frames: int = 3,
    adapter: str = "auto",
    progress: _Progress = None,
) -> Recommendation: ...
