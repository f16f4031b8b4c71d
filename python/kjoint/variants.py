"""Many variants of a deck at once: parameters in, a table of measures out.

    kjoint sweep DECK_0000.rad --vary length=0.1:0.2:5 --measure 'joint/force[pin].norm:max'

The parameters are those of /PARAMETER in the deck. sweep() does the same from Python. Variants are
done in blocks, which threads, ranks and machines claim by locks of files (class Store), so what is
done stays done, whoever dies.
"""
from __future__ import annotations

import contextlib
import csv
import datetime
import fcntl
import hashlib
import itertools
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import sys
import tempfile
import threading
import time
import uuid
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from typing import IO, TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ._error import Error, Parser
from ._library import iso18571, version
from .model import Model, run_beside
from .samples import Path

if TYPE_CHECKING:
    import xarray

    from .model import RunStatus

Array = npt.NDArray[np.float64]
Row = list[Any]                                   # measures, cycles, what went wrong
Columns = dict[str, tuple[npt.NDArray[Any], dict[str, str]]]
Told = Callable[[int, int], None]

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
FUNCTIONS = "max, min, mean, rms, range, final, tmax, tmin, at(t), rmse(REF.h5), iso18571(REF.h5)"
SIMPLE = ("max", "min", "mean", "rms", "range", "final", "tmax", "tmin")
COMPARED = ("rmse", "iso18571")
BLOCKS_EACH = 4


class Grid:
    """Values of a parameter, one after the other."""

    def __init__(self, values: npt.ArrayLike) -> None:
        self.values = np.atleast_1d(np.asarray(values, dtype=float))


class Spread:
    """A parameter that is drawn: from the share of a distribution to its value."""

    def __init__(self, kind: str, a: float, b: float) -> None:
        self.kind, self.a, self.b = kind, a, b
        if kind == "uniform" and not a < b:
            raise ValueError(f"uniform({a:g},{b:g}): the first is not below the second")
        if kind == "normal" and not b > 0:
            raise ValueError(f"normal({a:g},{b:g}): the deviation is not above 0")

    def at(self, share: Array) -> Array:
        """Values at shares between 0 and 1."""
        if self.kind == "uniform":
            return self.a + (self.b - self.a)*share
        from statistics import NormalDist
        normal = NormalDist(self.a, self.b)
        return np.array([normal.inv_cdf(min(max(s, 1e-12), 1 - 1e-12)) for s in share])


def parse_vary(text: str) -> Grid | Spread:
    """a:b:n, a:b:n:log, v1,v2,..., normal(mean,sd) or uniform(a,b).

    >>> parse_vary("1:3:3").values
    array([1., 2., 3.])
    >>> parse_vary("1:100:3:log").values
    array([  1.,  10., 100.])
    """
    drawn = re.fullmatch(rf"(normal|uniform)\(({NUMBER}),({NUMBER})\)", text.replace(" ", ""))
    if drawn:
        return Spread(drawn[1], float(drawn[2]), float(drawn[3]))
    grid = re.fullmatch(rf"({NUMBER}):({NUMBER}):(\d+)(:log)?", text)
    if grid:
        a, b, n = float(grid[1]), float(grid[2]), int(grid[3])
        if n < 1 or (grid[4] and min(a, b) <= 0):
            raise ValueError(f"{text}: at least one value, and logarithms of positive ones")
        return Grid(np.geomspace(a, b, n) if grid[4] else np.linspace(a, b, n))
    try:
        return Grid([float(word) for word in text.split(",")])
    except ValueError:
        raise ValueError(f"{text!r} is none of a:b:n, a:b:n:log, v1,v2, normal(m,s), "
                         "uniform(a,b)") from None


def plan(vary: Mapping[str, Any], sample: int | None = None, method: str = "random",
         seed: int = 0) -> tuple[list[str], Array]:
    """Names and values (variants, names): all combinations of grids, or so many draws."""
    names = list(vary)
    made = [value if isinstance(value, (Grid, Spread)) else parse_vary(value)
            if isinstance(value, str) else Grid(value) for value in vary.values()]
    if not sample:
        for name, value in zip(names, made):
            if isinstance(value, Spread):
                raise ValueError(f"{name} is drawn: how many variants (--sample N)?")
        rows = list(itertools.product(*(value.values for value in made if isinstance(value, Grid))))
        return names, np.array(rows, dtype=float).reshape(len(rows), len(names))
    if method == "random":
        shares = np.random.default_rng(seed).random((sample, len(names)))
    else:
        from scipy.stats import qmc
        if method == "lhs":
            shares = qmc.LatinHypercube(d=len(names), seed=seed).random(sample)
        else:
            shares = qmc.Sobol(d=len(names), seed=seed).random(sample)
    columns = [value.at(share) if isinstance(value, Spread)
               else value.values[np.minimum((share*len(value.values)).astype(int), len(value.values) - 1)]
               for value, share in zip(made, shares.T)]
    return names, np.column_stack(columns) if columns else np.empty((sample, 0))


class Measure:
    """CHANNEL:FUNCTION, such as joint/force[pin].norm:max."""

    def __init__(self, text: str) -> None:
        self.text = text
        channel, colon, function = text.rpartition(":")
        match = re.fullmatch(r"(\w+)(?:\((.*)\))?", function)
        if not colon or not match or match[1] not in SIMPLE + COMPARED + ("at",):
            raise ValueError(f"{text!r} is no CHANNEL:FUNCTION; functions: {FUNCTIONS}")
        self.channel, self.function = channel, match[1]
        if (self.function in SIMPLE) != (match[2] is None):
            raise ValueError(f"{text!r}: at(t), rmse(REF.h5) and iso18571(REF.h5) have an argument, no other has")
        if self.function == "at":
            self.time = float(match[2])
        if self.function in COMPARED:
            self.reference = read_reference(match[2], channel)

    def of(self, time: Array, y: Array) -> float:
        """The measure of a curve."""
        simple: dict[str, Callable[[Array], Any]] = {"max": np.max, "min": np.min, "mean": np.mean, "range": np.ptp,
                  "rms": lambda v: np.sqrt(np.mean(v*v)), "final": lambda v: v[-1],
                  "tmax": lambda v: time[np.argmax(v)], "tmin": lambda v: time[np.argmin(v)]}
        if self.function in simple:
            return float(simple[self.function](y))
        if self.function == "at":
            if not time[0] <= self.time <= time[-1]:
                return float("nan")
            return float(np.interp(self.time, time, y))
        found, wanted = self.beside(time, y)
        if self.function == "iso18571":
            return iso18571(wanted, found)
        return float(np.sqrt(np.mean((found - wanted)**2)))

    def beside(self, time: Array, y: Array) -> tuple[Array, Array]:
        """A curve at the times of the reference, and the reference, as far as both go."""
        at, wanted = self.reference
        inside = (at >= time[0]) & (at <= time[-1])
        return np.interp(at[inside], time, y), wanted[inside]

    def unit(self, model: Model) -> str:
        """Unit of the measure, as histories name it; 1 for a rating."""
        if self.function == "iso18571":
            return "1"
        return model.unit("time" if self.function in ("tmax", "tmin") else re.split(r"[\[.]", self.channel)[0])


def read_reference(path: Path, channel: str) -> tuple[Array, Array]:
    """Times and values of one curve of a history or a T01."""
    from ._show import export
    try:
        table = export(path, [channel])
    except SystemExit:
        raise ValueError(f"{path} gives no curve {channel}") from None
    if len(table["series"]) != 1:
        raise ValueError(f"{channel} of {path} is {len(table['series'])} curves, not one")
    return np.asarray(table["time"]["values"], float), np.asarray(table["series"][0]["values"], float)


def text_of(value: float) -> str:
    """A number as a field of a card takes it, sign and all: 19 characters hold 13 digits or more.

    >>> text_of(3.0), text_of(0.1), text_of(-1.2345678901234567e-05)
    ('3', '0.1', '-1.234567890123e-05')
    """
    text = repr(float(value))
    text = text[:-2] if text.endswith(".0") else text
    digits = 17
    while len(text) > 19:
        digits -= 1
        text = f"{value:.{digits}g}"
    return text


def settings(names: Sequence[str], values: Iterable[float], also: Any = None) -> str | None:
    """The option `set` of a variant."""
    words = (f"{name}={text_of(value)}" for name, value in zip(names, values))
    return ",".join(filter(None, (also, *words))) or None


class Plan:
    """What a sweep is: the same on each rank, and when it is resumed."""

    def __init__(self, deck: Path, engine: Path | None, options: dict[str, Any], names: Sequence[str],
                 values: Array, measures: Sequence[Measure], keep: Collection[int] = ()) -> None:
        self.deck, self.engine, self.options = str(deck), str(engine) if engine else None, options
        self.names, self.values, self.measures, self.keep = names, values, measures, keep
        self.head = ["variant", *names, *(m.text for m in measures), "cycles", "status"]
        self.block = 1                                     # variants that a thread claims at a time, see Store
        self.beside = False                                # it runs them side by side

    def digest(self) -> str:
        """Of all that decides the rows, included files apart."""
        digest = hashlib.sha256(json.dumps([self.head, sorted(self.options.items()), self.deck, self.engine], default=str).encode())
        digest.update(np.ascontiguousarray(self.values).tobytes())
        for path in filter(None, (self.deck, self.engine)):
            digest.update(pathlib.Path(path).read_bytes())
        return digest.hexdigest()

    def units(self) -> list[str]:
        """Units of the measures. Raises Error when the deck cannot be read, has no such parameter or curve."""
        try:
            model = Model(self.deck, self.engine, **{**self.options, "set": settings(
                self.names, self.values[0] if len(self.values) else (), self.options.get("set"))})
        except Error as error:
            if "KJ-9407" in str(error):                    # no such parameter
                raise
            model = Model(self.deck, self.engine, **self.options)
        if model.options.get("integrator") in ("split2", "liemid") and len(model.joints) <= 64:
            self.beside = True
        model.start().sample()
        for m in self.measures:
            model.curve(m.channel)
        return [m.unit(model) for m in self.measures]

    def run(self, numbers: Iterable[int], stopped: threading.Event, folder: pathlib.Path | None) -> dict[int, Row]:
        """Rows of variants, numbered from 0, that run side by side: measures, cycles, what went wrong, else ''."""
        models: dict[int, Model] = {}
        rows: dict[int, Row] = {}

        def failed(error: Error) -> Row:
            return [*[float("nan")]*len(self.measures), 0, str(error).splitlines()[0]]

        def watch(status: RunStatus) -> bool:
            return stopped.is_set()

        for k in numbers:
            try:
                models[k] = Model(self.deck, self.engine, **{**self.options, "set": settings(
                    self.names, self.values[k], self.options.get("set"))})
            except Error as error:
                rows[k] = failed(error)
        for (k, model), wrong in zip(models.items(), run_beside(list(models.values()), watch)):
            try:
                rows[k] = failed(wrong) if wrong else self.row(k, model, folder)
            except Error as error:
                rows[k] = failed(error)
        return rows

    def row(self, k: int, model: Model, folder: pathlib.Path | None) -> Row:
        """Row of a variant that has run."""
        found = [m.of(model["time"], model.curve(m.channel)) for m in self.measures]
        if folder and k in self.keep:
            model.write_history(folder / f"variant_{k + 1:05d}.h5")
        return [*found, model.status.cycle, ""]


def job() -> str:
    """What the ranks of one start have in common, or a name of its own."""
    at = os.environ.get
    if at("SLURM_PROCID") and not at("PMIX_NAMESPACE"):
        return f"{at('SLURM_JOB_ID')}.{at('SLURM_STEP_ID')}"
    return at("PMIX_NAMESPACE") or uuid.uuid4().hex


def rank() -> tuple[int, int, int]:
    """Rank of this process, 0 where there is but one, how many share its machine, and how many there are."""
    at = os.environ.get
    return (int(at("OMPI_COMM_WORLD_RANK") or at("PMIX_RANK") or at("SLURM_PROCID") or 0),
            int(at("OMPI_COMM_WORLD_LOCAL_SIZE") or (at("SLURM_PROCID") and at("SLURM_NTASKS_PER_NODE")) or 1),
            int(at("OMPI_COMM_WORLD_SIZE") or (at("SLURM_PROCID") and at("SLURM_NTASKS")) or 1))


class Store:
    """The rows of a sweep in a folder, a file a block of variants.

    Who works on a block holds a lock on its file; the system takes the lock from who dies. So
    threads, ranks and machines with a common folder share a sweep, nothing is lost but the row
    under way, and a sweep that was killed goes on from its files.
    """

    def __init__(self, folder: Path, plan: Plan, resume: bool, workers: int) -> None:
        self.folder, self.plan = pathlib.Path(folder), plan
        self.rows: dict[int, Row] = {}
        self.lock = threading.Lock()
        self.folder.mkdir(parents=True, exist_ok=True)
        me, digest, note = job(), plan.digest(), self.folder / "plan.json"
        with open(self.folder / "gate", "a") as gate:
            fcntl.flock(gate, fcntl.LOCK_EX)               # who comes in decides alone
            self.inside = open(self.folder / "inside", "a")
            alone = try_lock(self.inside)
            there = json.loads(note.read_text()) if note.exists() else {}
            n = len(plan.values)
            # a few blocks for each worker, and no more than march side by side
            plan.block = max(1, min(64, n//(BLOCKS_EACH*workers*rank()[2])))
            if there and (resume or there["job"] == me):
                if there["digest"] != digest:
                    raise ValueError(f"{folder} is of another sweep: deck, options, variants or measures differ")
                plan.block = there["block"]
            elif not alone:
                raise ValueError(f"another sweep writes to {folder}; --resume joins it")
            else:
                for path in self.folder.glob("*.csv"):
                    path.unlink()
            if alone:
                note.write_text(json.dumps({"job": me, "digest": digest, "block": plan.block}))
            fcntl.flock(self.inside, fcntl.LOCK_SH)
        self.n_block = -(-n//plan.block)

    def work(self, stopped: threading.Event, told: Told | None, histories: pathlib.Path | None) -> None:
        """Do blocks until all are done, by whoever."""
        while not stopped.is_set():
            busy = False
            for b in range(self.n_block):
                if stopped.is_set():
                    return
                if self.is_done(b):
                    continue
                with open(self.folder / f"{b:06d}.csv", "a+", newline="", encoding="utf-8") as file:
                    if try_lock(file):
                        self.work_on(b, file, stopped, told, histories)
                    else:
                        busy = True
            if not busy:
                return
            stopped.wait(0.05)

    def variants(self, b: int) -> range:
        return range(b*self.plan.block, min((b + 1)*self.plan.block, len(self.plan.values)))

    def is_done(self, b: int) -> bool:
        return all(k in self.rows for k in self.variants(b))

    def work_on(self, b: int, file: IO[str], stopped: threading.Event, told: Told | None,
                histories: pathlib.Path | None) -> None:
        """The rows of a block that are there, and those that are missing."""
        file.seek(0)
        text = file.read()
        whole = text[:text.rfind("\n") + 1]                # a kill may have cut the last row
        if len(whole) < len(text):
            file.truncate(len(whole.encode()))
        for row in csv.reader(whole.splitlines()):
            self.take(int(row[0]) - 1, [*map(float, row[1:-2]), int(row[-2]), row[-1]])
        writer = csv.writer(file, lineterminator="\n")
        missing = [k for k in self.variants(b) if k not in self.rows]
        at_once = self.plan.block if self.plan.beside else 1
        for first in range(0, len(missing), at_once):
            rows = self.plan.run(missing[first:first + at_once], stopped, histories)
            if stopped.is_set():                           # they may have been cut short
                return
            for k, row in sorted(rows.items()):
                writer.writerow([k + 1, *map(repr, row[:-1]), row[-1]])
                self.take(k, row)
                if told:
                    told(len(self.rows), len(self.plan.values))
            file.flush()

    def take(self, k: int, row: Row) -> None:
        with self.lock:
            self.rows[k] = row

    def close(self, finish: Callable[[], None] | None = None) -> None:
        """Leave; the first of those that have all rows calls finish, the last takes the folder away."""
        with open(self.folder / "gate", "a") as gate:
            fcntl.flock(gate, fcntl.LOCK_EX)
            if finish and not (self.folder / "written").exists():
                finish()
                (self.folder / "written").touch()
            if finish and try_lock(self.inside):
                shutil.rmtree(self.folder)
            self.inside.close()


def try_lock(file: IO[str]) -> bool:
    """Lock an open file, unless another has it."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


class Table:
    """A column of one value a variant for each parameter and measure, with its attributes; and what they are of."""

    def __init__(self, n: int, columns: Columns, about: dict[str, str]) -> None:
        self.n, self.columns, self.about = n, columns, about

    def to_xarray(self) -> xarray.Dataset:
        import xarray
        return xarray.Dataset({name: ("variant", *column) for name, column in self.columns.items()},
                              {"variant": np.arange(1, self.n + 1)}, self.about)

    def write(self, path: Path) -> None:
        """A CSV, or an HDF5 (netCDF) file and a CSV beside it, by the end of the name."""
        path = pathlib.Path(path)
        if path.suffix != ".csv":
            with replaced(path) as new:
                self.write_h5(new)
        with replaced(path.with_suffix(".csv")) as new, open(new, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["variant", *self.columns])
            columns = (values.tolist() for values, _ in self.columns.values())
            for row in zip(range(1, self.n + 1), *columns):
                writer.writerow(["" if value != value else value for value in row])

    def write_h5(self, path: Path) -> None:
        import h5netcdf
        import h5py
        with h5netcdf.File(path, "w") as file:
            file.attrs.update(self.about)
            file.dimensions["variant"] = self.n
            columns: Columns = {"variant": (np.arange(1, self.n + 1), {}), **self.columns}
            for name, (values, about) in columns.items():
                kind = h5py.string_dtype() if values.dtype == object else values.dtype
                file.create_variable(name.replace("/", "|"), ("variant",), kind, data=values).attrs.update(about)


@contextlib.contextmanager
def replaced(path: pathlib.Path) -> Iterator[pathlib.Path]:
    """A name to write to, that takes the place of a file once it is whole."""
    new = path.with_name(path.name + ".new")
    yield new
    os.replace(new, path)


def sweep(deck: Path, vary: Mapping[str, Any] | None = None, measure: Sequence[str] = (), *,
          table: Mapping[str, npt.ArrayLike] | None = None, draws: int | None = None, method: str = "random",
          seed: int = 0, engine: Path | None = None, workers: int | None = None, output: Path | None = None,
          keep: Collection[int] = (), resume: bool = False, reproducible: bool = False,
          told: Told | None = None, **options: Any) -> xarray.Dataset:
    """Run the variants of a deck; gives an xarray.Dataset over `variant`.

    vary: {name: values or a text as on the command line}; table: {name: one value a variant}.
    measure: texts "CHANNEL:FUNCTION". draws, method (random, lhs, sobol), seed: so many draws
    instead of all combinations. workers: variants at a time, default: all cores. output: a file
    SWEEP.h5, with a SWEEP.csv beside it, or a .csv alone; rows are kept in OUTPUT.rows until it is
    written. keep: numbers of variants, from 1, whose histories go to OUTPUT.runs. resume: go on
    with what OUTPUT.rows holds, or join who works on it. told(n_done, n_all): after each variant.
    Options: those of Model, such as until, and sample, the interval of what measures see.

    Raises Error when the deck cannot be read, ValueError for what cannot be swept. A variant that
    fails has NaN as its measures, and why in `status`.

    >>> import pathlib, kjoint
    >>> deck = kjoint.example().deck().replace(" 2.0000000000000e+00   9100002", "               &mass   9100002")
    >>> mass = "/PARAMETER/GLOBAL/REAL/1\\nmass of the bar\\nmass                       2.0\\n/NODE"
    >>> _ = pathlib.Path("bar_0000.rad").write_text(deck.replace("/NODE", mass, 1))
    >>> found = kjoint.sweep("bar_0000.rad", {"mass": [1, 2, -1]}, ["joint/force[hinge].norm:max"], until=1.0, sample=0.01)
    >>> found["joint/force[hinge].norm:max"].values.round(1)             # N
    array([21.5, 48.9,  nan])
    """
    if table is not None:
        names = list(table)
        values = np.column_stack([np.asarray(table[name], float) for name in names])
    else:
        names, values = plan(vary or {}, draws, method, seed)
    return tabulate(deck, names, values, measure, engine=engine, workers=workers, output=output, keep=keep, resume=resume,
                    reproducible=reproducible, told=told, **options).to_xarray()


def tabulate(deck: Path, names: Sequence[str], values: Array, measure: Sequence[str], *, engine: Path | None = None,
             workers: int | None = None, output: Path | None = None, keep: Collection[int] = (), resume: bool = False,
             reproducible: bool = False, told: Told | None = None, **options: Any) -> Table:
    """sweep() of values (variants, names)."""
    measures = [Measure(text) for text in measure]
    values = np.array([float(text_of(value)) for value in values.ravel()]).reshape(values.shape)
    if keep and not output:
        raise ValueError("histories are kept beside an output: name it")
    work = Plan(deck, engine, options, names, values, measures, {k - 1 for k in keep})
    units = work.units()
    histories = pathlib.Path(f"{output}.runs") if keep else None
    if histories:
        histories.mkdir(parents=True, exist_ok=True)

    def finish() -> None:
        found: list[Any] = list(zip(*(rows[k] for k in range(n)))) or [()]*(len(measures) + 2)
        data: Columns = {name: (values[:, i], {}) for i, name in enumerate(names)}
        for m, unit, column in zip(measures, units, found):
            data[m.text] = (np.array(column, float), {"channel": m.channel, "function": m.text.rpartition(":")[2], "units": unit})
        data["cycles"] = (np.array(found[-2], int), {"units": "1"})
        data["status"] = (np.array(found[-1], object), {})
        about = {"title": "variants of a deck", "deck": str(deck), "kjoint_version": version()}
        if not reproducible:
            about.update(date=datetime.datetime.now().astimezone().isoformat(timespec="seconds"), host=socket.gethostname())
        made.append(Table(n, data, about))

    def finish_file() -> None:
        finish()
        if output:
            made[0].write(output)

    made: list[Table] = []
    n = len(values)
    with contextlib.ExitStack() as stack:
        folder = f"{output}.rows" if output else stack.enter_context(tempfile.TemporaryDirectory()) + "/rows"
        workers = workers or default_workers()
        store = Store(folder, work, resume, workers)
        rows = store.rows
        try:
            work_in_threads(store, workers, told, histories)
        except BaseException:
            store.close()
            raise
        store.close(finish_file)
        if not made:
            finish()
    return made[0]


def default_workers() -> int:
    return max(1, len(os.sched_getaffinity(0))//rank()[1])


def work_in_threads(store: Store, workers: int, told: Told | None, histories: pathlib.Path | None) -> None:
    """Threads that do blocks; Ctrl-C and what one raises end all of them, within a row."""
    stopped = threading.Event()
    raised: list[BaseException] = []

    def work() -> None:
        try:
            store.work(stopped, told, histories)
        except BaseException as error:
            raised.append(error)
            stopped.set()

    threads = [threading.Thread(target=work) for _ in range(min(workers, max(1, store.n_block)))]
    for thread in threads:
        thread.start()
    try:
        for thread in threads:
            while thread.is_alive():
                thread.join(0.5)
    finally:
        stopped.set()
        for thread in threads:
            thread.join()
    if raised:
        raise raised[0]


def read_table(path: Path) -> tuple[list[str], Array]:
    """Names and values (variants, names) of a CSV file of parameters."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        raise ValueError(f"{path} has no rows")
    names = list(rows[0])
    try:
        return names, np.array([[float(row[name]) for name in names] for row in rows])
    except TypeError:
        raise ValueError(f"{path}: a row has fewer columns than the first line") from None


def parse_numbers(text: str, n: int) -> Collection[int]:
    """Numbers of variants: all, or such as 1,20:30."""
    if text == "all":
        return range(1, n + 1)
    if not re.fullmatch(r"\d+(:\d+)?(,\d+(:\d+)?)*", text):
        raise ValueError(f"--keep {text}: all, or numbers such as 1,20:30")
    chosen: list[int] = []
    for word in text.split(","):
        first, _, last = word.partition(":")
        chosen += range(int(first), int(last or first) + 1)
    return chosen


def run_options(words: Iterable[str]) -> tuple[dict[str, Any], int | None]:
    """Options of a run from NAME=VALUE, where a name may have - for _; but for threads, which are the workers."""
    options = {name.replace("-", "_"): value for name, _, value in (word.partition("=") for word in words)}
    workers = options.pop("threads", "0")
    if not workers.isdecimal():
        raise ValueError(f"--threads {workers}: a number")
    return options, int(workers) or None


def parse_varied(words: Iterable[str]) -> dict[str, str]:
    """NAME=SPEC, each once."""
    pairs = [word.partition("=")[::2] for word in words]
    for name, spec in pairs:
        if not name or not spec or sum(name == other for other, _ in pairs) > 1:
            raise ValueError(f"--vary {name}={spec}: NAME=SPEC, each name once")
    return dict(pairs)


def in_words(command: Callable[[], int], stopped: str) -> int:
    """Exit code of a command; what goes wrong stands on stderr, and `stopped` after Ctrl-C."""
    try:
        return command()
    except (ValueError, TypeError) as error:
        code, text = 2, f"error: {error}"
    except (Error, OSError) as error:
        code, text = getattr(error, "status", 3), f"error: {error}"
    except KeyboardInterrupt:
        code, text = 130, stopped
    print(text, file=sys.stderr)
    return code


def main(words: Sequence[str] | None = None) -> int:
    """The command line, as `kjoint sweep` hands it over."""
    parser = Parser(prog="kjoint sweep", description="run variants of a deck")
    parser.add_argument("deck")
    parser.add_argument("engine", nargs="?")
    parser.add_argument("--vary", action="append", default=[])
    parser.add_argument("--table")
    parser.add_argument("--measure", action="append", default=[])
    parser.add_argument("--sample", type=int)
    for kind in ("random", "lhs", "sobol"):
        parser.add_argument(f"--{kind}", action="store_true")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--every")
    parser.add_argument("--output", required=True)
    parser.add_argument("--keep")
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--reproducible", action="store_true")
    parser.add_argument("--quiet", action="store_true")
    parser.add_argument("--run", action="append", default=[], metavar="NAME=VALUE", help="options of each run")
    args = parser.read(words)
    signal.signal(signal.SIGTERM, lambda *_: signal.raise_signal(signal.SIGINT))
    first = rank()[0] == 0
    began = time.monotonic()

    def told(done: int, of: int) -> None:
        if first and not args.quiet and sys.stderr.isatty():
            print(f"\r{done} of {of} variants", end="" if done < of else "\n", file=sys.stderr, flush=True)

    def run() -> int:
        if not args.measure:
            raise ValueError("nothing is measured: --measure CHANNEL:FUNCTION")
        if bool(args.vary) == bool(args.table):
            raise ValueError("what is varied: --vary NAME=SPEC, or --table FILE.csv")
        methods = [kind for kind in ("random", "lhs", "sobol") if getattr(args, kind)]
        if len(methods) > 1 or (methods or args.sample is not None) and args.table or methods and not args.sample:
            raise ValueError("--sample N with one of --random, --lhs, --sobol, and --vary")
        if args.sample is not None and args.sample < 1:
            raise ValueError("--sample is at least 1")
        options, workers = run_options(args.run)
        if args.every:
            options["sample"] = args.every
        if args.table:
            names, values = read_table(args.table)
        else:
            names, values = plan(parse_varied(args.vary), args.sample, methods[0] if methods else "random", args.seed)
        n = len(values)
        result = tabulate(args.deck, names, values, args.measure, engine=args.engine, workers=workers,
                          output=args.output, resume=args.resume, told=told, reproducible=args.reproducible,
                          keep=parse_numbers(args.keep, n) if args.keep else (), **options).columns
        failed = [text for text in result["status"][0] if text]
        if first and not args.quiet:
            for text in args.measure:
                y, about = result[text]
                fine = y[np.isfinite(y)]
                if len(fine):
                    print(f"{text:40}  {fine.min():.6g} to {fine.max():.6g}, mean {fine.mean():.6g}, "
                          f"deviation {fine.std():.3g}  {about['units']}")
            print(f"{n} variants, {len(failed)} failed, {time.monotonic() - began:.1f} s: {args.output}")
        if first and failed:
            print(f"warning: {len(failed)} of {n} variants failed, such as: {failed[0]}", file=sys.stderr)
        return 1 if len(failed) == n else 0

    return in_words(run, f"stopped; --resume goes on from {args.output}.rows")


if __name__ == "__main__":
    sys.exit(main())
