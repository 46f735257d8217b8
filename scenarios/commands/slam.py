"""`marsupial slam`: pose graphs, maps from laser logs, maps of several robots in one frame."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from scenarios.exit_codes import INPUT_ERROR, CommandError

if TYPE_CHECKING:
    from simulator.slam.robot_map import RobotMap

app = typer.Typer(no_args_is_help=True, help="Maps by SLAM, with one robot or with several.")

GraphArgument = Annotated[
    Path, typer.Argument(help="g2o, TORO or iSAM file of a planar pose graph.", show_default=False)
]
RangeOption = Annotated[
    float, typer.Option(min=1.0, help="Laser readings that long or longer met nothing [m].")
]


@app.command()
def optimise(
    graph: GraphArgument,
    *,
    out: Annotated[Path | None, typer.Option(help="Write the optimum as g2o.")] = None,
    kernel: Annotated[
        Literal["none", "huber", "cauchy", "geman-mcclure", "dcs", "tukey"],
        typer.Option(help="Robust kernel on everything but odometry."),
    ] = "none",
    reject: Annotated[
        bool, typer.Option("--reject", help="Find wrong loop closures and leave them out.")
    ] = False,
) -> None:
    """Find the most likely poses of a pose graph.

    Lines of the file: VERTEX_SE2 key x y heading; EDGE_SE2 start end x y heading and the upper
    triangle of the information matrix; VERTEX_XY and EDGE_SE2_XY for landmarks; also EDGE2,
    ODOMETRY and LANDMARK of older formats.
    """
    _needs_gtsam()
    from simulator.slam import back_end
    from simulator.slam.g2o import read_g2o, write_g2o

    parameters = back_end.BackEndParameters(kernel=kernel)
    try:
        read = read_g2o(graph)
        if reject:
            found = back_end.optimise_with_outliers(read, parameters, ("loop", "inter"))
        else:
            found = back_end.optimise(read, parameters)
    except ValueError as error:
        raise CommandError(str(error), INPUT_ERROR) from None
    typer.echo(
        f"{len(read.poses)} poses, {len(read.edges)} edges, {len(read.landmarks)} landmarks: "
        f"chi2 {found.chi2_before:.6g} -> {found.chi2_after:.6g}"
    )
    if reject:
        typer.echo(f"{int((found.weights < 0.5).sum())} edges left out")
    if out is not None:
        _folder_of(out)
        write_g2o(found.graph, out)


@app.command(name="map")
def map_log(
    log: Annotated[Path, typer.Argument(help="CARMEN log, may be .gz or .bz2.")],
    *,
    out: Annotated[Path, typer.Option(help="Folder for map, graph and corrected log.")] = Path(
        "out/slam"
    ),
    range_m: RangeOption = 20.0,
    resolution_m: Annotated[float, typer.Option(min=0.01, help="Edge of a map cell [m].")] = 0.1,
) -> None:
    """Map one robot's log: scan matching, loop closures, map from the corrected poses."""
    robot_map = _mapped(log, range_m)
    _write([robot_map], out, resolution_m)
    loops = sum(edge.kind == "loop" for edge in robot_map.graph.edges)
    typer.echo(f"{len(robot_map.scans)} nodes, {loops} loops closed; written to {out}")


@app.command()
def merge(
    logs: Annotated[list[Path], typer.Argument(help="CARMEN logs, one a robot.")],
    *,
    out: Annotated[Path, typer.Option(help="Folder for the joint map and the graphs.")] = Path(
        "out/slam"
    ),
    range_m: RangeOption = 20.0,
    resolution_m: Annotated[float, typer.Option(min=0.01, help="Edge of a map cell [m].")] = 0.1,
    method: Annotated[
        Literal["pcm", "ransac"], typer.Option(help="How wrong constraints are found.")
    ] = "pcm",
    seed: Annotated[int, typer.Option(help="Draws particles and samples.")] = 0,
) -> None:
    """Map several robots' logs and bring them into one frame; where they began is not asked."""
    if len(logs) < 2:
        raise CommandError("merging needs two logs or more", INPUT_ERROR)
    import numpy as np

    robot_maps = [_mapped(log, range_m) for log in logs]
    from simulator.slam.grid_front_end import GridFrontEndParameters, merge_grid_maps

    parameters = GridFrontEndParameters(method=method)
    try:
        merged, _ = merge_grid_maps(robot_maps, np.random.default_rng(seed), parameters)
    except ValueError as error:
        raise CommandError(str(error), INPUT_ERROR) from None
    _write(list(merged.robot_maps.values()), out, resolution_m)
    for name, frame in merged.frames.items():
        own = sum(name in (edge.robot_a, edge.robot_b) for edge in merged.edges)
        typer.echo(f"{name}: {own} constraints, frame {frame[0]:.2f} {frame[1]:.2f} {frame[2]:.3f}")
    for name in merged.alone:
        typer.echo(f"{name}: no place in common with the others was found; left out")
    typer.echo(f"written to {out}")


@app.command()
def experiments(
    *,
    quick: Annotated[bool, typer.Option("--quick", help="A few runs of each.")] = False,
    data: Annotated[
        Path | None, typer.Option(help="Folder with public data; left out if absent.")
    ] = Path("../shared/data"),
    only: Annotated[
        list[str] | None, typer.Option(help="Names of experiments; all by default.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for tables and figures.")] = Path(
        "out/slam-experiments"
    ),
) -> None:
    """Run the experiments of thesis chapter 4 and write tables and figures."""
    _needs_gtsam()
    from scenarios.benchmarks.slam.experiments import EXPERIMENTS, run_experiments

    unknown = sorted(set(only or ()) - set(EXPERIMENTS))
    if unknown:
        raise CommandError(
            f"no experiment {unknown[0]!r}: choose of {', '.join(EXPERIMENTS)}", INPUT_ERROR
        )
    typer.echo(run_experiments(out, quick=quick, data=data, only=only))


def _mapped(log: Path, range_m: float) -> RobotMap:
    _needs_gtsam()
    from simulator.slam.carmen import read_carmen
    from simulator.slam.front_end import build_map

    try:
        scans = read_carmen(log, range_m)
    except ValueError as error:
        raise CommandError(str(error), INPUT_ERROR) from None
    return build_map(log.name.partition(".")[0], scans)


def _write(robot_maps: list[RobotMap], out: Path, resolution_m: float) -> None:
    """Map as map_server files, a graph and a corrected log for each robot."""
    from simulator.slam.carmen import write_carmen
    from simulator.slam.g2o import write_g2o
    from simulator.slam.map_files import write_map_server
    from simulator.slam.robot_map import map_with_known_poses

    out.mkdir(parents=True, exist_ok=True)
    write_map_server(map_with_known_poses(robot_maps, resolution_m, 15.0), out / "map.yaml")
    for robot_map in robot_maps:
        write_g2o(robot_map.graph, out / f"{robot_map.robot}.g2o")
        keys = sorted(robot_map.scans)
        scans = [robot_map.scans[key] for key in keys]
        poses = robot_map.graph.trajectory()
        write_carmen(scans, out / f"{robot_map.robot}-corrected.log.gz", poses)


def _folder_of(path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)


def _needs_gtsam() -> None:
    if find_spec("gtsam") is None:
        raise CommandError("SLAM needs gtsam: install marsupial[slam]", INPUT_ERROR)
