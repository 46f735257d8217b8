"""A mission as a film: GIF, or MP4 where ffmpeg is installed.

Each frame shows the map, the targets left and visited, blockades as far as known, the robots with
their trails, and as thin lines the way the plan in force sends them next.
"""

from __future__ import annotations

import shutil
import subprocess
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from scenarios.composition import Composition
from scenarios.maps.floor_plan import FREE, OCCUPIED, Point
from scenarios.mission_record import MissionRecord, PlanRecord, RobotRecord
from scenarios.report.markup import clock

Colour = tuple[int, int, int]
FLOOR, WALL, OUTSIDE = (255, 255, 255), (61, 72, 85), (236, 239, 243)
INK, SOFT = (22, 32, 43), (91, 104, 119)
BLOCKADE, CLEARED, UNSEEN = (194, 65, 12), (138, 150, 163), (214, 220, 226)
ROBOTS: tuple[Colour, ...] = (
    (29, 111, 214),
    (11, 143, 122),
    (194, 87, 12),
    (163, 38, 155),
    (106, 122, 0),
    (91, 75, 209),
    (176, 30, 79),
    (122, 90, 46),
)
TRAIL_S = 45.0
"""how much of its way a robot draws behind it"""
HEAD_PX = 30


class MovieError(ValueError):
    """A film that cannot be made; says how to get it."""


@dataclass(frozen=True)
class MovieSettings:
    """Size and pace of a film."""

    width_px: int = 900
    frames_per_s: int = 12
    speed: float = 20.0
    """simulated seconds a second"""


def write_movie(
    path: Path,
    record: MissionRecord,
    composition: Composition,
    settings: MovieSettings | None = None,
) -> Path:
    """Writes the film of a mission on its map.

    Raises:
        MovieError: the file's ending is neither .gif nor .mp4, or ffmpeg is missing or fails.
    """
    require_writable(path)
    stage = _Stage(record, composition, settings or MovieSettings())
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix.lower() == ".gif":
        _write_gif(path, stage)
    else:
        _write_mp4(path, stage)
    return path


def require_writable(path: Path) -> None:
    """Asks, before a mission is run for it, whether such a film can be written here.

    Raises:
        MovieError: its ending is neither .gif nor .mp4, or ffmpeg is missing.
    """
    ending = path.suffix.lower()
    if ending not in (".gif", ".mp4"):
        raise MovieError(f"{path}: a film is .gif or .mp4, not {ending or 'without an ending'}")
    if ending == ".mp4" and shutil.which("ffmpeg") is None:
        raise MovieError(
            f"{path}: an .mp4 needs ffmpeg (Debian: apt-get install ffmpeg); a .gif needs nothing"
        )


@dataclass(frozen=True)
class _Stage:
    """A mission that can be drawn at any of its moments."""

    record: MissionRecord
    building: Composition
    settings: MovieSettings

    @cached_property
    def scale(self) -> float:
        """Pixels a metre."""
        width_m: float = self.building.cells.shape[1] * self.building.resolution_m
        return self.settings.width_px / width_m

    @cached_property
    def ground(self) -> Image.Image:
        """The building, of even width and height as video codecs want it."""
        cells = self.building.cells
        picture = np.full((*cells.shape, 3), OUTSIDE, dtype=np.uint8)
        picture[cells == FREE] = FLOOR
        picture[cells == OCCUPIED] = WALL
        height_m = len(cells) * self.building.resolution_m
        size = (self.settings.width_px // 2 * 2, round(self.scale * height_m))
        building = Image.fromarray(picture[::-1]).resize(size, Image.Resampling.LANCZOS)
        whole = Image.new("RGB", (size[0], (size[1] + HEAD_PX) // 2 * 2), OUTSIDE)
        whole.paste(building, (0, HEAD_PX))
        return whole

    @cached_property
    def places(self) -> dict[str, Point]:
        """Targets and the middles of blockades by id."""
        middles = {
            b.id: (
                (b.segment_m[0][0] + b.segment_m[1][0]) / 2,
                (b.segment_m[0][1] + b.segment_m[1][1]) / 2,
            )
            for b in self.record.blockades
        }
        return middles | {target.id: target.position_m for target in self.record.targets}

    def at(self, point: Point) -> tuple[float, float]:
        """A position on the picture [px]."""
        height_m = len(self.building.cells) * self.building.resolution_m
        x, y = point[0] - self.building.origin_m[0], point[1] - self.building.origin_m[1]
        return x * self.scale, HEAD_PX + (height_m - y) * self.scale

    def frames(self) -> Iterator[Image.Image]:
        """All frames; the last one stands for two seconds."""
        step_s = self.settings.speed / self.settings.frames_per_s
        for time_s in np.arange(0.0, self.record.duration_s, step_s).tolist():
            yield self.frame(time_s)
        for _ in range(2 * self.settings.frames_per_s):
            yield self.frame(self.record.duration_s)

    def frame(self, time_s: float) -> Image.Image:
        """The mission at one moment."""
        picture = self.ground.copy()
        draw = ImageDraw.Draw(picture)
        self._blockades(draw, time_s)
        plan = next((p for p in reversed(self.record.plans) if p.time_s <= time_s), None)
        for index, robot in enumerate(self.record.robots):
            colour = ROBOTS[index % len(ROBOTS)]
            if plan is not None:
                self._planned(draw, plan, robot, time_s, colour)
            self._trail(draw, robot, time_s, colour)
        left = self._targets(draw, time_s)
        for index, robot in enumerate(self.record.robots):
            self._robot(draw, robot, time_s, ROBOTS[index % len(ROBOTS)])
        text = f"{self.record.scenario}, {self.record.strategy}   {clock(time_s)}   "
        draw.text(
            (8, HEAD_PX / 2),
            text + f"{left} of {len(self.record.targets)} targets left",
            fill=INK,
            font=ImageFont.load_default(14),
            anchor="lm",
        )
        return picture

    def _blockades(self, draw: ImageDraw.ImageDraw, time_s: float) -> None:
        for blockade in self.record.blockades:
            if blockade.cleared_at_s is not None and blockade.cleared_at_s <= time_s:
                colour, wide = CLEARED, 1
            elif blockade.seen_at_s is not None and blockade.seen_at_s <= time_s:
                colour, wide = BLOCKADE, 4
            else:
                colour, wide = UNSEEN, 3
            draw.line([self.at(end) for end in blockade.segment_m], fill=colour, width=wide)

    def _targets(self, draw: ImageDraw.ImageDraw, time_s: float) -> int:
        """Draws the targets and returns how many are left."""
        colours = {r.id: ROBOTS[k % len(ROBOTS)] for k, r in enumerate(self.record.robots)}
        left = 0
        for target in self.record.targets:
            visited = target.visited_at_s is not None and target.visited_at_s <= time_s
            left += not visited
            outline = colours.get(target.visited_by or "", INK) if visited else INK
            wide = 3 if visited else 1
            _disc(draw, self.at(target.position_m), 4.5, fill=FLOOR, outline=outline, wide=wide)
        return left

    def _trail(
        self, draw: ImageDraw.ImageDraw, robot: RobotRecord, time_s: float, colour: Colour
    ) -> None:
        times = [sample[0] for sample in robot.trail]
        first, last = bisect_right(times, time_s - TRAIL_S), bisect_right(times, time_s)
        points = [self.at((x, y)) for _, x, y in robot.trail[first:last]]
        if len(points) > 1:
            draw.line(points, fill=_faded(colour, 0.5), width=2, joint="curve")

    def _planned(
        self,
        draw: ImageDraw.ImageDraw,
        plan: PlanRecord,
        robot: RobotRecord,
        time_s: float,
        colour: Colour,
    ) -> None:
        steps = [
            step
            for step in plan.steps
            if step.arguments[:1] == (robot.id,) and step.start_s + step.duration_s > time_s
        ]
        stops = [
            self.places[step.arguments[-1]]
            for step in sorted(steps, key=lambda step: step.start_s)
            if step.arguments[-1] in self.places
        ]
        if stops:
            points = [self.at(point) for point in (position(robot, time_s), *stops)]
            draw.line(points, fill=_faded(colour, 0.75), width=1)

    def _robot(
        self, draw: ImageDraw.ImageDraw, robot: RobotRecord, time_s: float, colour: Colour
    ) -> None:
        doing = next((a.kind for a in robot.activities if a.start_s <= time_s < a.end_s), "")
        fill = WALL if doing == "failed" else colour
        _disc(draw, self.at(position(robot, time_s)), 6.0, fill=fill, outline=FLOOR, wide=1)
        if doing == "clear":
            _disc(draw, self.at(position(robot, time_s)), 9.0, fill=None, outline=BLOCKADE, wide=2)


def position(robot: RobotRecord, time_s: float) -> Point:
    """Where a robot was, between two samples of its trail [m]."""
    times = [sample[0] for sample in robot.trail]
    x = np.interp(time_s, times, [sample[1] for sample in robot.trail])
    y = np.interp(time_s, times, [sample[2] for sample in robot.trail])
    return float(x), float(y)


def _faded(colour: Colour, share: float) -> Colour:
    red, green, blue = (round(part + share * (255 - part)) for part in colour)
    return red, green, blue


def palette() -> list[Colour]:
    """Every colour that is drawn, and lighter ones for the edges that are smoothed."""
    drawn = (*ROBOTS, WALL, INK, SOFT, BLOCKADE, CLEARED, UNSEEN, OUTSIDE)
    return [FLOOR, *(_faded(colour, share / 4) for colour in drawn for share in range(4))]


def _disc(
    draw: ImageDraw.ImageDraw,
    centre: tuple[float, float],
    radius_px: float,
    *,
    fill: Colour | None,
    outline: Colour,
    wide: int,
) -> None:
    x, y = centre
    box = (x - radius_px, y - radius_px, x + radius_px, y + radius_px)
    draw.ellipse(box, fill=fill, outline=outline, width=wide)


def _write_gif(path: Path, stage: _Stage) -> None:
    colours = Image.new("P", (1, 1))
    colours.putpalette([part for colour in palette() for part in colour])
    frames = (frame.quantize(palette=colours, dither=Image.Dither.NONE) for frame in stage.frames())
    first = next(frames)
    pause_ms = round(1000 / stage.settings.frames_per_s)
    first.save(path, save_all=True, append_images=frames, duration=pause_ms, loop=0, optimize=False)


def _write_mp4(path: Path, stage: _Stage) -> None:
    width, height = stage.ground.size
    words = ["ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"]
    words += ["-s", f"{width}x{height}", "-r", str(stage.settings.frames_per_s), "-i", "-"]
    words += ["-pix_fmt", "yuv420p", "-movflags", "+faststart", str(path)]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as encoder:
        if encoder.stdin is None or encoder.stderr is None:
            raise RuntimeError("ffmpeg was started without pipes")
        try:
            for frame in stage.frames():
                encoder.stdin.write(frame.tobytes())
            encoder.stdin.close()
        except BrokenPipeError:
            pass  # it has ended early and says why
        said = encoder.stderr.read().decode(errors="replace").strip()
    if encoder.returncode != 0:
        raise MovieError(f"{path}: ffmpeg failed: {said[-300:]}")
