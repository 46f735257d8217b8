"""`marsupial vegetation`: classifiers of laser remission, surveys of parks, experiments."""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scenarios.exit_codes import CommandError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from simulator.vegetation.classifier import RemissionModel
    from simulator.vegetation.sensor_setup import SensorSetup

app = typer.Typer(no_args_is_help=True, help="Detect flat vegetation from laser remission.")

ModelArgument = Annotated[Path, typer.Argument(help="Model file, .npz.", show_default=False)]
ScannerOption = Annotated[str, typer.Option(help="Model of the laser scanner.")]
HeightOption = Annotated[float, typer.Option(min=0.01, help="Its height above the ground [m].")]
TiltOption = Annotated[
    tuple[float, float],
    typer.Option(help="Lowest and highest tilt below the horizontal [degrees]."),
]


@app.command()
def train(
    model: ModelArgument,
    *,
    samples: Annotated[
        Path | None,
        typer.Option(
            help="CSV with range_m, incidence_rad, remission, vegetation (0 or 1) and, if known, "
            "group (scan or run); without it the scanner is simulated."
        ),
    ] = None,
    scanner: ScannerOption = "LMS 291-S05",
    height: HeightOption = 0.6,
    tilt: TiltOption = (20.0, 20.0),
    classifier: Annotated[str, typer.Option(help="svm or lda.")] = "svm",
    quick: Annotated[bool, typer.Option("--quick", help="Search fewer SVM parameters.")] = False,
) -> None:
    """Train a classifier for one scanner and mounting, and write it to a file."""
    import numpy as np

    from simulator.vegetation.classifier import RemissionModel
    from simulator.vegetation.experiments.training import QUICK, SOME
    from simulator.vegetation.lda import train_lda
    from simulator.vegetation.model_file import write_model
    from simulator.vegetation.scores import Scores
    from simulator.vegetation.svm import train_svm

    if classifier not in {"svm", "lda"}:
        raise CommandError(f"--classifier {classifier}: choose svm or lda")
    setup = _setup(scanner, height, tilt)
    features, vegetation, groups = (
        _simulated(setup, quick=quick) if samples is None else _labelled(samples)
    )
    try:
        if classifier == "lda":
            trained: RemissionModel = RemissionModel(train_lda(features, vegetation), setup)
        else:
            parameters = QUICK if quick else SOME
            trained = RemissionModel(train_svm(features, vegetation, groups, parameters), setup)
    except ImportError:
        raise CommandError(
            "training needs scikit-learn: pip install 'marsupial[vegetation]'"
        ) from None
    except ValueError as refusal:
        raise CommandError(f"{samples or scanner}: {refusal}") from None
    write_model(model, trained)
    found = trained.classifier.vegetation_probability(features) >= 0.5
    scores = Scores.of(found, np.asarray(vegetation))
    typer.echo(
        f"{model}: {classifier}, {len(features):,} samples, on which precision is "
        f"{100 * scores.precision:.2f} % and recall {100 * scores.recall:.2f} %"
    )


@app.command()
def classify(
    model: ModelArgument,
    points: Annotated[
        Path,
        typer.Argument(
            help="CSV with x_m, y_m, z_m, remission: a 3D scan in the scanner's frame.",
            show_default=False,
        ),
    ],
    *,
    out: Annotated[Path, typer.Option(help="CSV to write.", show_default=False)],
    scanner: ScannerOption = "LMS 291-S05",
    height: HeightOption = 0.6,
    tilt: TiltOption = (20.0, 20.0),
) -> None:
    """Classify a scan: range, incidence angle and P(vegetation) of each point."""
    import numpy as np

    from simulator.vegetation.classifier import WrongSetupError
    from simulator.vegetation.features import measure
    from simulator.vegetation.model_file import ModelFileError, read_model

    setup = _setup(scanner, height, tilt)
    try:
        trained = read_model(model, setup)
    except (ModelFileError, WrongSetupError) as refusal:
        raise CommandError(str(refusal)) from None
    cloud = _table(points, ("x_m", "y_m", "z_m", "remission"))
    measured = measure(cloud[:, :3], cloud[:, 3], np.zeros(3))
    probability = trained.vegetation_probability(measured, setup)
    out.parent.mkdir(parents=True, exist_ok=True)
    with out.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(
            ["x_m", "y_m", "z_m", "remission", "range_m", "incidence_rad", "vegetation"]
        )
        for row in np.column_stack(
            [cloud, measured.range_m, measured.incidence_rad, probability]
        ).tolist():
            writer.writerow(["" if math.isnan(value) else f"{value:.6g}" for value in row])
    near = ~np.isnan(probability)
    typer.echo(
        f"{out}: {len(cloud):,} points, {int(near.sum()):,} within {trained.max_range_m} m, "
        f"{int((probability[near] >= 0.5).sum()):,} of them vegetation"
    )


@app.command()
def survey(
    *,
    seed: Annotated[int, typer.Option(help="Draws the park.")] = 3,
    out: Annotated[Path, typer.Option(help="Folder for the map.")] = Path("out/park"),
) -> None:
    """Survey a simulated park with a laser and write its map with terrain classes and targets."""
    from scenarios.maps.park import survey as survey_park
    from scenarios.maps.park import write_survey

    typer.echo(str(write_survey(survey_park(seed), out, "park")))


@app.command()
def experiments(
    names: Annotated[
        list[str] | None, typer.Argument(help="Which; all if not given.", show_default=False)
    ] = None,
    *,
    quick: Annotated[bool, typer.Option("--quick", help="Small versions, in seconds.")] = False,
    out: Annotated[Path, typer.Option(help="Folder for report and figures.")] = Path(
        "out/vegetation"
    ),
    data: Annotated[Path, typer.Option(help="Folder of public data sets.")] = Path(
        "../shared/data"
    ),
) -> None:
    """Run experiments of the thesis's section 6.9 and write a report with figures."""
    from simulator.vegetation.experiments import EXPERIMENTS, Setting
    from simulator.vegetation.experiments import run as run_experiment

    unknown = [name for name in names or [] if name not in EXPERIMENTS]
    if unknown:
        raise CommandError(f"no experiment {unknown[0]!r}: choose of {', '.join(EXPERIMENTS)}")
    setting = Setting(out, quick, data)
    for name in names or EXPERIMENTS:
        try:
            report = run_experiment(name, setting)
        except ImportError as missing:
            raise CommandError(
                f"{name} needs {missing.name}: pip install 'marsupial[vegetation,results]'"
            ) from None
        (out / f"{name}.md").write_text(report, encoding="utf-8")
        typer.echo(report)


def _setup(scanner: str, height_m: float, tilt_degrees: tuple[float, float]) -> SensorSetup:
    from simulator.vegetation.sensor_setup import SensorSetup

    low, high = (math.radians(tilt) for tilt in tilt_degrees)
    if low > high:
        raise CommandError("--tilt: give the lowest tilt first")
    return SensorSetup(scanner, height_m, (low, high))


Samples = tuple["NDArray[np.float64]", "NDArray[np.bool_]", "NDArray[np.int_] | None"]


def _simulated(setup: SensorSetup, *, quick: bool) -> Samples:
    import numpy as np

    from simulator.vegetation.simulation.recording import standing_recording
    from simulator.vegetation.simulation.remission_model import SCANNERS

    if setup.scanner not in SCANNERS:
        raise CommandError(
            f"--scanner {setup.scanner}: only {', '.join(SCANNERS)} can be simulated; "
            "give labelled measurements with --samples"
        )
    measured, vegetation, groups = standing_recording(setup, (71, 72, 73, 74), 20 if quick else 80)
    if not len(measured):
        raise CommandError("--tilt, --height: the scanner sees no ground within 5 m; tilt it more")
    some = np.random.default_rng(71).choice(len(measured), min(8000, len(measured)), replace=False)
    return measured.features()[some], vegetation[some], groups[some]


def _labelled(path: Path) -> Samples:
    import numpy as np

    columns = ("range_m", "incidence_rad", "remission", "vegetation")
    with path.open(encoding="utf-8", newline="") as file:
        grouped = "group" in (next(csv.reader(file), []))
    table = _table(path, (*columns, "group") if grouped else columns)
    if not np.isin(table[:, 3], (0, 1)).all():
        raise CommandError(f"{path}: the column vegetation must hold 0 or 1")
    groups = table[:, 4].astype(np.int_) if grouped else None
    return table[:, :3], table[:, 3] == 1, groups


def _table(path: Path, columns: tuple[str, ...]) -> NDArray[np.float64]:
    """These columns of a CSV file `(n, columns)`."""
    import numpy as np

    with path.open(encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        missing = [name for name in columns if name not in (reader.fieldnames or [])]
        if missing:
            raise CommandError(
                f"{path}: the column {missing[0]} is missing; "
                f"the first line must name {', '.join(columns)}"
            )
        try:
            rows = [[float(row[name]) for name in columns] for row in reader]
        except (TypeError, ValueError):
            raise CommandError(
                f"{path}, line {reader.line_num}: is no row of {len(columns)} numbers; mend it"
            ) from None
    if not rows or not np.isfinite(rows).all():
        raise CommandError(f"{path}: holds {'a value that is not finite' if rows else 'no rows'}")
    return np.array(rows)
