# SPDX-License-Identifier: GPL-3.0-or-later
"""What a call of match() did, for logs and benchmarks."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass, field
from typing import Any

from isograft import _native
from isograft.errors import InvalidInput


@dataclass(frozen=True)
class StageReport:
    """Time of one stage, and the bytes of what it keeps for later stages."""

    name: str
    seconds: float
    bytes: int


@dataclass(frozen=True)
class Report:
    """What match() did.

    `scale` is sigma, target units per source unit; `unit_length` is the pair's unit length in the target's units;
    `options` are those the call ran with, by their names `<stage>_<field>`.
    """

    seconds: float = 0.0
    scale: float = 1.0
    unit_length: float = 1.0
    source_samples: int = 0
    target_samples: int = 0
    seeds_tried: int = 0
    maps_grown: int = 0
    maps_in_core: int = 0
    preset: str = "default"
    seed: int = 0
    stages: tuple[StageReport, ...] = ()
    warnings: tuple[str, ...] = ()
    options: dict[str, bool | int | float] = field(default_factory=dict)

    @classmethod
    def from_native(
        cls, native: _native.MatchReport, preset: str, seed: int, options: dict[str, bool | int | float]
    ) -> Report:
        return cls(
            seconds=native.seconds,
            scale=native.scale,
            unit_length=native.unit_length,
            source_samples=native.source_samples,
            target_samples=native.target_samples,
            seeds_tried=native.seeds_tried,
            maps_grown=native.maps_grown,
            maps_in_core=native.maps_in_core,
            preset=preset,
            seed=seed,
            stages=tuple(StageReport(stage.name, stage.seconds, stage.bytes) for stage in native.stages),
            warnings=tuple(native.warnings),
            options=options,
        )

    def to_dict(self) -> dict[str, Any]:
        """Plain types only, ready for JSON."""
        return dataclasses.asdict(self)

    def to_json(self) -> str:
        return json.dumps(self.to_dict())

    @classmethod
    def from_json(cls, text: str) -> Report:
        """Read to_json()'s text; later versions' keys are passed over. Raises InvalidInput if it is something else."""
        try:
            data = json.loads(text)
            known = {f.name for f in dataclasses.fields(cls)}
            values = {key: value for key, value in data.items() if key in known}
            values["stages"] = tuple(
                StageReport(str(s["name"]), float(s["seconds"]), int(s["bytes"])) for s in values.get("stages", ())
            )
            values["warnings"] = tuple(str(warning) for warning in values.get("warnings", ()))
        except (ValueError, TypeError, KeyError, AttributeError) as error:
            raise InvalidInput(f"the report is not one of isograft's: {error}") from None
        return cls(**values)
