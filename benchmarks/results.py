# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows as they come in, kept as JSON and as a Markdown page; a later run goes on where one ended."""

from __future__ import annotations

import json
import os
import platform
from pathlib import Path
from typing import Any

from benchmarks.children import Row, key_of
from benchmarks.levels import judged, motions
from benchmarks.reliability import reliabilities
from benchmarks.summary import summarise
from benchmarks.tables import collection_table, line, page


class Results:
    """Collects rows; after each, results.json and results.md in `folder` hold all so far.

    Rows that are there already stay, so that several runs (reversed, moved, the peers) add up to one page. Those of
    another build or with other settings than `request_keys` are to have are set aside in a file of their own.
    """

    def __init__(self, folder: Path, options: dict[str, Any], *, order: list[str], fresh: bool = False) -> None:
        self._folder = folder
        self._options = options
        self._order = {name: place for place, name in enumerate(order)}
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / "results.json"
        self._rows: list[Row] = [] if fresh or not path.is_file() else read_results(path)["rows"]

    def set_aside(self, builds: dict[str, str], settings: dict[str, Any]) -> int:
        """Drop the rows of these methods that another build or other settings made; how many there were."""
        stale = [
            row
            for row in self._rows
            if row["method"] in builds and (row["build"] != builds[row["method"]] or row["settings"] != settings)
        ]
        if stale:
            name = f"results.{stale[0]['build'].replace(' ', '_')}.json"
            _replace(self._folder / name, self._json(self._rows))
            self._rows = [row for row in self._rows if not any(row is old for old in stale)]
        return len(stale)

    def has(self, request: Row) -> bool:
        """Whether this is measured already; what failed is tried again."""
        key = key_of(request)
        return any(row["status"] == "ok" and key_of(row) == key for row in self._rows)

    def add(self, row: Row) -> None:
        key = key_of(row)
        self._rows = [old for old in self._rows if key_of(old) != key]
        self._rows.append(row)
        self._rows.sort(key=lambda r: (self._order.get(r["id"], len(self._order)), r["reverse"], r["rotation"]))
        self.write()
        print(line(row), flush=True)

    def write(self) -> None:
        _replace(self._folder / "results.json", self._json(self._rows))
        _replace(self._folder / "results.md", page(self._rows, self._options))

    def summary(self) -> str:
        return collection_table(summarise(self._rows))

    def _json(self, rows: list[Row]) -> str:
        content = {
            "options": self._options,
            "machine": {
                "cores": os.cpu_count(),
                "platform": platform.platform(),
                "python": platform.python_version(),
            },
            "collections": summarise(rows),
            "levels": judged(rows),
            "motions": motions(rows),
            "reliability": reliabilities(rows),
        }
        head = json.dumps(content, indent=1, allow_nan=False).rstrip("\n}")
        # A line per row: the samples in it are long.
        lines = ",\n  ".join(json.dumps(row, allow_nan=False) for row in rows)
        return f'{head},\n "rows": [\n  {lines}\n ]\n}}\n'


def read_results(path: Path) -> dict[str, Any]:
    """What Results wrote."""
    content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return content


def _replace(path: Path, text: str) -> None:
    part = path.with_suffix(path.suffix + ".part")
    part.write_text(text, encoding="utf-8")
    part.replace(path)
