#!/usr/bin/env python3
"""Springs of /PROP/TYPE4 and TYPE8, plastic, failing and switched ones too, against closed forms, under both formulations.

usage: check_springs.py KJOINT WORK_DIR      (needs numpy and h5py; exit 1 on a violation)

A mass m on a spring k with damper c that starts from rest position with v0 moves as
x = v0/p e^(-d t) sin(p t), d = c/(2 m), p^2 = k/m - d^2. A leapfrog of step h is off in phase by
(w h)^2/24 per radian, and with damping from the last half step (legacy) by h/2 of the damper's share.
"""
import json
import pathlib
import subprocess
import sys

import h5py
import numpy as np

failed = []
KJOINT = sys.argv[1]
WORK = pathlib.Path(sys.argv[2])
WORK.mkdir(parents=True, exist_ok=True)


def check(name, value, limit):
    ok = value <= limit
    print(f"{'ok    ' if ok else 'FAILED'} {name:66s} {value:9.2e} <= {limit:7.1e}")
    if not ok:
        failed.append(name)


class Deck:
    """Blocks of a starter deck, kg m s"""

    def __init__(self, name, t_stop, dt, sample):
        self.name, self.ids = name, 0
        self.text = ["/BEGIN", name, f"{2026:10d}{0:10d}", *[f"{'kg':>20}{'m':>20}{'s':>20}"] * 2]
        # the nodal step: without it legacy TYPE4 springs limit the step by their own little mass
        self.engine = f"/RUN/{name}/1\n{t_stop}\n/TFILE/1\n{sample}\n/DT/NODA\n0.9 0.0\n/DTIX\n{dt} {dt}\n"

    def block(self, keyword, *cards):
        self.text += [keyword, *cards]

    def titled(self, keyword, *cards):
        self.ids += 1
        self.block(f"{keyword}/{self.ids}", "title", *cards)
        return self.ids

    def nodes(self, *places):
        self.block("/NODE", *[f"{i:10d}" + reals(*x) for i, x in places])

    def group(self, *nodes):
        return self.titled("/GRNOD/NODE", ints(*nodes))

    def fix(self, *nodes):
        self.titled("/BCS", f"   111 111{0:10d}{self.group(*nodes):10d}")

    def mass(self, node, mass):
        self.titled("/ADMAS/5", reals(mass) + ints(node))

    def start(self, node, kind, *v):
        self.titled(f"/INIVEL/{kind}", reals(*v) + ints(self.group(node)))

    def body(self, main, mass, inertia, *nodes):
        self.titled("/RBODY", ints(main, 0, 0, 3) + reals(mass) + ints(self.group(*nodes)), reals(*inertia))

    def part(self, prop, *springs):
        self.block(f"/PART/{prop}", "part", ints(prop))
        self.block(f"/SPRING/{prop}", *[ints(*s) for s in springs])

    def history(self, nodes, springs):
        self.titled("/TH/NODE", "DEF", *[ints(n) for n in nodes])
        self.titled("/TH/SPRING", "DEF", *[ints(s) for s in springs])

    def run(self, formulation, *options):
        deck = WORK / f"{self.name}_0000.rad"
        deck.write_text("\n".join(self.text) + "\n/END\n")
        (WORK / f"{self.name}_0001.rad").write_text(self.engine)
        path = WORK / f"{self.name}_{formulation}.h5"
        subprocess.run([KJOINT, "run", deck, "-q", "-o", path, "--formulation", formulation, *options], check=True)
        return h5py.File(path)


def reals(*values):
    return "".join(f"{v:20.12g}" for v in values)


def ints(*values):
    return "".join(f"{v:10d}" for v in values)


def law(k=0.0, c=0.0, a=0.0, fct1=0, fct4=0, f=0.0, ascale=0.0, hscale=0.0, rule=0, delta_max=0.0):
    """The three cards of one direction"""
    return (reals(k, c, a), ints(fct1, rule, 0, 0, fct4, 0) + reals(0.0, delta_max),
            reals(f, 0.0, ascale, hscale))


def ring(t, v0, k, m, c):
    d = 0.5 * c / m
    p = np.sqrt(k / m - d * d)
    return v0 / p * np.exp(-d * t) * np.sin(p * t)


M, K, V = 4.0, 400.0, 0.5
W = np.sqrt(K / M)                                 # 10 rad/s


def single(name, cards, h=2e-4, functions=(), sensor=None):
    """A mass on one TYPE4 spring of mass 2e-6 to the ground, 1 m long, along (2, 1, 2)/3; both ends count half"""
    deck = Deck(name, 1.0, h, 0.01)
    e = np.array([2.0, 1.0, 2.0]) / 3.0
    deck.nodes((1, (1.0, 2.0, 3.0)), (2, np.array([1.0, 2.0, 3.0]) + e))
    for number, points in functions:
        deck.block(f"/FUNCT/{number}", "f", *[reals(*p) for p in points])
    if sensor:
        deck.block("/SENSOR/TIME/3", "sensor", reals(sensor[0]))
    deck.block("/PROP/TYPE4/1", "spring", reals(2.0e-6) + 30 * " " + (ints(3, sensor[1]) if sensor else ""), *cards)
    deck.part(1, (11, 1, 2))
    deck.fix(1)
    deck.mass(2, M - 1.0e-6)
    deck.mass(1, 1.0)
    deck.start(2, "TRA", *(V * e))
    deck.history([2], [11])
    return deck, e


def oscillators(formulation):
    h = 2e-4
    # phase after 1 s: w t (w h)^2/24; a damper that is late by h/2 acts as a mass c h/2 less: w t c h/(4 m)
    phase = V / W * W * (W * h)**2 / 24
    for name, cards, functions, c in [
            ("oscillator", law(K), (), 0.0),
            ("damped", law(K, 8.0), (), 8.0),
            # 3 v + 10 f4(v/2) with f4(u) = u is (3 + 5) v
            ("tabulated_damper", law(K, 3.0, fct4=7, f=2.0, hscale=10.0), [(7, [(-1.0, -1.0), (1.0, 1.0)])], 8.0),
            # 200 f1(x/0.5) with f1(u) = u is 400 x
            ("scaled_function", law(a=200.0, fct1=7, ascale=0.5), [(7, [(-1.0, -1.0), (1.0, 1.0)])], 0.0)]:
        deck, e = single(name, cards, h, functions)
        run = deck.run(formulation)
        t, d = run["time"][:], run["node/displacement"][:, 0, :]
        x = ring(t, V, K, M, c)
        late = V / W * W * c * h / (4 * M) if formulation == "legacy" else 0.0
        check(f"{formulation} {name}: motion", abs(d @ e - x).max(), 1.2 * phase + 1.2 * late + 1e-9)
        check(f"{formulation} {name}: across", abs(d - np.outer(d @ e, e)).max(), 1e-10)
        q, f = run["spring/displacement"][:, 0, 0], run["spring/force"][:, 0, 0]
        check(f"{formulation} {name}: change of length", abs(q - d @ e).max(), 1e-12)
        if c == 0.0:
            check(f"{formulation} {name}: force on node 1", abs(f - K * q).max(), 1e-9)
            check(f"{formulation} {name}: energy", abs(run["energy_error"][:]).max(), (W * h)**2)
        else:
            # what the damper took: energy at the start less that at the end
            v = np.gradient(x, t, edge_order=2)
            rest = 0.5 * M * v[-1]**2 + 0.5 * K * x[-1]**2
            check(f"{formulation} {name}: work on the spring", abs(run["spring/internal_energy"][-1, 0] -
                  (0.5 * M * V * V - 0.5 * M * v[-1]**2)), 2e-3 * 0.5 * M * V * V)
            assert rest < 0.5 * M * V * V


def gap(formulation):
    """No force within 0.01 m, then K: half a period is pi/w + 2 g/V; after n of them x = 0 and v = +-V"""
    g, h = 0.01, 1e-4
    points = [(-1.0, -K * (1.0 - g)), (-g, 0.0), (g, 0.0), (1.0, K * (1.0 - g))]
    deck, e = single("gap", law(fct1=7), h, [(7, points)])
    run = deck.run(formulation, "--sample", "0")
    t, x = run["time"][:], run["node/displacement"][:, 0, :] @ e
    at = np.flatnonzero(x[:-1] * x[1:] < 0.0)
    cross = t[at] - x[at] * (t[at + 1] - t[at]) / (x[at + 1] - x[at])
    half = np.pi / W + 2.0 * g / V
    check(f"{formulation} gap: half periods", abs(cross - half * np.arange(1, len(cross) + 1)).max(), 2e-5)
    check(f"{formulation} gap: number of them less 2", abs(len(cross) - int(1.0 / half)), 0)
    check(f"{formulation} gap: amplitude", abs(abs(x).max() - g - V / W), 1e-5)


def inelastic(formulation):
    """Plastic (H = 2), failing and switched springs of stiffness K, from rest with 1/2 M V^2 = 0.5"""
    h = 2e-4

    def motion(name, *args, **more):
        deck, e = single(name, *args, h=h, **more)
        run = deck.run(formulation)
        return run, run["time"][:], run["node/displacement"][:, 0, :] @ e, run["node/velocity"][:, 0, :] @ e

    # yields at 10 = K 0.025 and has 0.375 left for 10 (x - 0.025): to 0.0625; 10^2/(2 K) = 0.125 come back,
    # v = -0.25, and from 0.0375 down to 0 there is no force
    yields = [(-1.0, -10.0), (-0.025, -10.0), (0.025, 10.0), (1.0, 10.0)]
    run, t, x, v = motion("plastic", law(K, fct1=7, rule=2), functions=[(7, yields)])
    free = (t > 0.40) & (t < 0.50)
    check(f"{formulation} plastic: farthest", abs(x.max() - 0.0625), 3.2e-5)   # samples, 2.5 m/s^2
    check(f"{formulation} plastic: comes back", abs(v[free] + 0.25).max(), 5e-4)
    check(f"{formulation} plastic: no force", abs(run["spring/force"][free, 0, 0]).max(), 0.0)
    check(f"{formulation} plastic: work", abs(run["spring/internal_energy"][free, 0] - 0.375).max(), 5e-4)
    # breaks at 0.03, at most v h late: 1/2 K 0.03^2 = 0.18 are lost, v^2 = V^2 - 0.09
    run, t, x, v = motion("failing", law(K, delta_max=0.03))
    check(f"{formulation} failing: flies on", abs(v[t > 0.1] - 0.4).max(), 1e-3)
    check(f"{formulation} failing: took", abs(run["spring/internal_energy"][-1, 0] - 0.18), 2e-3)
    check(f"{formulation} failing: energy", abs(run["energy_error"][:]).max(), 3e-3)
    # on at 0.1, at x = 0.05 with V: amplitude (0.05^2 + (V/w)^2)^1/2 about 0; with Isflag 2 V/w about 0.05
    run, t, x, v = motion("switched", law(K), sensor=(0.1, 0))
    check(f"{formulation} switched on: amplitude", abs(x.max() - 0.05 * np.sqrt(2.0)), 1e-4)
    run, t, x, v = motion("rezeroed", law(K), sensor=(0.1, 2))
    check(f"{formulation} switched on without force: amplitude", abs(x.max() - 0.1), 2e-4)
    run, t, x, v = motion("released", law(K), sensor=(0.1, 1))
    check(f"{formulation} switched off: flies on", abs(v[t > 0.11] - V * np.cos(0.1 * W)).max(), 2e-3)


def skewed(formulation):
    """TYPE8 between a fixed point and a mass, 0.3 m apart, in axes turned about z: three oscillators"""
    h, a = 2e-4, np.radians(30.0)
    axes = np.array([[np.cos(a), np.sin(a), 0.0], [-np.sin(a), np.cos(a), 0.0], [0.0, 0.0, 1.0]])
    k = np.array([400.0, 900.0, 100.0])
    v = np.array([0.3, 0.5, -0.4])
    deck = Deck("skewed", 1.0, h, 0.01)
    deck.nodes((1, (0.0, 0.0, 0.0)), (2, (0.3, 0.0, 0.0)))
    deck.block("/SKEW/FIX/5", "skew", reals(0, 0, 0), reals(*axes[1]), reals(*axes[2]))
    deck.block("/PROP/SPR_GENE/1", "spring", reals(0.0, 1e-6) + ints(5),
               *[card for one in k for card in law(one)], *[card for _ in range(3) for card in law(0.0)])
    deck.part(1, (11, 1, 2))
    deck.fix(1)
    deck.mass(1, 1.0)
    deck.mass(2, M)
    deck.start(2, "TRA", *v)
    deck.history([2], [11])
    run = deck.run(formulation)
    t, d = run["time"][:], run["node/displacement"][:, 0, :] @ axes.T
    w = np.sqrt(k / M)
    x = (axes @ v) / w * np.sin(np.outer(t, w))
    check(f"{formulation} skewed: motion", abs(d - x).max(), abs(v).max() * (w.max() * h)**2 / 24 * 1.5 + 1e-9)
    check(f"{formulation} skewed: force", abs(run["spring/force"][:, 0, :] - k * d).max(), 1e-9)


def torsion(formulation):
    """A body that turns about x against Krx: angle = w0/w sin(w t), w^2 = Krx/Jxx; and a damper Crx"""
    h, j, k, c, w0 = 2e-4, 2.0, 200.0, 4.0, 1.0
    for damping in (0.0, c):
        deck = Deck(f"torsion{damping:.0f}", 1.0, h, 0.01)
        deck.nodes((1, (0.0, 0.0, 0.0)), (2, (0.0, 0.0, 0.0)), (3, (0.0, 0.0, 0.0)))
        deck.block("/PROP/TYPE8/1", "spring", reals(0.0, 1e-6), *[card for _ in range(3) for card in law(1e4)],
                   *law(k, damping), *law(), *law())
        deck.part(1, (11, 1, 3))
        deck.fix(1)
        deck.mass(1, 1.0)
        deck.titled("/ADMAS/0", reals(0.0) + ints(deck.group(1)))
        deck.body(2, M, (j, 3.0, 4.0), 3)
        deck.start(2, "ROT", w0, 0.0, 0.0)
        deck.titled("/TH/RBODY", "DEF", ints(0))
        deck.history([2], [11])
        run = deck.run(formulation, *([] if formulation == "consistent" else ["--sample", "0.01"]))
        # half of the spring's inertia sits on the body
        angle = ring(run["time"][:], w0, k, j + 0.5e-6, damping)
        found = run["spring/rotation"][:, 0, 0]
        late = w0 * damping * h / (4 * j) if formulation == "legacy" else 0.0
        check(f"{formulation} torsion, c = {damping:.0f}: angle", abs(found - angle).max(),
              1.2 * (w0 * (10 * h)**2 / 24 + late) + 1e-6)
        if damping == 0.0:
            check(f"{formulation} torsion: moment", abs(run["spring/moment"][:, 0, 0] - k * found).max(), 1e-9)


def two_bodies(formulation, first, skew_body, equal):
    """Two bodies on a TYPE8 bushing of some length, whose axes ride on one of them, thrown into space"""
    deck = Deck(f"bushing{first}{skew_body}{equal}", 0.5, 1e-3, 0.005)
    deck.nodes((1, (0.0, 0.0, 0.0)), (11, (0.2, 0.1, 0.0)), (12, (0.4, 0.1, 0.0)), (13, (0.2, 0.3, 0.1)),
               (2, (0.8, 0.2, 0.1)), (21, (0.5, 0.2, 0.1)), (22, (0.9, 0.2, 0.1)), (23, (0.8, 0.5, 0.3)))
    deck.block("/SKEW/MOV/5", "skew", ints(*([11, 12, 13] if skew_body == 1 else [21, 22, 23])))
    k = (4e3,) * 6 if equal else (4e3, 9e3, 2e3, 60.0, 90.0, 40.0)
    deck.block("/PROP/TYPE8/1", "spring", reals(0.1, 1e-3) + ints(5), *[card for one in k for card in law(one, 0.0)])
    deck.part(1, (101, 11, 21) if first == 1 else (101, 21, 11))
    deck.body(1, 5.0, (0.5, 0.6, 0.7), 11, 12, 13)
    deck.body(2, 3.0, (0.3, 0.2, 0.4), 21, 22, 23)
    deck.start(1, "ROT", 0.5, -2.0, 3.0)
    deck.start(2, "TRA", 0.5, 1.0, -0.7)
    deck.history([1], [101])
    deck.titled("/TH/RBODY", "DEF", ints(0))
    return deck.run(formulation)


def bushings(formulation):
    for skew_body in (1, 2):
        runs = [two_bodies(formulation, first, skew_body, False) for first in (1, 2)]
        name = f"{formulation} bushing, axes on body {skew_body}"
        for axis in "xyz":
            p, l = runs[0][f"momentum_{axis}"][:], runs[0][f"angular_momentum_{axis}"][:]
            check(f"{name}: momentum {axis}", abs(p - p[0]).max(), 1e-12)
            # the legacy spring has no couple r x F, and keeps neither this nor energy
            if formulation == "consistent":
                check(f"{name}: angular momentum {axis}", abs(l - l[0]).max(), 1e-12)
        if formulation == "consistent":
            check(f"{name}: energy", abs(runs[0]["energy_error"][:]).max(), 1e-3)
        # named from the other end it is the same spring: the force on node 1 is the opposite one
        x = [run["rigid_body/position"][:] for run in runs]
        check(f"{name}: ends exchanged, motion", abs(x[0] - x[1]).max(), 1e-9)
        f = [run["spring/force"][:, 0] for run in runs]
        check(f"{name}: ends exchanged, force", abs(f[0] + f[1]).max(), 1e-6)


def network(formulation):
    """A hammock of 25 masses on struts with dampers, corners fixed, carries a joint: finite, balanced, at last in
    equilibrium. A block of two bodies (a fixed joint between them) hangs in the middle by four struts."""
    deck = Deck("network", 4.0, 1e-3, 0.05)
    place = {10 * i + j + 100: (0.25 * i, 0.25 * j, 0.0) for i in range(5) for j in range(5)}
    body = {1: (0.5, 0.5, -0.3), 2: (0.5, 0.5, -0.6)}
    for b, x in body.items():
        place[b] = x
        for n, r in enumerate([(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0)], 1):
            place[10 * b + n] = (x[0] + r[0], x[1] + r[1], -0.45 + r[2])
    for n, (dx, dy) in enumerate([(0.05, 0.05), (-0.05, 0.05), (0.05, -0.05), (-0.05, -0.05)], 1):
        place[30 + n] = (0.5 + dx, 0.5 + dy, -0.3)
    deck.nodes(*place.items())
    ids = iter(range(1000, 2000))
    net = [(next(ids), 10 * i + j + 100, 10 * k + m + 100) for i in range(5) for j in range(5)
           for k, m in ((i + 1, j), (i, j + 1)) if k < 5 and m < 5]
    hangers = [(next(ids), 30 + n, 100 + 10 * i + j) for n, (i, j) in enumerate([(3, 3), (1, 3), (3, 1), (1, 1)], 1)]
    deck.block("/PROP/TYPE4/1", "strut", reals(0.02), *law(8e3, 400.0))
    deck.part(1, *net, *hangers)
    edge = [n for n in place if n >= 100 and ((n // 10) % 10 in (0, 4) or n % 10 in (0, 4))]
    deck.fix(*edge[:8])
    deck.fix(*edge[8:])
    for n in place:
        if n >= 100:
            deck.mass(n, 0.2)
    deck.block("/SKEW/MOV/1", "s", ints(11, 12, 13))
    deck.block("/SKEW/MOV/2", "s", ints(21, 22, 23))
    deck.block("/PROP/KJOINT/2", "weld", ints(8, 0), ints(1, 2) + reals(0.0, 0.5), reals(1e5))
    deck.part(2, (5, 11, 21))
    deck.body(1, 3.0, (0.02, 0.02, 0.02), 11, 12, 13, 31, 32, 33, 34)
    deck.body(2, 2.0, (0.02, 0.02, 0.02), 21, 22, 23)
    deck.titled("/GRAV", f"{0:10d}{'Z':>10}{0:10d}{0:10d}{deck.group(1, 2):10d}{0:10d}" + reals(1.0, -9.81))
    deck.history([111, 122], [s[0] for s in hangers] + [5])
    deck.titled("/TH/RBODY", "DEF", ints(0))
    run = deck.run(formulation)
    check(f"{formulation} network: energy", abs(run["energy_error"][:]).max(), 1e-4 if formulation == "consistent" else 5e-2)
    speed = np.linalg.norm(run["rigid_body/velocity"][-1], axis=1)
    check(f"{formulation} network: at rest", speed.max(), 1e-3)
    # at rest the weld carries the lower body, the hangers both
    weld = run["joint/force"][-1, 0]
    check(f"{formulation} network: weld carries 2 kg", abs(np.linalg.norm(weld) - 2.0 * 9.81), 1e-3)
    x = {n: run["node/position"][-1, i] for i, n in enumerate(run["node/node"][:])}
    assert x[122][2] < 0.0
    f = run["spring/force"][-1, :, 0]
    check(f"{formulation} network: hangers equal", np.ptp(f), 1e-6)
    top = x[111]
    foot = run["rigid_body/position"][-1, 0] + np.array([-0.05, -0.05, 0.0])
    lift = 4 * f[0] * (top - foot)[2] / np.linalg.norm(top - foot)
    # and half of their own mass, which sits on the block
    check(f"{formulation} network: hangers carry 5.04 kg", abs(lift - 5.04 * 9.81), 1e-3)


def limits():
    """kjoint check: the safe step of the oscillator is 2/w; of two masses on one spring 2/sqrt(K/m1 + K/m2)"""
    deck, _ = single("oscillator", law(K))
    deck.run("consistent")
    text = subprocess.run([KJOINT, "check", WORK / "oscillator_0000.rad", "--json"], check=True, capture_output=True,
                          text=True).stdout
    report = json.loads(text)
    check("safe step of an oscillator", abs(report["safe_step"] - 2.0 / W), 1e-9)
    check("exact step of an oscillator", abs(report["exact_step"] - 2.0 / W), 1e-9)


for formulation in ("consistent", "legacy"):
    oscillators(formulation)
    gap(formulation)
    inelastic(formulation)
    skewed(formulation)
    torsion(formulation)
    bushings(formulation)
    network(formulation)
limits()
sys.exit(1 if failed else 0)
