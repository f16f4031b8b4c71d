"""Mechanisms as decks, for test_compliant.py and tools/bench: kg, m, s.

Rods are thin and uniform; the ends of a joint are nodes of the two bodies with the same axes.
"""
import pathlib

import numpy as np

SPHERICAL, REVOLUTE, CYLINDRICAL, PLANAR, UNIVERSAL, TRANSLATIONAL, OLDHAM, RIGID = range(1, 9)
FREE = dict(zip(range(1, 9), (3, 1, 2, 3, 2, 1, 2, 0)))     # free directions


def ids(*numbers):
    return "".join(f"{n:10d}" for n in numbers)


def reals(*numbers):
    return "".join(f"{x:20.13g}" for x in numbers)


class Scene:
    def __init__(self, kn=1e7, cr=0.05, gravity=(1, -9.81), length="m"):
        """length: the unit that the deck is written in; all that is given here is in m"""
        self.kn, self.cr, self.gravity, self.unit = kn, cr, gravity, length
        self.size = {"m": 1.0, "dm": 10.0, "mm": 1000.0}[length]
        self.nodes, self.members, self.cards, self.skews, self.joints = [], [], [], 0, 0
        self.held, self.free = [], []
        self.bodies, self.links = [], []             # as they were given, for tools/bench_mechanisms.py

    def node(self, x):
        self.nodes.append(tuple(x))
        return len(self.nodes)

    def body(self, x, mass, inertia, velocity=None, spin=None, held=False):
        """inertia: xx yy zz xy yz xz, as /RBODY has them"""
        inertia = tuple(inertia) + (0.0,) * (6 - len(inertia))
        main = self.node(x)
        self.members.append((main, [], mass, inertia))
        (self.held if held else self.free).append(main)
        number = len(self.members)
        speed = [*(velocity if velocity is not None else (0, 0, 0)), *(spin if spin is not None else (0, 0, 0))]
        self.bodies.append({"x": np.array(x, float), "mass": mass, "inertia": inertia, "speed": speed, "held": held})
        if velocity is not None:
            self.cards.append(f"/INIVEL/TRA/{2*number - 1}\nv\n{reals(*self.size * np.array(speed[:3]))}{ids(number + 1000)}")
            self.cards.append(f"/INIVEL/ROT/{2*number}\nw\n{reals(*speed[3:])}{ids(number + 1000)}")
            self.cards.append(f"/GRNOD/NODE/{number + 1000}\nmain\n{ids(main)}")
        return number

    def rod(self, a, b, mass=1.0, **motion):
        """A thin rod from a to b"""
        a, b = np.array(a, float), np.array(b, float)
        d = b - a
        j = mass / 12 * (d @ d * np.eye(3) - np.outer(d, d)) + 1e-4 * mass * np.outer(d, d)
        return self.body((a + b) / 2, mass, (j[0, 0], j[1, 1], j[2, 2], j[0, 1], j[1, 2], j[0, 2]), **motion)

    def join(self, kind, body1, body2, x, axis=(1, 0, 0), law=(0, 0), second=None):
        """second: an axis across the first, anyone if left out; law: stiffness and damping of the one free direction"""
        x, e1 = np.array(x, float), np.array(axis, float) / np.linalg.norm(axis)
        e2 = np.cross(e1, [0, 0, 1] if abs(e1[2]) < 0.9 else [1, 0, 0]) if second is None else np.array(second, float)
        self.links.append({"kind": kind, "ends": (body1, body2), "x": x, "axis": e1, "law": law})
        ends = []
        for body in (body1, body2):
            triad = [self.node(x), self.node(x + 0.1 * e1), self.node(x + 0.1 * e2)]
            self.members[body - 1][1].extend(triad)
            self.skews += 1
            self.cards.append(f"/SKEW/MOV/{self.skews}\nskew\n{ids(*triad)}")
            ends.append(triad[0])
            if kind == UNIVERSAL:                # the other arm of the cross
                e1, e2 = e2, -e1
        self.joints += 1
        n = self.joints
        cards = [f"/PROP/KJOINT/{n}\njoint\n{ids(kind, 0)}", ids(2*n - 1, 2*n) + reals(0, self.cr)]
        free = FREE[kind]
        if kind == PLANAR:
            cards += [reals(self.kn, 0, 0) + ids(0, 0), reals(0) + ids(0), reals(0, 0, 0), ids(0, 0, 0)]
        elif free == 3:
            cards += [reals(self.kn, 0, 0, 0), ids(0, 0, 0), reals(0, 0, 0), ids(0, 0, 0)]
        else:
            none = free * [0]
            k, c = ([value, *none[1:]][:free] for value in law)
            cards += [reals(self.kn, *k) + ids(*none), reals(*c) + ids(*none)][:1 + min(free, 1)]
        self.cards += cards + [f"/PART/{n}\njoint\n{ids(n, 0, 0)}", f"/SPRING/{n}\n{ids(900 + n, *ends)}"]
        return n

    def drive(self, body, keyword, direction, points):
        """/IMPVEL, /IMPDISP or /IMPACC of the main node of a body, once a scene"""
        self.cards += ["/FUNCT/1\ntable\n" + "\n".join(reals(*point) for point in points),
                       f"/GRNOD/NODE/3001\nmain\n{ids(self.members[body - 1][0])}",
                       f"/{keyword}/1\nmotor\n{ids(1)}{direction:>10}{ids(0, 0, 3001, 0, 0)}\n{reals(1, 1, 0, 0)}"]

    def write(self, root, until, sample):
        out = ["#RADIOSS STARTER", "/BEGIN", pathlib.Path(root).name, ids(2022, 0),
               *2 * [f"{'kg':>20}{self.unit:>20}{'s':>20}"], "/NODE"]
        out += [ids(i) + reals(*self.size * np.array(x)) for i, x in enumerate(self.nodes, 1)]
        out += self.cards
        for n, (main, members, mass, inertia) in enumerate(self.members, 1):
            out += [f"/GRNOD/NODE/{n}", "members"]
            out += [ids(*members[i:i + 10]) for i in range(0, len(members), 10)]
            out += [f"/RBODY/{n}", f"body {n}", ids(main, 0, 0, 0) + reals(mass) + ids(n, 0, 3, 0),
                    *[reals(*self.size**2 * np.array(part)) for part in (inertia[:3], inertia[3:])], ids(0, 0)]
        for group, members in ((2001, self.held), (2002, self.free)):
            out += [f"/GRNOD/NODE/{group}", "group"]
            out += [ids(*members[i:i + 10]) for i in range(0, len(members), 10)]
        out += ["/BCS/1", "held", "   111 111" + ids(0, 2001)]
        if self.gravity:
            out += ["/GRAV/1", "gravity", f"{ids(0)}         {'XYZ'[self.gravity[0]]}{ids(0, 0, 2002)}"
                    f"          {reals(1, self.size * self.gravity[1])}"]
        out += ["/END"]
        pathlib.Path(f"{root}_0000.rad").write_text("\n".join(out) + "\n")
        pathlib.Path(f"{root}_0001.rad").write_text(
            f"/RUN/{pathlib.Path(root).name}/1\n{until}\n/TFILE/1\n{sample}\n/PRINT/-1000\n")


def bricard(kn=1e7, length="m"):
    """Five rods of 1 m and six hinges: a loop that moves although the count of its constraints says no"""
    scene = Scene(kn, length=length)
    p = [(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)]
    axes = [(0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)]
    bodies = [scene.body((0, 0, 0), 1, (1, 1, 1), held=True)]
    bodies += [scene.rod(a, b) for a, b in zip(p, p[1:])] + [bodies[0]]
    for k, (x, axis) in enumerate(zip(p, axes)):
        scene.join(REVOLUTE, bodies[k], bodies[k + 1], x, axis)
    return scene


def four_bars(n=2, kn=1e7, last=1.0):
    """n four-bar mechanisms in a row, links of 1 m and 1 kg, the first coupler moving at 1 m/s; the mass of
    the last link times `last`"""
    scene = Scene(kn)
    ground = scene.body((0, 0, 0), 1, (1, 1, 1), held=True)
    z = (0, 0, 1)
    uprights = [scene.rod((k, 0, 0), (k, 1, 0), last if k == n else 1.0, velocity=(0.5, 0, 0), spin=(0, 0, -1))
                for k in range(n + 1)]
    for k, rod in enumerate(uprights):
        scene.join(REVOLUTE, ground, rod, (k, 0, 0), z)
    for k in range(n):
        coupler = scene.rod((k, 1, 0), (k + 1, 1, 0), velocity=(1, 0, 0))
        scene.join(REVOLUTE, uprights[k], coupler, (k, 1, 0), z)
        scene.join(REVOLUTE, coupler, uprights[k + 1], (k + 1, 1, 0), z)
    return scene


def slider_crank(kn=2e7):
    """Crank 0.15 m, rod 0.4 m, slider on x"""
    scene = Scene(kn)
    ground = scene.body((0, 0, 0), 1, (1, 1, 1), held=True)
    pin = 0.15 * np.array([np.cos(np.pi/3), np.sin(np.pi/3), 0])
    end = np.array([pin[0] + np.sqrt(0.16 - pin[1]**2), 0, 0])
    w = 8.0
    v = w * np.array([-pin[1], pin[0], 0])
    turn = -v[1] / (end[0] - pin[0])
    slide = v[0] + turn * pin[1]
    z = (0, 0, 1)
    crank = scene.body(pin / 2, 0.8, (3e-2, 3e-2, 3e-2), velocity=v / 2, spin=(0, 0, w))
    rod = scene.body((pin + end) / 2, 1.0, (1.5e-4, 1.5e-2, 1.5e-2), velocity=(v + [slide, 0, 0]) / 2,
                     spin=(0, 0, turn))
    slider = scene.body(end, 1.5, (2e-3, 2e-3, 2e-3), velocity=(slide, 0, 0))
    scene.join(REVOLUTE, ground, crank, (0, 0, 0), z)
    scene.join(REVOLUTE, crank, rod, pin, z)
    scene.join(REVOLUTE, rod, slider, end, z)
    scene.join(TRANSLATIONAL, ground, slider, end, (1, 0, 0))
    return scene


def chain(n, kn=1e6, hubs=1):
    """n balls of 0.2 kg in a row on spherical joints, from each of `hubs` nodes of the ground"""
    scene = Scene(kn, gravity=(2, -9.81))
    ground = scene.body((0, 0, 0), 1, (1, 1, 1), held=True)
    for hub in range(hubs):
        last = ground
        for k in range(n // hubs):
            ball = scene.body((0.1 * k + 0.05, hub, 0), 0.2, (2e-5, 1.8e-4, 2e-4))
            scene.join(SPHERICAL, last, ball, (0.1 * k, hub, 0))
            last = ball
    return scene


def pair():
    """A body on a soft ball joint: few steps as it is"""
    scene = Scene(1e3)
    ground = scene.body((0, 0, 0), 1, (1, 1, 1), held=True)
    scene.join(SPHERICAL, ground, scene.body((0.5, 0, 0), 2.0, (0.2, 0.2, 0.2)), (0, 0, 0))
    return scene


def governor(kn=1e7):
    """Flyball governor: a shaft along y that turns with two arms, their balls, links, and a collar on a spring
    and damper; loops in a plane that turns, so every hinge is redundant"""
    scene = Scene(kn)
    ground = scene.body((0, 0, 0), 1, (1, 1, 1), held=True)
    spin, z = (0, 2 * np.pi, 0), (0, 0, 1)

    def turning(x, mass, inertia):
        return scene.body(x, mass, inertia, velocity=np.cross(spin, x), spin=spin)

    shaft = turning((0, 0.5, 0), 20.0, (1.5, 0.5, 1.5))
    collar = turning((0, 0, 0), 3.0, (0.05, 0.05, 0.05))
    scene.join(REVOLUTE, ground, shaft, (0, 1, 0), (0, 1, 0))
    scene.join(TRANSLATIONAL, shaft, collar, (0, 0, 0), (0, 1, 0), law=(1000.0, 100.0))
    for side in (1, -1):
        knee = np.array([0.5 * side, 0.5, 0])
        arm = turning(knee * [0.8, 1, 1] + [0, 0.1, 0], 5.0, (0.2, 0.2, 0.3))
        link = turning(knee / 2, 0.5, (0.02, 0.02, 0.04))
        scene.join(REVOLUTE, shaft, arm, (0, 1, 0), z)
        scene.join(REVOLUTE, arm, link, knee, z)
        scene.join(REVOLUTE, link, collar, (0, 0, 0), z)
    return scene


def shafts(kind, spin=10.0):
    """Two shafts along x, 0.05 m apart, under a coupling"""
    scene = Scene(2e6, gravity=None)
    ground = scene.body((0, 0, 0), 1, (1, 1, 1), held=True)
    ends = [scene.body((x, 0, off), 1.0, (0.002, 0.004, 0.004), velocity=(0, 0, 0), spin=(spin, 0, 0))
            for x, off in ((-0.1, 0), (0.1, 0.05))]
    for body, x, off in zip(ends, (-0.1, 0.1), (0, 0.05)):
        scene.join(REVOLUTE, ground, body, (x, 0, off), (1, 0, 0))
    scene.join(kind, *ends, (0, 0, 0), (1, 0, 0))
    return scene
