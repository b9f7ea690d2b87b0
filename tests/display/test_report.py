"""The report is one well-formed page that needs nothing else and believes no name."""

import base64
import re
import time
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from echofuse.display.report import write_report
from echofuse.display.report_page import page
from echofuse.result import RunResult

VOID = {"meta", "img", "br"}


class Checker(HTMLParser):
    """Keeps the open tags and what the page refers to."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: set[str] = set()
        self.sources: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.add(tag)
        self.sources += [value or "" for name, value in attrs if name in ("src", "href")]
        assert not any(name.startswith("on") for name, _ in attrs)
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def checked(text: str) -> Checker:
    checker = Checker()
    checker.feed(text)
    assert checker.open == []
    return checker


def test_report_is_complete_and_alone(make_run: Callable[..., RunResult], tmp_path: Path) -> None:
    run = make_run(n_frames=12, n_nodes=2, n_people=2)
    report = write_report(run, tmp_path / "new" / "folder")
    assert report == tmp_path / "new" / "folder" / "report.html"
    text = report.read_text(encoding="utf-8")
    found = checked(text)
    assert "script" not in found.seen
    assert "link" not in found.seen
    assert "@import" not in text
    pictures = sorted((report.parent / "figures").glob("*.png"))
    assert len(pictures) == 2 + 2 * 2
    assert all(source.startswith("data:image/png;base64,") for source in found.sources)
    embedded = {base64.b64decode(source.partition(",")[2]) for source in found.sources}
    assert embedded == {picture.read_bytes() for picture in pictures}


def test_metrics_stand_beside_baseline_and_paper(run: RunResult) -> None:
    text = page(
        replace(
            run, metrics={**run.metrics, "own_thing_ms": 2.5, "p50_m": float("nan"), "ospa_m": float("inf")}
        ),
        [],
    )
    rows = {
        key: re.findall(r"<td>(.*?)</td>", row)
        for row in re.findall(r"<tr>(.*?)</tr>", text)
        for key in re.findall(r"<code>(.*?)</code>", row)
    }
    assert rows["rmse_m"] == ["0.098 m", "0.180 m", "0.36 m"]
    assert rows["p80_m"] == ["0.130 m", "0.240 m", "0.40 m"]
    assert rows["tracked_fraction"] == ["98.0 %", "97.0 %", "–"]
    assert rows["ospa_m"] == ["∞", "0.200 m", "–"]
    assert rows["p50_m"] == ["–", "0.150 m", "–"]
    assert rows["own_thing_ms"] == ["2.500 ms", "–", "–"]


def test_only_trouble_is_marked(run: RunResult) -> None:
    text = page(run, [])
    assert "<td class='marked'>2</td>" in text  # two frames lost
    assert text.count("class='marked'") == 1
    assert "<td>61</td>" in text  # scans are work done


def test_names_are_escaped(run: RunResult, tmp_path: Path) -> None:
    evil = "<script>alert('&')</script>../x"
    nodes = tuple(replace(node, name=evil) if node.name == "rx4" else node for node in run.recording.nodes)
    hostile = replace(
        run,
        site=replace(run.site, name="<b>site</b>"),
        recording=replace(run.recording, nodes=nodes, created="<i>now"),
        stacks={evil: run.stacks["rx4"]},
        shown_taps={evil: run.shown_taps["rx4"]},
        counters={evil: {"<u>": 3}, "hub": {}},
        metrics={"<s>": 1.0},
    )
    report = write_report(hostile, tmp_path)
    seen = checked(report.read_text(encoding="utf-8")).seen
    assert not seen & {"script", "b", "i", "u", "s"}
    assert all(path.parent == tmp_path / "figures" for path in tmp_path.rglob("*.png"))


def test_run_without_anything(run: RunResult, tmp_path: Path) -> None:
    empty = replace(
        run,
        recording=replace(run.recording, truth=()),
        frame_time_us=run.frame_time_us[:0],
        detections=run.detections[:0],
        points=run.points[:0],
        tracks=run.tracks[:0],
        baseline_tracks=run.baseline_tracks[:0],
        metrics={},
        baseline_metrics={},
        counters={},
        stacks={},
        shown_taps={},
    )
    text = write_report(empty, tmp_path).read_text(encoding="utf-8")
    checked(text)
    assert "No truth was recorded" in text


@pytest.mark.slow
@pytest.mark.parametrize(("n_frames", "limit_s"), [(61, 8.0), (1024, 25.0)])
def test_report_is_quick(
    make_run: Callable[..., RunResult], tmp_path: Path, n_frames: int, limit_s: float
) -> None:
    run = make_run(n_frames=n_frames, n_nodes=7)
    before_s = time.process_time()
    write_report(run, tmp_path)
    assert time.process_time() - before_s < limit_s
    assert np.all([path.stat().st_size < 1_000_000 for path in (tmp_path / "figures").iterdir()])
