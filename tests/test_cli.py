# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `isograft`: exit codes, what is printed where, and the files it leaves."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import isograft
import numpy as np
import pytest
import surfaces
from isograft.cli import main
from isograft.cli_outcome import ProgressLine
from isograft.files import read_mesh


def save_mesh(path: Path, mesh: surfaces.Mesh) -> Path:
    vertices = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in mesh[0].tolist())
    path.write_text(vertices + "".join(f"f {a} {b} {c}\n" for a, b, c in mesh[1] + 1))
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A blob, the same turned, its truth, and the map between them made by the command itself."""
    folder = tmp_path_factory.mktemp("cli")
    vertices, faces = surfaces.blob()
    save_mesh(folder / "source.obj", (vertices, faces))
    save_mesh(folder / "target.obj", (vertices @ surfaces.rotation().T, faces))
    (folder / "truth.txt").write_text("".join(f"{i}\n" for i in range(len(vertices))))
    (folder / "landmarks.json").write_text("[[0, 0], [5, 5]]")
    command = [sys.executable, "-m", "isograft.cli", "match", "source.obj", "target.obj", "-o", "map.npz"]
    options = ["--preset", "fast", "--scale", "fixed", "--threads", "2", "--seed", "4", "--landmarks", "landmarks.json"]
    done = subprocess.run(
        [*command, *options, "--json"], cwd=folder, capture_output=True, text=True, check=False, timeout=300
    )
    (folder / "stdout.json").write_text(done.stdout)
    (folder / "stderr.txt").write_text(done.stderr)
    assert done.returncode == 0, done.stderr
    return folder


def test_match_prints_one_json_object_and_nothing_else(folder: Path) -> None:
    summary = json.loads((folder / "stdout.json").read_text())
    best = isograft.Match.load(folder / "map.npz").best
    assert summary["matched"] == int(best.matched.sum())
    assert summary["vertices"] == len(best)
    assert summary["coverage"] == best.coverage > 0.9
    assert summary["exit_code"] == 0
    assert summary["report"]["seed"] == 4
    assert summary["report"]["preset"] == "fast"
    assert summary["report"]["scale"] == 1.0
    assert (folder / "stderr.txt").read_text() == ""


def test_match_gives_what_the_function_gives(folder: Path) -> None:
    loaded = isograft.Match.load(folder / "map.npz")
    source, target = (read_mesh(folder / name).surface() for name in ("source.obj", "target.obj"))
    ours = isograft.match(
        source, target, preset="fast", scale="fixed", seed=4, threads=2, landmarks={"source": [0, 5], "target": [0, 5]}
    )
    assert ours.best.points.tobytes() == loaded.best.points.tobytes()


def test_evaluate_prints_the_measures_for_people_and_for_machines(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["evaluate", str(folder / "map.npz"), "--truth", str(folder / "truth.txt")]
    command += ["--target", str(folder / "target.obj"), "--samples", "60"]
    assert main(command) == 0
    text = capsys.readouterr().out
    assert "error: " in text
    assert "overlap iou: -" in text
    assert main([*command, "--json", "--unmatched-is-truth"]) == 0
    values = json.loads(capsys.readouterr().out)
    assert values["exit_code"] == 0
    assert values["error"] < 3.0
    assert values["coverage"] > 0.9
    assert values["sampled"] == 60
    assert values["overlap_iou"] > 0.9


def test_evaluate_reads_corr_files(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    n = len(surfaces.blob()[0])
    faces = surfaces.blob()[1]
    corner_of = {int(v): (f, c) for f, triangle in enumerate(faces) for c, v in enumerate(triangle)}
    lines = [f"{corner_of[v][0] + 1} {' '.join(str(int(c == corner_of[v][1])) for c in range(3))}" for v in range(n)]
    (folder / "identity.corr").write_text("\n".join(lines) + "\n")
    command = ["evaluate", str(folder / "identity.corr"), "--truth", str(folder / "truth.txt"), "--json"]
    assert main([*command, "--target", str(folder / "target.obj"), "--samples", "50"]) == 0
    values = json.loads(capsys.readouterr().out)
    assert values["error"] == pytest.approx(0.0, abs=1e-4)
    assert values["coverage"] == 1.0


def nothing_matched(source: tuple[Any, ...], target: tuple[Any, ...], **_: Any) -> isograft.Match:
    n = len(source[0])
    none, nan = np.full(n, -1, np.int32), np.full((n, 3), np.nan)
    best = isograft.Correspondence(
        none, nan, nan, none, np.zeros(n), nan[:, 0], none, np.full((n, 3), -1, np.int32), len(target[0])
    )
    return isograft.Match(best, [], isograft.Report(warnings=("the surfaces have nothing in common",)))


@pytest.mark.parametrize("suffix", [".npz", ".corr", ".ply"])
def test_nothing_matched_is_code_three_and_the_map_is_still_written(
    folder: Path, tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("isograft.cli_match.match", nothing_matched)
    output = tmp_path / f"map{suffix}"
    assert main(["match", str(folder / "source.obj"), str(folder / "target.obj"), "-o", str(output), "--json"]) == 3
    captured = capsys.readouterr()
    assert json.loads(captured.out)["matched"] == 0
    assert "warning: the surfaces have nothing in common" in captured.err
    assert output.stat().st_size > 100
    if suffix == ".npz":
        command = ["evaluate", str(output), "--truth", str(folder / "truth.txt"), "--json"]
        assert main([*command, "--target", str(folder / "target.obj")]) == 3
        values = json.loads(capsys.readouterr().out)
        assert values["error"] is None
        assert values["coverage"] == 0.0


SOURCE, TARGET, OUT = "{folder}/source.obj", "{folder}/target.obj", "{tmp}/map.npz"


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ([], "required: COMMAND"),
        (["graft"], "invalid choice: 'graft'"),
        (["match", SOURCE, TARGET], "required: -o"),
        (["match", SOURCE, TARGET, "-o", OUT, "--preset", "best"], "invalid choice: 'best'"),
        (["match", SOURCE, TARGET, "-o", OUT, "--threads", "two"], "invalid int value: 'two'"),
        (["match", SOURCE, TARGET, "-o", OUT, "--threads", "0"], "threads must be from 1"),
        (["match", SOURCE, TARGET, "-o", OUT, "--seed", "-1"], "seed must be from 0"),
        (["match", SOURCE, TARGET, "-o", OUT, "--scale", "big"], '"auto", "fixed" or a number, not "big"'),
        (["match", SOURCE, TARGET, "-o", OUT, "--scale", "nan"], "scale must be finite"),
        (["match", SOURCE, TARGET, "-o", OUT, "--scale", "-1"], "scale must be positive"),
        (["match", SOURCE, TARGET, "-o", "{tmp}/map.txt"], "must end in .npz, .corr, .ply"),
        (["match", SOURCE, TARGET, "-o", "{tmp}/none/map.npz"], "there is no folder"),
        (["match", "{tmp}/none.ply", TARGET, "-o", OUT], "none.ply: No such file"),
        (["match", SOURCE, "{folder}/truth.txt", "-o", OUT], "cannot read .txt"),
        (["match", SOURCE, "{tmp}", "-o", OUT], "cannot read"),
        (["match", SOURCE, "{bad}/index_zero.obj", "-o", OUT], "index_zero.obj: line 4"),
        (["match", "{bad}/nan.ply", TARGET, "-o", OUT], "nan.ply: "),
        (["match", SOURCE, TARGET, "-o", OUT, "--landmarks", "{tmp}/none.json"], "none.json: No such file"),
        (["match", SOURCE, TARGET, "-o", OUT, "--landmarks", SOURCE], "source.obj: not JSON"),
        (["evaluate", "{folder}/map.npz", "--target", TARGET], "required: --truth"),
        (["evaluate", "{tmp}/none.npz", "--truth", "{folder}/truth.txt", "--target", TARGET], "none.npz: No such file"),
        (["evaluate", SOURCE, "--truth", "{folder}/truth.txt", "--target", TARGET], "read from .npz and .corr"),
        (["evaluate", "{folder}/map.npz", "--truth", "{tmp}/none", "--target", TARGET], "none"),
        (["evaluate", "{folder}/map.npz", "--truth", SOURCE, "--target", TARGET], "source.obj"),
        (["evaluate", "{folder}/map.npz", "--truth", "{folder}/truth.txt", "--target", "{tmp}/none.ply"], "none.ply"),
    ],
)
def test_wrong_usage_and_bad_input_are_code_two_with_the_reason_and_leave_no_file(
    folder: Path, tmp_path: Path, command: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    bad = Path(__file__).parent / "bad_inputs"
    assert main([part.format(folder=folder, tmp=tmp_path, bad=bad) for part in command]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert words in captured.err
    assert "Traceback" not in captured.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[[0, 1], [2]]", "entry 1 must be a pair"),
        ("[[0, 1.0]]", "entry 0: 1.0 is no vertex index"),
        ("[[0, true]]", "entry 0: true is no vertex index"),
        ("[[0, -1]]", "entry 0: -1 is no vertex index"),
        ("[[0, 1], 5]", "entry 1 must be a pair"),
        ('{"source": [0]}', 'two lists, "source" and "target"'),
        ('{"source": [0], "target": [0, 1]}', "1 of the source and 2 of the target"),
        ('{"source": [0], "target": "a"}', '"target" must be a list'),
        ('{"source": [0], "target": ["a"]}', '"target" entry 0'),
        ("[[0, 99999]]", "landmark 0: target vertex 99999 does not exist"),
        ('"a"', "must be a list of pairs"),
        ("[" * 100_000, "not JSON"),
        ("\x00\xff", "not JSON"),
    ],
)
def test_bad_landmarks_are_code_two_and_name_the_entry(
    folder: Path, tmp_path: Path, text: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "landmarks.json"
    path.write_bytes(text.encode("latin-1"))
    command = ["match", str(folder / "source.obj"), str(folder / "target.obj"), "-o", str(tmp_path / "map.npz")]
    assert main([*command, "--landmarks", str(path), "--json"]) == 2
    captured = capsys.readouterr()
    assert words in captured.err
    answer = json.loads(captured.out)
    assert words in answer["error"]["text"]
    assert answer["exit_code"] == 2


def test_a_failed_write_is_code_one(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("isograft.cli_match.match", nothing_matched)

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    output = tmp_path / "map.npz"
    assert main(["match", str(folder / "source.obj"), str(folder / "target.obj"), "-o", str(output)]) == 1
    assert "No space left on device" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_an_interrupt_is_code_130_and_leaves_no_file(folder: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "isograft.cli", "match", "source.obj", "target.obj", "--preset", "thorough"]
    child = subprocess.Popen(
        [*command, "--threads", "2", "--progress", "-o", str(tmp_path / "map.npz")],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert child.stderr is not None
        assert "%" in child.stderr.readline()  # the run is on
        start = time.monotonic()
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=60)
        assert time.monotonic() - start < 3.0
    finally:
        child.kill()
    assert child.returncode == 130
    assert out == ""
    assert err.endswith("isograft match: cancelled\n")
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


class Terminal:
    def __init__(self, is_terminal: bool) -> None:
        self.text = ""
        self.is_terminal = is_terminal

    def isatty(self) -> bool:
        return self.is_terminal

    def write(self, text: str) -> None:
        self.text += text

    def flush(self) -> None:
        pass


@pytest.mark.parametrize("is_terminal", [True, False])
def test_progress_is_one_line_on_a_terminal_and_few_lines_elsewhere(is_terminal: bool) -> None:
    stream = Terminal(is_terminal)
    line = ProgressLine(stream)  # type: ignore[arg-type]
    for i in range(1001):
        line("growth" if i < 500 else "dense", i / 1000)
    line.close()
    assert "growth" in stream.text
    assert "dense" in stream.text
    assert stream.text.count("\n") == (0 if is_terminal else 21)
    if is_terminal:
        assert stream.text.endswith("\r\033[K")
    else:
        assert stream.text.endswith("100 % dense\n")


def test_help_and_version_are_code_zero(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"isograft {isograft.__version__}\n"
    for command in ([], ["match"], ["evaluate"]):
        assert main([*command, "--help"]) == 0
        assert "exit codes: 0 ok" in capsys.readouterr().out
