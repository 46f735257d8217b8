"""`marsupial map`: 3D occupancy maps from scans, in OctoMap's formats."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scenarios.exit_codes import CommandError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from simulator.mapping.octree import OctreeMap

app = typer.Typer(no_args_is_help=True, help="Build, look at and convert 3D occupancy maps.")

MapArgument = Annotated[Path, typer.Argument(help="Map, .bt or .ot.", show_default=False)]
Band = Annotated[
    tuple[float, float] | None,
    typer.Option("--slice", help="Draw the columns of a height band, LOW HIGH [m]."),
]


@app.command()
def insert(
    scans: Annotated[
        list[Path],
        typer.Argument(
            help="Scans: .pcd, .ply, .xyz, .txt, .dat (also .bz2, .gz), or scan logs .graph, .log.",
            show_default=False,
        ),
    ],
    *,
    out: Annotated[Path, typer.Option(help="The map to write, .bt or .ot.", show_default=False)],
    into: Annotated[
        Path | None, typer.Option(help="Add to this map; its resolution is kept.")
    ] = None,
    resolution: Annotated[float, typer.Option(min=1e-4, help="Edge of a voxel [m].")] = 0.1,
    max_range: Annotated[
        float | None, typer.Option(min=0.0, help="Longer beams only free space up to there [m].")
    ] = None,
    origin: Annotated[
        tuple[float, float, float],
        typer.Option(help="Position of the sensor of point clouds, X Y Z [m]."),
    ] = (0.0, 0.0, 0.0),
    threads: Annotated[int, typer.Option(min=1, help="Threads that share a scan's beams.")] = 1,
    memory_limit: Annotated[
        int, typer.Option(min=1, help="Refuse to grow beyond this [MB].")
    ] = 4000,
) -> None:
    """Insert scans into a map.

    Point clouds are in the map frame with the sensor at --origin; scan logs bring their poses.
    """
    from simulator.mapping.octree import OctreeMap

    limit_bytes = memory_limit * 10**6
    with _told():
        octree = (
            OctreeMap(resolution, memory_limit_bytes=limit_bytes)
            if into is None
            else OctreeMap.read(into, memory_limit_bytes=limit_bytes)
        )
        beams, spent_s = 0, 0.0
        for path in scans:
            for sensor_m, points_m in _scans(path, origin):
                begin_s = time.perf_counter()
                octree.insert_scan(sensor_m, points_m, max_range, threads=threads)
                spent_s += time.perf_counter() - begin_s
                beams += len(points_m)
        _write(octree, out)
    typer.echo(f"{beams:,} beams in {spent_s:.2f} s -> {out}")
    _describe(octree, out)


@app.command()
def info(map_file: MapArgument) -> None:
    """Say what a map holds: voxels, extent, memory, sizes."""
    with _told():
        _describe(_read(map_file), map_file)


@app.command()
def render(
    map_file: MapArgument,
    *,
    out: Annotated[Path, typer.Option(help="The picture to write, .png.")] = Path("map.png"),
    band: Band = None,
    below: Annotated[
        float | None, typer.Option(help="Leave out what is higher, such as ceilings [m].")
    ] = None,
    above: Annotated[float | None, typer.Option(help="Leave out what is lower [m].")] = None,
    azimuth: Annotated[float, typer.Option(help="Of the viewer [degrees].")] = -120.0,
    elevation: Annotated[
        float, typer.Option(min=1.0, max=89.0, help="Of the viewer [degrees].")
    ] = 40.0,
    width: Annotated[int, typer.Option(min=16, max=8000, help="Of the picture [pixels].")] = 1200,
) -> None:
    """Draw a map into a PNG: an isometric view, or a slice from above."""
    from math import radians

    from simulator.mapping.pictures import View, isometric_picture, occupied_bounds, slice_picture

    with _told():
        octree = _read(map_file)
        if band is not None:
            picture = slice_picture(octree, *band)
        else:
            view = View(radians(azimuth), radians(elevation), width)
            bounds = occupied_bounds(octree)
            if bounds is None:
                raise CommandError(f"{map_file}: no voxel is occupied, there is nothing to draw")
            low, high = bounds
            low[2] = low[2] if above is None else max(low[2], above)
            high[2] = high[2] if below is None else min(high[2], below)
            if low[2] >= high[2]:
                raise CommandError(
                    f"nothing lies between {low[2]:.2f} and {high[2]:.2f} m: "
                    "give other values for --above and --below"
                )
            picture = isometric_picture(octree, view, (low, high))
        out.parent.mkdir(parents=True, exist_ok=True)
        picture.save(out)
    typer.echo(f"{out}: {picture.width} x {picture.height} pixels")


@app.command()
def convert(
    map_file: MapArgument,
    out: Annotated[
        Path,
        typer.Argument(
            help=".bt, .ot, .rrd (rerun), .xyz (occupied voxels), or .yaml (map_server).",
            show_default=False,
        ),
    ],
    *,
    robot_height: Annotated[
        float, typer.Option(min=0.0, help="For .yaml: what hangs higher is no obstacle [m].")
    ] = 1.5,
    step: Annotated[
        float, typer.Option(min=0.0, help="For .yaml: what is lower is driven over [m].")
    ] = 0.1,
    floor: Annotated[float, typer.Option(help="For .yaml: height of the floor [m].")] = 0.0,
) -> None:
    """Convert a map, by the ending of the file to write.

    A .yaml is the plane in which a robot of some height moves: a map for the planner.
    """
    with _told():
        octree = _read(map_file)
        out.parent.mkdir(parents=True, exist_ok=True)
        if out.suffix == ".rrd":
            from simulator.mapping.recording import write_recording

            write_recording(octree, out)
        elif out.suffix == ".xyz":
            import numpy as np

            np.savetxt(out, octree.occupied_voxels(), fmt="%.4f")
        elif out.suffix == ".yaml":
            from scenarios.maps.files import write_map
            from simulator.mapping.traversability import Passage, traversability

            grid = traversability(octree, Passage(robot_height, step, floor))
            write_map(out.parent, out.stem, grid.cells, grid.resolution_m, grid.origin_m)
        else:
            _write(octree, out)
    typer.echo(f"{map_file} -> {out}")


@contextmanager
def _told() -> Iterator[None]:
    """Faults of files and maps as a sentence, not a traceback."""
    try:
        yield
    except ModuleNotFoundError as missing:
        raise CommandError(
            f"this needs the library {missing.name}: pip install 'marsupial[mapping]'"
        ) from None
    except (ValueError, MemoryError, ImportError) as fault:
        raise CommandError(str(fault)) from None


def _read(path: Path) -> OctreeMap:
    from simulator.mapping.octree import OctreeMap

    return OctreeMap.read(path)


def _write(octree: OctreeMap, path: Path) -> None:
    contents = octree.to_bytes(path.suffix)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(contents)


def _scans(
    path: Path, origin_m: tuple[float, float, float]
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float32]]]:
    """Sensor position and end points, both in the map frame, of each scan of a file."""
    import numpy as np

    from simulator.mapping.point_cloud import read_points, read_scan_log

    if path.suffix in (".graph", ".log"):
        for scan in read_scan_log(path):
            yield scan.origin_m, scan.in_map_frame()
    else:
        yield np.array(origin_m), read_points(path)


def _describe(octree: OctreeMap, path: Path) -> None:
    _, log_odds = octree.known_voxels()
    occupied = int((log_odds >= 0).sum())
    bricks, dense = octree.brick_counts()
    lines = {
        "voxels": f"{len(log_odds):,} known of {octree.resolution_m:g} m: "
        f"{occupied:,} occupied, {len(log_odds) - occupied:,} free",
        "memory": f"{octree.memory_bytes() / 1e6:.2f} MB in {bricks:,} bricks, "
        f"{bricks - dense:,} of them collapsed",
        "octree": f"{octree.node_count():,} nodes; without pruning "
        f"{sum(octree.unpruned_counts()):,}",
        "file": f"{path.stat().st_size / 1e6:.2f} MB",
    }
    if occupied:
        from simulator.mapping.pictures import occupied_bounds

        bounds = occupied_bounds(octree)
        if bounds is not None:
            low, high = bounds
            spans = zip("xyz", low, high, strict=True)
            lines["occupied"] = ", ".join(f"{a} {b:.2f} to {c:.2f} m" for a, b, c in spans)
    for name, text in lines.items():
        typer.echo(f"{name:<10} {text}")


@app.command()
def experiments(
    names: Annotated[
        list[str] | None, typer.Argument(help="Which ones; all if not given.", show_default=False)
    ] = None,
    *,
    quick: Annotated[bool, typer.Option("--quick", help="A small subset, in a minute.")] = False,
    out: Annotated[Path, typer.Option(help="Folder for tables and figures.")] = Path(
        "out/bench/mapping"
    ),
) -> None:
    """Repeat the mapping experiments: each writes NAME.md and its figures."""
    from scenarios.benchmarks.mapping.experiments import EXPERIMENTS

    for name in names or EXPERIMENTS:
        if name not in EXPERIMENTS:
            raise CommandError(f"no experiment {name!r}: choose from {', '.join(EXPERIMENTS)}")
    out.mkdir(parents=True, exist_ok=True)
    for name in names or EXPERIMENTS:
        title, measure = EXPERIMENTS[name]
        begin_s = time.process_time()
        text = f"# {title}\n\n{measure(quick, out)}\n"
        command = f"marsupial map experiments {name}{' --quick' if quick else ''}"
        spent_s = time.process_time() - begin_s
        text += f"\nRepeat with `{command}` ({spent_s:.0f} CPU s).\n"
        (out / f"{name}.md").write_text(text, encoding="utf-8")
        typer.echo(text)
