# SPDX-License-Identifier: GPL-3.0-or-later
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

class InvalidInput(ValueError): ...
class ResourceLimit(MemoryError): ...
class Cancelled(Exception): ...

class Surface:
    @property
    def is_cloud(self) -> bool: ...
    @property
    def normals(self) -> npt.NDArray[np.float64]: ...
    @property
    def working_mesh(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]: ...
    @property
    def vertices(self) -> npt.NDArray[np.float64]: ...
    @property
    def faces(self) -> npt.NDArray[np.int32]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def orientation_is_ambiguous(self) -> bool: ...

def make_surfaces(
    parts: Sequence[tuple[str, npt.NDArray[np.float64], npt.NDArray[np.int32] | None, npt.NDArray[np.float64] | None]],
    threads: int,
    progress: Callable[[str, float], Any] | None,
) -> list[Surface]: ...
def gate_share(
    made: Sequence[tuple[int, int]],
    source: tuple[int, int],
    target: tuple[int, int],
    preset: str,
    overrides: dict[str, Any],
    threads: int,
) -> float: ...

class Correspondence:
    def __init__(
        self,
        face: npt.NDArray[np.int32],
        barycentric: npt.NDArray[np.float64],
        points: npt.NDArray[np.float64],
        vertex: npt.NDArray[np.int32],
        confidence: npt.NDArray[np.float64],
        stretch: npt.NDArray[np.float64],
        region: npt.NDArray[np.int32],
    ) -> None: ...
    @property
    def face(self) -> npt.NDArray[np.int32]: ...
    @property
    def corners(self) -> npt.NDArray[np.int32]: ...
    @property
    def barycentric(self) -> npt.NDArray[np.float64]: ...
    @property
    def points(self) -> npt.NDArray[np.float64]: ...
    @property
    def vertex(self) -> npt.NDArray[np.int32]: ...
    @property
    def confidence(self) -> npt.NDArray[np.float64]: ...
    @property
    def stretch(self) -> npt.NDArray[np.float64]: ...
    @property
    def region(self) -> npt.NDArray[np.int32]: ...

class StageReport:
    @property
    def name(self) -> str: ...
    @property
    def seconds(self) -> float: ...
    @property
    def bytes(self) -> int: ...

class MatchReport:
    @property
    def stages(self) -> list[StageReport]: ...
    @property
    def seconds(self) -> float: ...
    @property
    def scale(self) -> float: ...
    @property
    def unit_length(self) -> float: ...
    @property
    def source_samples(self) -> int: ...
    @property
    def target_samples(self) -> int: ...
    @property
    def seeds_tried(self) -> int: ...
    @property
    def maps_grown(self) -> int: ...
    @property
    def maps_in_core(self) -> int: ...
    @property
    def warnings(self) -> list[str]: ...

class Match:
    @property
    def correspondences(self) -> list[Correspondence]: ...
    @property
    def report(self) -> MatchReport: ...

def preset_options(name: str) -> dict[str, bool | int | float]: ...
def match(
    source: Surface,
    target: Surface,
    *,
    preset: str,
    overrides: dict[str, bool | int | float],
    landmarks: npt.NDArray[np.int32],
    landmark_weights: npt.NDArray[np.float64],
    scale_mode: str,
    scale_value: float,
    threads: int,
    seed: int,
    memory_limit: int,
    progress: Callable[[str, float], Any] | None,
) -> Match: ...
def check_memory(
    source: tuple[int, int],
    target: tuple[int, int],
    preset: str,
    overrides: dict[str, bool | int | float],
    threads: int,
    limit: int,
) -> int: ...
def geodesic_distances(
    surface: Surface, face: int, barycentric: Sequence[float], radius: float
) -> npt.NDArray[np.float64]: ...
def transfer_point(
    face: npt.NDArray[np.int32],
    barycentric: npt.NDArray[np.float64],
    vertex: npt.NDArray[np.int32],
    donor_faces: npt.NDArray[np.int32],
    values: npt.NDArray[np.float64],
    nearest: bool,
    progress: Callable[[str, float], Any] | None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_]]: ...
def uv_islands(
    faces: npt.NDArray[np.int32],
    values: npt.NDArray[np.float64],
    tolerance: float,
    vertices: npt.NDArray[np.float64],
    progress: Callable[[str, float], Any] | None,
) -> npt.NDArray[np.int32]: ...
def place_corners(
    face: npt.NDArray[np.int32],
    barycentric: npt.NDArray[np.float64],
    vertex: npt.NDArray[np.int32],
    receiver_vertices: npt.NDArray[np.float64],
    receiver_faces: npt.NDArray[np.int32],
    receiver_polygons: npt.NDArray[np.int32],
    donor_vertices: npt.NDArray[np.float64],
    donor_faces: npt.NDArray[np.int32],
    donor_values: npt.NDArray[np.float64],
    tolerance: float,
    extrapolation: float,
    threads: int,
    progress: Callable[[str, float], Any] | None,
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.float64], npt.NDArray[np.int32], npt.NDArray[np.bool_]]: ...
def transfer_corner_uv(
    face: npt.NDArray[np.int32],
    barycentric: npt.NDArray[np.float64],
    vertex: npt.NDArray[np.int32],
    receiver_vertices: npt.NDArray[np.float64],
    receiver_faces: npt.NDArray[np.int32],
    receiver_polygons: npt.NDArray[np.int32],
    donor_vertices: npt.NDArray[np.float64],
    donor_faces: npt.NDArray[np.int32],
    donor_values: npt.NDArray[np.float64],
    tolerance: float,
    extrapolation: float,
    threads: int,
    progress: Callable[[str, float], Any] | None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32], npt.NDArray[np.bool_]]: ...
def invert(
    face: npt.NDArray[np.int32],
    barycentric: npt.NDArray[np.float64],
    vertex: npt.NDArray[np.int32],
    confidence: npt.NDArray[np.float64],
    stretch: npt.NDArray[np.float64],
    region: npt.NDArray[np.int32],
    source_vertices: npt.NDArray[np.float64],
    source_faces: npt.NDArray[np.int32],
    target_vertices: npt.NDArray[np.float64],
    target_faces: npt.NDArray[np.int32],
    threads: int,
    progress: Callable[[str, float], Any] | None,
) -> Correspondence: ...
def local_frames(
    face: npt.NDArray[np.int32],
    barycentric: npt.NDArray[np.float64],
    vertex: npt.NDArray[np.int32],
    receiver_vertices: npt.NDArray[np.float64],
    receiver_faces: npt.NDArray[np.int32],
    donor_vertices: npt.NDArray[np.float64],
    donor_faces: npt.NDArray[np.int32],
    smoothing: int | None,
    threads: int,
    progress: Callable[[str, float], Any] | None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], float, npt.NDArray[np.bool_], bool]: ...
def bake(
    face: npt.NDArray[np.int32],
    barycentric: npt.NDArray[np.float64],
    vertex: npt.NDArray[np.int32],
    receiver_vertices: npt.NDArray[np.float64],
    receiver_faces: npt.NDArray[np.int32],
    receiver_uv: npt.NDArray[np.float64],
    wanted: npt.NDArray[np.bool_],
    donor_vertices: npt.NDArray[np.float64],
    donor_faces: npt.NDArray[np.int32],
    donor_materials: npt.NDArray[np.int32],
    channels: list[tuple[Any, ...]],
    width: int,
    height: int,
    margin: int,
    mask: npt.NDArray[np.uint8],
    threads: int,
    progress: Callable[[str, float], Any] | None,
) -> npt.NDArray[np.bool_]: ...
def paint(
    uv: npt.NDArray[np.float64],
    wanted: npt.NDArray[np.bool_],
    channels: list[tuple[Any, ...]],
    width: int,
    height: int,
    margin: int,
    mask: npt.NDArray[np.uint8],
    threads: int,
    progress: Callable[[str, float], Any] | None,
) -> None: ...
def fill_smooth(
    vertices: npt.NDArray[np.float64],
    faces: npt.NDArray[np.int32],
    values: npt.NDArray[np.float64],
    known: npt.NDArray[np.bool_],
    progress: Callable[[str, float], Any] | None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_]]: ...
def nearest_known(
    vertices: npt.NDArray[np.float64],
    faces: npt.NDArray[np.int32],
    known: npt.NDArray[np.bool_],
    progress: Callable[[str, float], Any] | None,
) -> npt.NDArray[np.int32]: ...
def corner_groups(
    faces: npt.NDArray[np.int32],
    values: npt.NDArray[np.float64],
    tolerance: float,
    vertices: npt.NDArray[np.float64],
    progress: Callable[[str, float], Any] | None,
) -> npt.NDArray[np.int32]: ...
def complete_rigid(
    rest: npt.NDArray[np.float64],
    faces: npt.NDArray[np.int32],
    placed: npt.NDArray[np.float64],
    known: npt.NDArray[np.bool_],
    scale: float,
    iterations: int,
    progress: Callable[[str, float], Any] | None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_]]: ...
def locate(
    face: npt.NDArray[np.int32],
    barycentric: npt.NDArray[np.float64],
    vertex: npt.NDArray[np.int32],
    receiver_vertices: npt.NDArray[np.float64],
    receiver_faces: npt.NDArray[np.int32],
    donor_vertices: npt.NDArray[np.float64],
    donor_faces: npt.NDArray[np.int32],
    point_faces: npt.NDArray[np.int32],
    point_weights: npt.NDArray[np.float64],
    threads: int,
    progress: Callable[[str, float], Any] | None,
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.float64]]: ...
