#!/usr/bin/env python3
"""Decks of any size to measure kjoint with.

usage: bench_scenes.py SCENE JOINTS ROOT [--until T] [--sample DT]

chain    bodies in a row on spherical joints, the first on a fixed body
forest   pendulums on revolute joints with a spring, all on one fixed body
apart    the same, each on a fixed body of its own
grid     a square sheet of bodies, each joined to its right and upper neighbour: closed loops
mix      rows of nine bodies with a joint of every type, all on one fixed body

Every joint has a property, a part and two moving skews of its own, as decks of pre-processors have.
Units kg m s. Writes ROOT_0000.rad and ROOT_0001.rad; histories hold all joints and bodies.
"""
import argparse
import itertools

# cards after the skews of each type (kjoint list joints), columns as docs of TYPE33
KN = 1.0e6
TYPES = {
    "spherical": (1, [[KN, 0, 0, 0], (0, 0, 0), [0, 0, 0], (0, 0, 0)]),
    "revolute": (2, [[KN, 40], [0.05]]),
    "cylindrical": (3, [[KN, 20, 0.1], [0.2, 0.0005]]),
    "planar": (4, [[KN, 50, 50], [0.1], [0, 0, 0], (0, 0, 0)]),
    "universal": (5, [[KN, 0.1, 0.1], [0, 0]]),
    "translational": (6, [[KN, 50], [2]]),
    "oldham": (7, [[KN, 50, 50], [0, 0]]),
    "rigid": (8, [[KN]]),
    "free": (9, [[5e3, 5e3, 5e3], [8, 8, 8], (0, 0, 0), (0, 0, 0), [1, 1, 1], [0, 0, 0], (0, 0, 0), (0, 0, 0)]),
}


def ids(*numbers):
    return "".join(f"{n:10d}" for n in numbers)


def reals(*numbers):
    return "".join(f"{x:20.12g}" for x in numbers)


class Scene:
    """Cards of a deck as they come"""

    def __init__(self):
        self.nodes, self.joints, self.bodies, self.free = [], [], [], []

    def node(self, x, y, z):
        self.nodes.append((x, y, z))
        return len(self.nodes)

    def triad(self, x, y, z):
        """An end of a joint: node, node along x, node in the plane of x and y"""
        return [self.node(x, y, z), self.node(x + 0.05, y, z), self.node(x, y + 0.05, z)]

    def body(self, x, y, z, ends, mass, inertia, free=True):
        main = self.node(x, y, z)
        self.bodies.append((main, [n for end in ends for n in end], mass, inertia))
        if free:
            self.free.append(main)

    def join(self, kind, end1, end2):
        self.joints.append((kind, end1, end2))


def chain(scene, n):
    ends = [scene.triad(0, 0, 0)]
    scene.body(0, 0, 0, ends, 5.0, (1, 1, 1), free=False)
    last = ends[0]
    for k in range(n):
        left, right = scene.triad(0.1*k, 0, 0), scene.triad(0.1*k + 0.1, 0, 0)
        scene.body(0.1*k + 0.05, 0, 0, [left, right], 0.2, (2e-5, 1.8e-4, 2e-4))
        scene.join("spherical", last, left)
        last = right


def forest(scene, n):
    feet = [scene.triad(2.0*(k % 100), 2.0*(k//100), 0) for k in range(n)]
    scene.body(0, 0, 0, feet, 1e6, (1e9, 1e9, 1e9), free=False)
    for k, foot in enumerate(feet):
        x, y, z = scene.nodes[foot[0] - 1]
        top = scene.triad(x, y, z)
        scene.body(x + 0.35, y + 0.1, z - 0.05, [top], 2.0, (0.0263, 0.0473, 0.0564))
        scene.join("revolute", foot, top)


def apart(scene, n):
    for k in range(n):
        x, y = 2.0*(k % 100), 2.0*(k//100)
        foot, top = scene.triad(x, y, 0), scene.triad(x, y, 0)
        scene.body(x, y, 0, [foot], 1e3, (1e3, 1e3, 1e3), free=False)
        scene.body(x + 0.35, y + 0.1, -0.05, [top], 2.0, (0.0263, 0.0473, 0.0564))
        scene.join("revolute", foot, top)


def grid(scene, n):
    side = max(2, round((n/2)**0.5))
    ends = {}
    for i, j in itertools.product(range(side), range(side)):
        at = (0.1*i, 0.1*j, 0.0)
        ends[i, j] = [scene.triad(at[0] + dx, at[1] + dy, 0) for dx, dy in
                      ((0.05, 0), (-0.05, 0), (0, 0.05), (0, -0.05))]
        scene.body(*at, ends[i, j], 0.2, (1.8e-4, 2e-4, 3.6e-4), free=i > 0)
    for i, j in ends:
        if i + 1 < side:
            scene.join("universal", ends[i, j][0], ends[i + 1, j][1])
        if j + 1 < side:
            scene.join("spherical", ends[i, j][2], ends[i, j + 1][3])


def mix(scene, n):
    kinds = list(TYPES)
    rows = max(1, n//len(kinds))
    feet = [scene.triad(0, 1.0*row, 0) for row in range(rows)]
    scene.body(0, 0, 0, feet, 1e6, (1e9, 1e9, 1e9), free=False)
    for row, last in enumerate(feet):
        for k, kind in enumerate(kinds):
            left, right = scene.triad(0.1*k, row, 0), scene.triad(0.1*k + 0.1, row, 0)
            scene.body(0.1*k + 0.05, row, 0, [left, right], 0.2, (2e-5, 1.8e-4, 2e-4))
            scene.join(kind, last, left)
            last = right


SCENES = {"chain": chain, "forest": forest, "apart": apart, "grid": grid, "mix": mix}


def property_cards(number, kind):
    row, cards = TYPES[kind]
    yield f"/PROP/KJOINT/{number}\n{kind}\n{ids(row, 0)}"
    yield ids(2*number - 1, 2*number) + reals(0, 0.05)
    for card in cards:
        yield ids(*card) if isinstance(card, tuple) else reals(*card)


def deck(name, scene):
    """Lines of the starter deck"""
    yield f"#RADIOSS STARTER\n/BEGIN\n{name}\n{ids(2022, 0)}"
    yield ("                  kg                   m                   s\n"*2).rstrip("\n")
    yield f"/TITLE\n{name}\n/NODE"
    for number, at in enumerate(scene.nodes, 1):
        yield ids(number) + reals(*at)
    for number, (kind, end1, end2) in enumerate(scene.joints, 1):
        if kind == "universal":                      # the axis on body 2 is x of its skew
            end2 = [end2[0], end2[2], end2[1]]
        for skew, end in ((2*number - 1, end1), (2*number, end2)):
            yield f"/SKEW/MOV/{skew}\nskew\n{ids(*end)}"
        yield from property_cards(number, kind)
        yield f"/PART/{number}\n{kind} {number}\n{ids(number, 0, 0)}"
        yield f"/SPRING/{number}\n{ids(number, end1[0], end2[0])}"
    for number, (main, members, mass, inertia) in enumerate(scene.bodies, 1):
        yield f"/GRNOD/NODE/{number}\nmembers"
        for at in range(0, len(members), 10):
            yield ids(*members[at:at + 10])
        yield f"/RBODY/{number}\nbody\n{ids(main, 0, 0, 0)}{reals(mass)}{ids(number, 0, 3, 0)}"
        yield f"{reals(*inertia)}\n{reals(0, 0, 0)}\n{ids(0, 0)}"
    groups = len(scene.bodies)
    fixed = sorted({main for main, *_ in scene.bodies} - set(scene.free))
    for group, members in ((groups + 1, fixed), (groups + 2, scene.free)):
        yield f"/GRNOD/NODE/{group}\ngroup"
        for at in range(0, len(members), 10):
            yield ids(*members[at:at + 10])
    yield f"/BCS/1\nfixed\n   111 111{ids(0, groups + 1)}"
    yield f"/GRAV/1\ngravity\n{ids(0)}         Z{ids(0, 0, groups + 2)}          {reals(1, -9.81)}"
    yield "/END"


def write(kind, joints, root, until=1.0, sample=0.01):
    """Write both decks and return the number of joints, which a grid or a mix may round"""
    scene = Scene()
    SCENES[kind](scene, joints)
    with open(f"{root}_0000.rad", "w") as out:
        out.writelines(line + "\n" for line in deck(f"{kind}{joints}", scene))
    with open(f"{root}_0001.rad", "w") as out:
        out.write(f"/RUN/{kind}{joints}/1\n{until}\n/TFILE/1\n{sample}\n/PRINT/-1000\n")
    return len(scene.joints)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("joints", type=int)
    parser.add_argument("root")
    parser.add_argument("--until", type=float, default=1.0)
    parser.add_argument("--sample", type=float, default=0.01)
    given = parser.parse_args()
    print(write(given.scene, given.joints, given.root, given.until, given.sample), "joints")
