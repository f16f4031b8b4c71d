"""Parts of tools/bench: a step of a host (C, Python), and two threads beside busy processes."""
import json
import os
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
STEPS = 2000
BUSY = 4                                           # processes
PYTHON = """
import sys, time, statistics, kjoint
model = kjoint.Model(sys.argv[1], **dict(word.split("=") for word in sys.argv[2].split())).start()
model.step(500)
n, times = int(sys.argv[3]), []
for _ in range(9):
    begin = time.process_time()
    for _ in range(n):
        model.step()
    times.append(1e6*(time.process_time() - begin)/n)
print(statistics.median(times))
"""


def build(folder):
    """The host in C and the library, which tools/bench configured in folder/build; returns its path"""
    subprocess.run(["cmake", "--build", folder / "build", "--target", "kjoint_c"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cc", "-O2", "-I", ROOT / "include", ROOT / "tools" / "bench_step.c", "-L", folder / "build", "-lkjoint_c",
                    f"-Wl,-rpath,{folder / 'build'}", "-o", folder / "bench_step"], check=True)
    return folder / "bench_step"


def steps(folder, scenes, formulations):
    """us of processor time a step of each scene (name, deck): of C, of Python where it has numpy"""
    host, rows = build(folder), []
    for scene, deck in scenes:
        for name in formulations:
            words = [deck, f"formulation={name} until=1e9 sample=1e9", str(STEPS)]
            row = {"scene": scene, "formulation": name,
                   **json.loads(subprocess.run([host, *words], check=True, capture_output=True, text=True).stdout)}
            python = subprocess.run([sys.executable, "-c", PYTHON, *words], capture_output=True, text=True, check=False,
                                    env={**os.environ, "PYTHONPATH": str(ROOT / "python"),
                                         "KJOINT_LIBRARY": str(folder / "build" / "libkjoint_c.so")})
            row["python"] = float(python.stdout) if python.returncode == 0 else None
            rows.append(row)
    return rows


def load(kjoint, folder, scenes, formulations, rounds):
    """Wall time of two threads over that of one, in turns, alone and beside BUSY processes"""
    rows = []
    for scene, deck, until in scenes:
        for name, options in formulations.items():
            for busy in (0, BUSY):
                others = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(busy)]
                try:
                    times = {1: [], 2: []}
                    for _ in range(rounds):
                        for threads, seen in times.items():
                            out = subprocess.run([kjoint, "run", deck, "-q", "--json", "-o", folder / "run.h5", "--until",
                                                  str(until), "--sample", str(until), "--threads", str(threads), *options],
                                                 check=True, capture_output=True, text=True).stdout
                            seen.append(json.loads(out)["wall_solve"])
                finally:
                    for process in others:
                        process.kill()
                        process.wait()
                rows.append({"scene": scene, "formulation": name, "busy": busy,
                             "ratio": statistics.median(times[2])/statistics.median(times[1])})
    return rows


def table(result):
    """Lines of both parts, as far as they were measured"""
    lines = []
    if "step" in result:
        lines += ["| a host's step, us | formulation | inside advance | step | of n in one call | Python | with a body read |",
                  "|---|---|---|---|---|---|---|"]
        for r in result["step"]:
            python = "-" if r["python"] is None else f"{r['python']:.2f}"
            lines.append(f"| {r['scene']} | {r['formulation']} | {r['advance']:.2f} | {r['one']:.2f} | {r['many']:.2f} "
                         f"| {python} | {r['body']:.2f} |")
    for r in result.get("load", []):
        lines.append(f"- {r['scene']}, {r['formulation']}: two threads take {r['ratio']:.2f} of the time of one beside "
                     f"{r['busy']} busy processes")
    return "\n".join(lines) + "\n" if lines else ""
