"""Decks with /PROP/KJOINT2 joints, written, run and read: what check_limits.py and check_kinds.py share.

One body (the first) is held unless told otherwise; the others hang from it by a joint each, all of one
property. The axes of the joints are those of the scene. Units: kg, m, s.
"""
import subprocess

import h5py
import numpy as np

SPHERICAL, REVOLUTE, CYLINDRICAL, PLANAR, UNIVERSAL, TRANSLATIONAL, OLDHAM, RIGID, FREE = range(1, 10)
FREE_DOFS = {SPHERICAL: 3, REVOLUTE: 1, CYLINDRICAL: 2, PLANAR: 3, UNIVERSAL: 2, TRANSLATIONAL: 1, OLDHAM: 2,
             RIGID: 0, FREE: 6}
SAMPLE = 0.002
failed = []


def check(name, value, limit):
    ok = value <= limit
    print(f"{'ok    ' if ok else 'FAILED'} {name:66s} {value:9.2e} <= {limit:7.1e}")
    if not ok:
        failed.append(name)


class Body:
    """What hangs from a joint at the origin: its centre, how it starts, its mass and inertia (three
    equal ones, or xx, yy, zz)."""

    def __init__(self, velocity=(0, 0, 0), spin=(0, 0, 0), centre=(0, 0, 0), mass=2.0, inertia=0.5):
        self.velocity, self.spin, self.centre = velocity, spin, centre
        self.mass, self.inertia = mass, inertia


def reals(*values):
    return "".join(f"{value:20.12g}" for value in values)


def ints(*values):
    return "".join(f"{value:10d}" for value in values)


def rows(numbers):
    """Cards of ten numbers each."""
    return [ints(*numbers[i:i + 10]) for i in range(0, len(numbers), 10)]


def dof(k=0.0, low=0.0, high=0.0, combined=0, c=0.0, stiffness=0.0, limit=0.0, f_limit=0):
    """The three cards of one direction."""
    return [reals(k) + ints(0) + reals(low, high) + ints(combined), reals(c) + ints(0),
            reals(stiffness, limit) + ints(f_limit)]


def joint(kind, dofs, kn=1e7, scf=0.0, cr=1e-9, sensor=0, skews=(0, 0)):
    """/PROP/KJOINT2; cr is next to nothing where the energy is looked at."""
    cards = [card for d in dofs for card in d]
    cards += dof() * (FREE_DOFS[kind] - len(dofs))
    return ["/PROP/KJOINT2/1", "joint", ints(kind) + reals(kn, scf, cr) + ints(sensor, *skews)] + cards


def rbody(number, main, secondaries, mass, inertia):
    return ([f"/GRNOD/NODE/{1000 + number}", "nodes", *rows(secondaries), f"/RBODY/{number}", "body",
             ints(main, 0, 0, 3) + reals(mass) + ints(1000 + number, 0, 3, 0), reals(*np.broadcast_to(inertia, 3)),
             reals(0.0, 0.0, 0.0), ints(0, 0)])


def starter(bodies, prop, gravity=0.0, extra=(), ground=None, apart=(0, 0, 0), springs=None):
    """The starter deck. ground: body 1, where it is not held; apart: from end 1 to end 2 of the joints;
    springs: numbers of the joints of the bodies, in the order in which the deck lists them."""
    springs = springs or [901 + i for i in range(len(bodies))]
    lines = ["#RADIOSS STARTER", "/BEGIN", "limits", ints(2022, 0),
             f"{'kg':>20s}{'m':>20s}{'s':>20s}", f"{'kg':>20s}{'m':>20s}{'s':>20s}", "/NODE"]
    points = [(100, ground.centre if ground else (-1.0, 0.0, 0.0)), (102, (1.0, 0.0, 0.0)), (103, (0.0, 1.0, 0.0))]
    for i, body in enumerate(bodies):
        points += [(200 + 10 * i, body.centre), (101 + 10 + i, (0, 0, 0)), (201 + 10 * i, apart)]
    lines += [ints(number) + reals(*point) for number, point in points]
    mass, inertia = (ground.mass, ground.inertia) if ground else (1000.0, 1000.0)
    lines += rbody(1, 100, [102, 103, *(111 + i for i in range(len(bodies)))], mass, inertia)
    lines += prop + list(extra) + ["/PART/1", "joints", ints(1, 0, 0), "/SPRING/1"]
    lines += [ints(number, 111 + number - 901, 201 + 10 * (number - 901), 102, 103) for number in springs]
    for i, body in enumerate(bodies):
        lines += rbody(2 + i, 200 + 10 * i, [201 + 10 * i], body.mass, body.inertia)
        lines += motion(200 + 10 * i, 2000 + i, body)
    if ground:
        lines += motion(100, 1900, ground)
    else:
        lines += ["/GRNOD/NODE/1900", "held", ints(100), "/BCS/1", "held", "   111 111" + ints(0, 1900)]
    if gravity:
        lines += ["/GRNOD/NODE/1901", "all", *rows([200 + 10 * i for i in range(len(bodies))]), "/GRAV/1",
                  "gravity", ints(0) + f"{'Z':>10s}" + ints(0, 0, 1901) + " " * 10 + reals(0.0, -gravity)]
    lines += ["/TH/SPRING/1", "joints", "DEF", *(ints(number) for number in springs),
              "/TH/RBODY/2", "bodies", "DEF", *(ints(n) for n in range(1 if ground else 2, 2 + len(bodies))), "/END"]
    return "\n".join(lines) + "\n"


def motion(node, group, body):
    """How a body starts."""
    lines = [f"/GRNOD/NODE/{group}", "main node", ints(node)]
    for n, (kind, v) in enumerate((("TRA", body.velocity), ("ROT", body.spin))):
        lines += [f"/INIVEL/{kind}/{2 * node + n}", "start", reals(*v) + ints(group, 0)]
    return lines


def engine(end, dt_max=0.0):
    lines = ["/RUN/limits/1", str(end), "/TFILE/1", str(SAMPLE), "/VERS/2022", "/DT/NODA", "0.9 0.0"]
    if dt_max:
        lines += ["/DTIX", f"{dt_max} {dt_max}"]
    return "\n".join(lines + ["/END"]) + "\n"


class Scene:
    """Writes decks, runs them, gives histories."""

    def __init__(self, kjoint, work):
        self.kjoint, self.work = kjoint, work

    def launch(self, name, deck, end, dt_max, options):
        root = self.work / name
        root.with_name(f"{name}_0000.rad").write_text(deck)
        root.with_name(f"{name}_0001.rad").write_text(engine(end, dt_max))
        return self.start(f"{root}_0000.rad", f"{root}.h5", options)

    def start(self, deck, history, options):
        return subprocess.run([self.kjoint, "run", deck, "-q", "-o", history, *options], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, check=False)

    def run(self, name, deck, end, dt_max=0.0, options=()):
        done = self.launch(name, deck, end, dt_max, options)
        if done.returncode != 0:
            raise SystemExit(f"{name}: {done.stdout}")
        file = h5py.File(self.work / f"{name}.h5")
        if "--legacy" in options:
            return file
        check(f"{name}: ledger", abs(file["energy_error"][:]).max(), 2e-4)
        if "friction_energy" in file["joint"]:
            taken = file["joint/friction_energy"][:]
            check(f"{name}: friction never gives back [J]", -min(0.0, np.diff(taken, axis=0).min()), 0.0)
        return file


def energy(file):
    return (file["kinetic_energy_trans"][:] + file["kinetic_energy_rot"][:] + file["internal_energy"][:] +
            file["potential_energy"][:])
