"""Many variants of a deck at once: parameters in, a table of measures out.

    python -m kjoint.sweep DECK_0000.rad --vary length=0.1:0.2:5 --measure 'joint/force[pin].norm:max'

The parameters are those of /PARAMETER in the deck. sweep() does the same from Python.
"""
import argparse
import concurrent.futures
import csv
import itertools
import os
import pathlib
import re
import sys

import numpy as np

from ._error import Error
from .model import Model

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
FUNCTIONS = "max, min, mean, rms, range, final, tmax, tmin, at(t), rmse(REF.h5)"


class Grid:
    """Values of a parameter, one after the other."""

    def __init__(self, values):
        self.values = np.atleast_1d(np.asarray(values, dtype=float))


class Spread:
    """A parameter that is drawn: from the share of a distribution to its value."""

    def __init__(self, kind, a, b):
        self.kind, self.a, self.b = kind, a, b
        if kind == "uniform" and not a < b:
            raise ValueError(f"uniform({a:g},{b:g}): the first is not below the second")
        if kind == "normal" and not b > 0:
            raise ValueError(f"normal({a:g},{b:g}): the deviation is not above 0")

    def at(self, share):
        """Values at shares between 0 and 1."""
        if self.kind == "uniform":
            return self.a + (self.b - self.a)*share
        from statistics import NormalDist
        normal = NormalDist(self.a, self.b)
        return np.array([normal.inv_cdf(min(max(s, 1e-12), 1 - 1e-12)) for s in share])


def parse_vary(text):
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


def plan(vary, sample=None, method="random", seed=0):
    """Names and values (variants, names): all combinations of grids, or so many draws."""
    names = list(vary)
    made = [value if isinstance(value, (Grid, Spread)) else parse_vary(value)
            if isinstance(value, str) else Grid(value) for value in vary.values()]
    drawn = [isinstance(value, Spread) for value in made]
    if not sample:
        if any(drawn):
            raise ValueError(f"{names[drawn.index(True)]} is drawn: how many variants (sample)?")
        rows = list(itertools.product(*(value.values for value in made)))
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

    def __init__(self, text):
        self.text = text
        channel, colon, function = text.rpartition(":")
        match = re.fullmatch(r"(\w+)(?:\((.*)\))?", function)
        if not colon or not match or match[1] not in re.findall(r"[a-z]+", FUNCTIONS):
            raise ValueError(f"{text!r} is no CHANNEL:FUNCTION; functions: {FUNCTIONS}")
        self.channel, self.function, self.argument = channel, match[1], match[2]
        if (self.function in ("at", "rmse")) != (self.argument is not None):
            raise ValueError(f"{text!r}: at(t) and rmse(REF.h5) have an argument, no other has")
        self.reference = None
        if self.function == "at":
            self.argument = float(self.argument)
        if self.function == "rmse":
            from ._show import export
            table = export(self.argument, [channel])
            self.reference = read_reference(table)

    def of(self, time, y):
        """The measure of a curve."""
        simple = {"max": np.max, "min": np.min, "mean": np.mean, "range": np.ptp,
                  "rms": lambda v: np.sqrt(np.mean(v*v)), "final": lambda v: v[-1],
                  "tmax": lambda v: time[np.argmax(v)], "tmin": lambda v: time[np.argmin(v)]}
        if self.function in simple:
            return float(simple[self.function](y))
        if self.function == "at":
            if not time[0] <= self.argument <= time[-1]:
                return float("nan")
            return float(np.interp(self.argument, time, y))
        at, wanted = self.reference
        inside = at <= time[-1]
        return float(np.sqrt(np.mean((np.interp(at[inside], time, y) - wanted[inside])**2)))


def read_reference(table):
    """Times and values of the one curve that `export` gave."""
    series = [s for s in table["series"] if s["name"] != "time"]
    if len(series) != 1:
        raise ValueError(f"a reference curve is one, not {len(series)}")
    return np.asarray(table["time"], float), np.asarray(series[0]["values"], float)


def run_variant(deck, engine, options, names, values, measures, history):
    """Measures of one variant, and what went wrong, else ''."""
    words = ",".join(f"{name}={value!r}" for name, value in zip(names, map(float, values)))
    given = ",".join(filter(None, (options.get("set"), words)))
    try:
        model = Model(deck, engine, **{**options, "set": given or None}).run()
        time = model["time"]
        found = [m.of(time, model.curve(m.channel)) for m in measures]
        if history:
            model.write_history(history)
        return found, ""
    except Error as error:
        return [float("nan")]*len(measures), str(error).splitlines()[0]


def sweep(deck, vary=None, measure=(), *, table=None, draws=None, method="random", seed=0,
          engine=None, workers=None, keep=None, resume=None, told=None, **options):
    """Run the variants of a deck; gives an xarray.Dataset over `variant`.

    vary: {name: values or a text as on the command line}; table: {name: one value a variant}.
    measure: texts "CHANNEL:FUNCTION". draws, method (random, lhs, sobol), seed: draws instead of
    all combinations. keep: a folder for the histories. resume: a CSV file of rows that are done;
    new rows are added to it. told(n_done, n_all): after each variant. Options: those of Model.
    """
    import xarray as xr
    measures = [Measure(text) for text in measure]
    if table is not None:
        names = list(table)
        values = np.column_stack([np.asarray(table[name], float) for name in names])
    else:
        names, values = plan(vary or {}, draws, method, seed)
    if keep:
        pathlib.Path(keep).mkdir(parents=True, exist_ok=True)
    head = ["variant", *names, *(m.text for m in measures), "status"]
    done = read_done(resume, head, values, names) if resume else {}
    rows, log = dict(done), None
    if resume:
        log = open(resume, "a", newline="", encoding="utf-8")
        writer = csv.writer(log)
        if log.tell() == 0:
            writer.writerow(head)
    try:
        with concurrent.futures.ThreadPoolExecutor(workers or len(os.sched_getaffinity(0))) as pool:
            jobs = {pool.submit(run_variant, str(deck), engine and str(engine), options, names, values[k],
                                measures, keep and str(pathlib.Path(keep)/f"variant_{k + 1:05d}.h5")): k
                    for k in range(len(values)) if k not in done}
            try:
                for job in concurrent.futures.as_completed(jobs):
                    k = jobs[job]
                    rows[k] = job.result()
                    if log:
                        writer.writerow([k + 1, *map(repr, map(float, values[k])), *map(repr, rows[k][0]), rows[k][1]])
                        log.flush()
                    if told:
                        told(len(rows), len(values))
            except BaseException:
                pool.shutdown(wait=True, cancel_futures=True)
                raise
    finally:
        if log:
            log.close()
    n = len(values)
    data = {name: ("variant", values[:, i]) for i, name in enumerate(names)}
    for i, m in enumerate(measures):
        data[m.text] = ("variant", np.array([rows[k][0][i] for k in range(n)]), {"channel": m.channel})
    data["status"] = ("variant", np.array([rows[k][1] for k in range(n)], dtype=object))
    return xr.Dataset(data, {"variant": np.arange(1, n + 1)}, {"deck": str(deck), "title": "variants of a deck"})


def read_done(path, head, values, names):
    """Rows of an earlier sweep that are those of this one, by the number of the variant from 0."""
    path = pathlib.Path(path)
    if not path.exists():
        return {}
    done = {}
    with path.open(newline="", encoding="utf-8") as file:
        rows = csv.reader(file)
        if next(rows, head) != head:
            raise ValueError(f"{path} is of another sweep: its columns differ")
        for row in rows:
            if len(row) != len(head):                      # cut by a kill
                continue
            k = int(row[0]) - 1
            if not 0 <= k < len(values) or [float(x) for x in row[1:1 + len(names)]] != list(values[k]):
                raise ValueError(f"{path} is of another sweep: variant {row[0]} differs")
            done[k] = [float(x) for x in row[1 + len(names):-1]], row[-1]
    return done


def write(table, path):
    """A CSV or an HDF5 (netCDF) file, by the end of its name."""
    path = pathlib.Path(path)
    if path.suffix == ".csv":
        new = path.with_name(path.name + ".new")
        table.to_dataframe().to_csv(new)
        os.replace(new, path)
        return
    new = path.with_name(path.name + ".new")
    safe = table.rename({name: name.replace("/", "|") for name in table.data_vars if "/" in name})
    safe["status"] = safe["status"].astype(str)
    safe.to_netcdf(new, engine="h5netcdf")
    os.replace(new, path)


def main(words=None):
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m kjoint.sweep", description="run variants of a deck")
    parser.add_argument("deck")
    parser.add_argument("engine", nargs="?")
    parser.add_argument("--vary", action="append", default=[], metavar="NAME=SPEC",
                        help="a:b:n[:log], v1,v2,..., normal(mean,sd), uniform(a,b)")
    parser.add_argument("--table", metavar="FILE.csv", help="a column a parameter, a row a variant")
    parser.add_argument("--measure", action="append", default=[], metavar="CHANNEL:FUNCTION", help=FUNCTIONS)
    parser.add_argument("--sample", type=int, metavar="N", help="so many draws instead of all combinations")
    kinds = parser.add_mutually_exclusive_group()
    for kind in ("random", "lhs", "sobol"):
        kinds.add_argument(f"--{kind}", dest="method", action="store_const", const=kind)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("-o", "--output", metavar="FILE", help="SWEEP.h5 or SWEEP.csv; default ROOT_sweep.csv")
    parser.add_argument("--keep", metavar="FOLDER", help="the histories of all variants")
    parser.add_argument("--resume", action="store_true", help="go on with a sweep that was stopped")
    parser.add_argument("--threads", type=int, metavar="N", help="variants at a time; default: all cores")
    parser.add_argument("-q", "--quiet", action="store_true")
    parser.add_argument("--options", default="", metavar="'NAME=V ...'", help="of each run: formulation=legacy until=0.1")
    args = parser.parse_args(words)

    def told(done, of):
        if not args.quiet and sys.stderr.isatty():
            print(f"\r{done} of {of} variants", end="" if done < of else "\n", file=sys.stderr)

    root = pathlib.Path(args.deck).name.replace("_0000.rad", "")
    output = pathlib.Path(args.output or f"{root}_sweep.csv")
    log = output.with_name(output.name + ".rows")
    try:
        if not args.measure:
            raise ValueError("nothing is measured: --measure CHANNEL:FUNCTION")
        if not args.vary and not args.table:
            raise ValueError("nothing is varied: --vary NAME=SPEC or --table FILE.csv")
        vary = dict(text.split("=", 1) if "=" in text else (text, "") for text in args.vary)
        table = None
        if args.table:
            with open(args.table, newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            table = {name: [float(row[name]) for row in rows] for name in rows[0]} if rows else {}
        if not args.resume and log.exists():
            log.unlink()
        options = dict(word.split("=", 1) for word in args.options.split())
        result = sweep(args.deck, vary, args.measure, table=table, draws=args.sample, method=args.method or "random",
                       seed=args.seed, engine=args.engine, workers=args.threads, keep=args.keep, resume=log,
                       told=told, **options)
        write(result, output)
        log.unlink()
    except (ValueError, TypeError, KeyError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except (Error, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return getattr(error, "status", 3)
    except KeyboardInterrupt:
        print(f"stopped; `--resume` goes on ({log})", file=sys.stderr)
        return 130
    failed = int((result["status"].astype(str) != "").sum())
    if not args.quiet:
        for text in args.measure:
            y = result[text].values
            fine = y[np.isfinite(y)]
            if len(fine):
                print(f"{text:40}  {fine.min():.6g} to {fine.max():.6g}, mean {fine.mean():.6g}")
        print(f"{result.sizes['variant']} variants, {failed} failed: {output}")
    return 1 if failed == result.sizes["variant"] else 0


if __name__ == "__main__":
    sys.exit(main())
