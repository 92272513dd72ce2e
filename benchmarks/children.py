# SPDX-License-Identifier: GPL-3.0-or-later
"""One process per run: what it takes is its own, and what breaks it breaks nothing else."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

Row = dict[str, Any]

_running: set[subprocess.Popen[bytes]] = set()
_lock = threading.Lock()
_stopping = threading.Event()


def key_of(row: Row) -> tuple[str, str, int, bool]:
    """What a row, or the request for one, is of."""
    name = row["id"] if "id" in row else row["pair"]["id"]
    return name, row["method"], row["rotation"], row["reverse"]


def run_child(request: Row, limit: float, logs: Path) -> Row:
    """Run one request and return its row; a crash or a timeout is a failed row like any other.

    Args:
        limit: seconds after which the process is ended.
        logs: folder for what it prints.
    """
    pair = request["pair"]
    name = f"{pair['id']}.{request['method']}.{request['rotation']}{'.reversed' if request['reverse'] else ''}"
    row: Row = {
        "id": pair["id"],
        "collection": pair["collection"],
        "category": pair["category"],
        "method": request["method"],
        "rotation": request["rotation"],
        "reverse": request["reverse"],
        "build": request["build"],
        "settings": request["settings"],
        "threads": request["threads"],
        "jobs": request["jobs"],
        "has_truth": pair["gt_kind"] != "none",
        "has_overlap": _has_overlap(pair, reverse=request["reverse"]),
        "status": "failed",
        "reason": None,
    }
    with tempfile.TemporaryDirectory() as folder, (logs / f"{name}.log").open("wb") as log:
        answer = Path(folder) / "row.json"
        started = time.perf_counter()
        code, peak, timed_out = _wait([sys.executable, "-m", "benchmarks.child", str(answer)], request, limit, log)
        row["process_seconds"] = round(time.perf_counter() - started, 3)
        row["process_peak_mb"] = round(peak, 1)
        if timed_out:
            return {**row, "reason": f"over the limit of {limit:g} s"}
        if code == 0 and answer.is_file():
            return {**row, **json.loads(answer.read_text(encoding="utf-8"))}
    reason = f"crashed: {signal.Signals(-code).name}" if code < 0 else f"ended with code {code} and no result"
    return {**row, "reason": f"{reason} (see logs/{name}.log)"}


def _has_overlap(pair: dict[str, str], *, reverse: bool) -> bool:
    """Whether this pair's overlap can be told, so that a failure counts as none; see cases.reversed_case()."""
    if reverse:
        return pair["gt_kind"] == "vertex" and pair["gt_minus1"] != "unknown" and pair["category"] != "pointcloud"
    return pair["gt_minus1"] == "unmatched"


def stop_children() -> None:
    """End every running process, and start no further."""
    _stopping.set()
    with _lock:
        for child in _running:
            _kill(child)


def _wait(command: list[str], request: Row, limit: float, log: Any) -> tuple[int, float, bool]:
    """Exit code, peak memory in MB, and whether the limit ended it."""
    environment = dict(os.environ)
    environment["PYTHONPATH"] = os.pathsep.join(
        [str(Path(__file__).resolve().parent.parent), *filter(None, [environment.get("PYTHONPATH")])]
    )
    if request["threads"] is not None:
        environment["OMP_NUM_THREADS"] = environment["OPENBLAS_NUM_THREADS"] = str(request["threads"])
    with _lock:
        if _stopping.is_set():
            return 1, 0.0, False
        child = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=log, stderr=subprocess.STDOUT, env=environment,
            start_new_session=True,
        )  # fmt: skip
        _running.add(child)
    assert child.stdin is not None
    try:
        child.stdin.write(json.dumps(request).encode())
        child.stdin.close()
    except BrokenPipeError:  # it died at its start; how is told by its exit code
        pass
    deadline = time.monotonic() + limit
    timed_out = False
    try:
        while True:
            pid, status, usage = os.wait4(child.pid, os.WNOHANG)
            if pid:
                break
            if not timed_out and time.monotonic() > deadline:
                timed_out = True
                _kill(child)
            time.sleep(0.02)
    finally:
        with _lock:
            _running.discard(child)
    child.returncode = os.waitstatus_to_exitcode(status)
    # Kilobytes on Linux, bytes on macOS.
    unit = 2**20 if sys.platform == "darwin" else 2**10
    return child.returncode, usage.ru_maxrss / unit, timed_out


def _kill(child: subprocess.Popen[bytes]) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child.pid, signal.SIGKILL)
