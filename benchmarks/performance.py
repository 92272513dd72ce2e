# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/performance.md and its curve, from the scaling.json of scripts/benchmark --scaling."""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path
from typing import Any

from benchmarks.scaling import Row, table

#: What is asked for: vertices, seconds at most, seconds aimed at.
LIMITS = ((5_100, 4.0, 1.5), (10_000, 5.0, 2.0), (50_000, 12.0, 8.0), (100_000, 25.0, 15.0), (1_000_000, 120.0, 60.0))
BEGIN, END = "<!-- measured: begin -->", "<!-- measured: end -->"


def main(arguments: list[str]) -> int:
    root = Path(__file__).resolve().parent.parent
    parser = argparse.ArgumentParser(prog="scripts/performance_report", description=__doc__)
    parser.add_argument("results", metavar="DIR", type=Path, help="folder with scaling.json")
    parser.add_argument("--page", metavar="FILE", type=Path, default=root / "docs/performance.md")
    given = parser.parse_args(arguments)
    content = json.loads((given.results / "scaling.json").read_text(encoding="utf-8"))
    page = given.page.read_text(encoding="utf-8")
    if page.count(BEGIN) != 1 or page.count(END) != 1:
        parser.error(f"{given.page} must hold {BEGIN} and {END} once each")
    pictures = given.page.parent / "pictures"
    pictures.mkdir(exist_ok=True)
    (pictures / "scaling.svg").write_text(curve(content["rows"]), encoding="utf-8")
    before, after = page.split(BEGIN)[0], page.split(END)[1]
    given.page.write_text(f"{before}{BEGIN}\n\n{measured(content)}\n{END}{after}", encoding="utf-8")
    return 0


def measured(content: dict[str, Any]) -> str:
    rows, options = content["rows"], content["options"]
    return "\n".join(
        [
            f"Pair `{options['pair']}`, preset {options['preset']}, median of {options['repeats']} runs,"
            f" {content['machine']['cores']} cores, {content['machine']['platform']}.",
            "",
            table(rows, content["exponents"]),
            "![Seconds and memory over vertices](pictures/scaling.svg)",
            "",
            "Against what is asked for:",
            "",
            verdicts(rows, content["exponents"]),
            "Seconds per stage, all threads:",
            "",
            stages(rows),
        ]
    )


def verdicts(rows: list[Row], exponents: dict[str, float | None]) -> str:
    most = max(row["threads"] for row in rows)
    found = {row["vertices"]: row for row in rows if row["threads"] == most and row["status"] == "ok"}
    single = {row["vertices"]: row for row in rows if row["threads"] == 1 and row["status"] == "ok"}
    lines = ["| what | asked | aim | measured | |", "| --- | ---: | ---: | ---: | --- |"]

    def add(what: str, asked: float, aim: str, value: float | None, holds: bool, unit: str) -> None:
        text = "not measured" if value is None else f"{value:.2f}{unit}"
        verdict = "" if value is None else ("holds" if holds else "**falls short**")
        lines.append(f"| {what} | {asked:g}{unit} | {aim} | {text} | {verdict} |")

    for vertices, asked, aim in LIMITS:
        value = found[vertices]["seconds"] if vertices in found else None
        add(f"{vertices:,} vertices", asked, f"{aim:g} s", value, value is not None and value <= asked, " s")
    largest = LIMITS[-1][0]
    memory = found[largest]["peak_mb"] / 1024 if largest in found else None
    add(f"memory of {largest:,} vertices", 8.0, "", memory, memory is not None and memory <= 8.0, " GB")
    for name, field, asked in (("time", "seconds", 1.1), ("memory", "peak_mb", 1.05)):
        value = exponents[field]
        add(f"exponent of {name}", asked, "", value, value is not None and value <= asked, "")
    gains = [single[v]["seconds"] / found[v]["seconds"] for v in found if v in single and most > 1]
    gain = min(gains) if gains else None
    add(f"least gain of {most} threads over one", 1.6, "", gain, gain is not None and gain >= 1.6, "")
    return "\n".join(lines) + "\n"


def stages(rows: list[Row]) -> str:
    most = max(row["threads"] for row in rows)
    chosen = [row for row in rows if row["threads"] == most and row["status"] == "ok"]
    names = list(dict.fromkeys(name for row in chosen for name in row["stages"]))
    lines = ["| vertices | " + " | ".join(names) + " |", "| ---: |" + " ---: |" * len(names)]
    lines += [
        f"| {row['vertices']:,} | " + " | ".join(f"{row['stages'].get(name, 0.0):.2f}" for name in names) + " |"
        for row in chosen
    ]
    return "\n".join(lines) + "\n"


def curve(rows: list[Row]) -> str:
    """Seconds (full line) and peak memory in GB (dashed) over vertices, both axes by powers of ten."""
    most = max(row["threads"] for row in rows)
    chosen = [row for row in rows if row["threads"] == most and row["status"] == "ok"]
    width, height, left, top, right, bottom = 560, 320, 60, 20, 20, 45
    low_x, high_x, low_y, high_y = 3.5, 6.1, -1.5, 2.5

    def place(vertices: float, value: float) -> str:
        x = left + (math.log10(vertices) - low_x) / (high_x - low_x) * (width - left - right)
        y = height - bottom - (math.log10(value) - low_y) / (high_y - low_y) * (height - top - bottom)
        return f"{x:.1f},{min(max(y, top), height - bottom):.1f}"

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif"'
        ' font-size="12"><rect width="100%" height="100%" fill="#fff"/>'
    ]
    for power, text in ((4, "10,000"), (5, "100,000"), (6, "1 million")):
        x = place(10**power, 1).split(",")[0]
        parts.append(f'<path d="M{x} {top}V{height - bottom}" stroke="#ddd"/>')
        parts.append(f'<text x="{x}" y="{height - bottom + 18}" text-anchor="middle">{text}</text>')
    for power in range(-1, 3):
        y = place(1e4, 10.0**power).split(",")[1]
        parts.append(f'<path d="M{left} {y}H{width - right}" stroke="#ddd"/>')
        parts.append(f'<text x="{left - 8}" y="{y}" text-anchor="end" dy="4">{10.0**power:g}</text>')
    for field, scale, colour, dash, name, row_y in (
        ("seconds", 1.0, "#1b6ca8", "", "seconds", top + 14),
        ("peak_mb", 1.0 / 1024.0, "#c0392b", ' stroke-dasharray="6 4"', "GB of memory", top + 32),
    ):
        points = " ".join(place(row["vertices"], row[field] * scale) for row in chosen)
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"{dash}/>')
        parts.append(f'<path d="M{left + 12} {row_y - 4}h30" stroke="{colour}" stroke-width="2"{dash}/>')
        parts.append(f'<text x="{left + 50}" y="{row_y}">{name}</text>')
    parts.append(
        f'<text x="{(left + width - right) / 2}" y="{height - 8}" text-anchor="middle">vertices of either</text>'
    )
    return "".join(parts) + "</svg>\n"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
