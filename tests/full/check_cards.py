#!/usr/bin/env python3
"""Cards of full decks, each in a small deck of its own: what they do to a body, and what is said of them.

usage: check_cards.py KJOINT

The body of most decks is a square shell of 2 x 2 at z = 0, thickness 0.5, density 3: mass 6, centre (1, 1, 0)."""
import json
import pathlib
import subprocess
import sys
import tempfile

UNITS = f"{'kg':>20}{'m':>20}{'s':>20}\n"
ENGINE = "/RUN/deck/1\n0.1\n/TFILE/1\n0.05\n/DT/NODA\n0.9 0\n"


def real(*values):
    return "".join(f"{v:20.9g}" for v in values)


def ints(*values):
    return "".join(f"{v:10d}" for v in values)


def node(number, *x):
    return ints(number) + real(*x) + "\n"


SQUARE = node(1, 0, 0, 0) + node(2, 2, 0, 0) + node(3, 2, 2, 0) + node(4, 0, 2, 0)
# a second shell beside it, of part 2, which belongs to no body
BESIDE = node(5, 4, 0, 0) + node(6, 4, 2, 0)


def deck(more="", version=2022, units=2*UNITS, rho=real(3.0), prop=None, body=None, nodes="", group=None, mat="/MAT/LAW1/1"):
    prop = prop or "/PROP/SHELL/1\nshell\n" + ints(24) + "\n\n" + ints(3, 0) + real(0.5) + "\n"
    body = body or ("/RBODY/1\nbody\n" + ints(100, 0, 0, 0) + real(0) + ints(1, 0, 1, 0) + "\n\n\n")
    return (f"/BEGIN\ndeck\n{version:10d}         0\n{units}" + nodes + more + "/NODE\n" + SQUARE + node(100, 1, 1, 1)
            + f"{mat}\nm\n{rho}\n" + real(210, 0.3) + "\n" + prop + "/PART/1\np\n" + ints(1, 1, 0) + "\n"
            + "/SHELL/1\n" + ints(1, 1, 2, 3, 4) + "\n" + (group or "/GRNOD/PART/1\ng\n" + ints(1) + "\n") + body + "/END\n")


PARTNER = ("/NODE\n" + BESIDE + node(200, 9, 9, 9) + node(201, 9, 9, 8) + node(202, 9, 8, 9) + "/PART/2\nq\n" + ints(1, 1, 0)
           + "\n/SHELL/2\n" + ints(2, 2, 5, 6, 3) + "\n/GRNOD/NODE/50\nof the body\n" + ints(1, 2, 3) + "\n/GRNOD/NODE/51\nof none\n"
           + ints(200, 201, 202) + "\n/GRNOD/NODE/52\nits main node\n" + ints(100) + "\n/SURF/PART/60\ns\n" + ints(1)
           + "\n/SURF/SEG/61\ns\n" + ints(1, 200, 201, 202) + "\n/LINE/SURF/62\nl\n" + ints(60) + "\n/LINE/SEG/63\nl\n"
           + ints(1, 200, 201) + "\n")


class Checks:
    def __init__(self, kjoint, work):
        self.kjoint, self.work, self.n, self.wrong = kjoint, pathlib.Path(work), 0, 0

    def extract(self, text, *options, engine=ENGINE, files=()):
        for name, content in (("full_0000.rad", text), ("full_0001.rad", engine), *files):
            (self.work/name).unlink(missing_ok=True)
            if content is not None:
                (self.work/name).write_text(content)
        for path in self.work.glob("mech*"):
            path.unlink()
        done = subprocess.run([self.kjoint, "extract", self.work/"full_0000.rad", "-o", self.work/"mech_0000.rad", "--json",
                               *options], capture_output=True, text=True, check=False)
        return json.loads(done.stdout)

    def check(self, name, right, told):
        self.n += 1
        self.wrong += not right
        if not right:
            print(f"FAIL  {name}: {told}")

    def body(self, name, text, mass, centre, *options, **files):
        """The body has this mass and centre, and the deck that is written gives it again."""
        said = self.extract(text, *options, **files)
        bodies = said.get("bodies", [])
        told = [said["exit_code"], bodies, said["findings"]]
        right = said["exit_code"] == 0 and len(bodies) == 1
        right = right and abs(bodies[0]["mass"] - mass) < 1e-12*mass
        self.check(name, right and max(abs(a - b) for a, b in zip(bodies[0]["centre"], centre)) < 1e-12*10, told)

    def says(self, name, text, severity, number, line=None, *options):
        """There is a finding with this id, and none when number is ''."""
        said = self.extract(text, *options)["findings"]
        found = [f for f in said if f["id"] == number and f["severity"] == severity]
        right = bool(found) if severity else all(f["id"] != number for f in said)
        self.check(name, right and (line is None or found[0]["line"] == line), said)


def masses(c):
    c.body("as it is", deck(), 6, (1, 1, 0))
    c.body("single units", deck("/UNIT/MASS/7\nu\n" + f"{'g':>20}\n/UNIT/LENGTH/7\nu\n{'cm':>20}\n", mat="/MAT/LAW1/1/7",
                                rho=real(3e-3)), 6, (1, 1, 0))                # 3 kg/m^3 = 3e-3 g/cm^3
    c.body("units in headers", deck("/UNIT/MASS/kg\n/UNIT/LENGTH/m\n/UNIT/TIME/s\n", version=90, units=""), 6, (1, 1, 0))
    c.body("a rigid part", deck(version=2612, body="#\n", group="#\n").replace(
        ints(1, 1, 0) + "\n", ints(1, 1, 0) + real(0) + ints(1) + "\n" + ints(100, 0) + real(2.0) + "\n" + real(1, 1, 1) + "\n\n"),
        8, (1, 1, 0.25))                                                      # 2 more on the main node at z = 1
    c.body("a main node that is made", deck(body="/RBODY/1\nbody\n" + ints(0, 0, 0, 0) + real(2) + ints(1, 0, 1, 0)
                                           + "\n" + real(1, 1, 1) + "\n\n"), 8, (0.75, 0.75, 0))   # 2 at the origin
    c.says("disturbed coordinates", deck("/RANDOM\n" + real(0.01, 0.5) + "\n"), "error", "KJ-9149", 7)
    c.body("disturbed coordinates, ignored", deck("/RANDOM\n" + real(0.01, 0.5) + "\n"), 6, (1, 1, 0), "--ignore-random")
    c.body("undisturbed coordinates", deck("/RANDOM\n" + real(0, 0.5) + "\n"), 6, (1, 1, 0))


def moves(c):
    group = "/GRNOD/GENE/5\nn\n" + ints(1, 4) + "\n"

    def move(kind, *cards):
        return deck(nodes=group + f"/TRANSFORM/{kind}/1\nt\n" + "\n".join(cards) + "\n")
    gap = 10*" "
    # mirrored at x = 3: 1 becomes 5
    c.body("SYM", move("SYM", ints(5) + real(3, 0, 0), gap + real(4, 0, 0)), 6, (5, 1, 0))
    c.body("SYM at nodes", move("SYM", ints(5) + real(0, 0, 0) + ints(2, 5), gap + real(0, 0, 0)).replace(
        "/GRNOD/GENE/5", "/NODE\n" + node(5, 4, 0, 0) + "/GRNOD/GENE/5"), 6, (3, 1, 0))   # at x = 2
    # x becomes y, y becomes -x, the origin (5, 6, 7)
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (5, 6, 7), (5, 7, 7), (4, 6, 7)]
    c.body("POSITION", move("POSITION", ints(5, 0, 0, 0, 0, 0, 0), *(gap + real(*p) for p in points)), 6, (4, 7, 7))
    # the points need not stand at right angles or as far apart: the same turn
    points[2], points[4], points[5] = (1, 2, 0), (5, 9, 7), (3, 7, 7)
    c.body("POSITION, skew points", move("POSITION", ints(5, 0, 0, 0, 0, 0, 0), *(gap + real(*p) for p in points)), 6, (4, 7, 7))
    c.body("TRA, then SCA", deck(nodes=group + "/TRANSFORM/TRA/1\nt\n" + ints(5) + real(1, 0, 0) + "\n/TRANSFORM/SCA/2\nt\n"
                                + ints(5) + real(2, 1, 1) + "\n"), 12, (4, 1, 0))          # ((1 + 1) 2, 1, 0)


def parameters(c):
    def give(kind, name, value, scope="GLOBAL"):
        return f"/PARAMETER/{scope}/{kind}/1\np\n{name:10}{value}\n"
    t = "/PROP/SHELL/1\nshell\n" + ints(24) + "\n\n" + ints(3, 0) + "{:>20}\n"
    c.body("REAL", deck(give("REAL", "t", real(0.25)), prop=t.format("&t")), 3, (1, 1, 0))
    c.body("a minus", deck(give("REAL", "t", real(-0.25)), prop=t.format("-&t")), 3, (1, 1, 0))
    c.body("INTEGER", deck(give("INTEGER", "layout", ints(24)), prop=t.format("0.5").replace(ints(24), f"{'&layout':>10}")),
           6, (1, 1, 0))
    c.body("expressions", deck(give("REAL_EXPR", "t", "2*sqrt(w)/10^n - 0.15") + give("REAL", "w", real(4)) +
                               give("INT_EXPR", "n", "3 - 2"), prop=t.format("&t")), 3, (1, 1, 0))      # 0.4 - 0.15
    c.body("an expression of two cards", deck(give("REAL_EXPR", "t", "0.5*\n0.5"), prop=t.format("&t")), 3, (1, 1, 0))
    # a name ends its field, begins it or stands in it: longer values go where the field is
    third = give("REAL_EXPR", "t", "1/3")
    for where in (f"{'&t':>20}", f"{'&t':20}", f"{'&t':>8}"):
        c.body(f"in its field: {where}", deck(third, prop=t.format("").rstrip() + where + real(1) + "\n"), 4, (1, 1, 0))
    c.body("defined behind", deck(prop=t.format("&t"), group="/GRNOD/PART/1\ng\n" + ints(1) + "\n" + give("REAL", "t", real(0.25))),
           3, (1, 1, 0))
    # in the included file t is its own 0.25, outside it is 1.0; the shell is described inside
    inside = ("inside.inc", give("REAL", "t", real(0.25), "LOCAL") + t.format("&t"))
    outside = give("REAL", "t", real(1)) + "/ADMAS/0/1\nmain node\n{:>20}".format("&t") + ints(9) + "\n/GRNOD/NODE/9\nn\n" + ints(100) + "\n"
    c.body("LOCAL", deck(outside, prop="#include inside.inc\n"), 4, (1, 1, 0.25), files=[inside])       # 3, and 1 at z = 1
    c.body("LOCAL in a submodel", deck(outside, prop="//SUBMODEL/1\ns\n" + ints(0, 0, 0, 0, 0, 0, 0) + "\n" + inside[1]
                                       + "//ENDSUB\n"), 4, (1, 1, 0.25))
    two = deck(give("REAL", "t", real(9)) + give("REAL", "rho", real(9)), prop=t.format("&t"), rho=f"{'&rho':>20}")
    c.body("--set a,b", two, 3, (1, 1, 0), "--set", "t=0.25,rho=3")
    c.body("--set a --set b", two, 3, (1, 1, 0), "--set", "t=0.25", "--set", "rho=3")
    c.says("--set beyond a real", two, "error", "KJ-9404", 8, "--set", "t=1e400")
    # 25 digits of a quarter: as long as a number may be; the card keeps its columns
    c.body("--set longer than a field", deck(give("REAL", "t", real(9)), prop=t.format("&t" + 18*" ") + "\n"), 3, (1, 1, 0), "--set",
           "t=0.25" + 23*"0")
    narrow = deck(give("REAL", "i", real(9)), prop=t.format("0.5").replace(ints(24), f"{'&i':>10}" + ints(1)))
    c.says("--set without room", narrow, "error", "KJ-9404", narrow.split("&i")[0].count("\n") + 1, "--set", "i=24.000000000")
    c.says("--set of no parameter", two, "error", "KJ-9407", None, "--set", "z=1")
    c.says("nothing reads it", deck(give("REAL", "t", real(9))), "warning", "KJ-9406", 8)
    c.says("in a circle", deck(give("REAL_EXPR", "a", "b+1") + give("REAL_EXPR", "b", "a+1"), prop=t.format("&a")), "error",
           "KJ-9405", None)
    c.says("not defined", deck(prop=t.format("&u")), "error", "KJ-9015", 20)


def structure(c):
    one = deck().replace("/END\n", ENGINE + "/END/ENGINE\n")
    c.body("one file", one, 6, (1, 1, 0), engine=None)
    out = c.work/"one.h5"
    done = subprocess.run([c.kjoint, "run", c.work/"full_0000.rad", "--mechanism", "-q", "-o", out], capture_output=True, text=True,
                          check=False)
    c.check("one file runs", done.returncode == 0 and out.exists(), done.stderr)
    first = "#RADIOSS\n" + ENGINE + "/END/ENGINE\n" + deck()
    c.body("one file, the engine part first", first, 6, (1, 1, 0), engine=None)
    out.unlink(missing_ok=True)
    done = subprocess.run([c.kjoint, "run", c.work/"full_0000.rad", "--mechanism", "-q", "-o", out], capture_output=True, text=True,
                          check=False)
    c.check("it runs", done.returncode == 0 and out.exists(), done.stderr)
    c.says("a keyword in lower case", deck(PARTNER.replace("/SHELL/2", "/shell/2")), "warning", "KJ-9020")
    # free format: items in the place of columns, unused columns are one
    shell, prop = ints(1, 1, 2, 3, 4), ints(3, 0) + real(0.5)
    whole = "/RBODY/1\nbody\n" + ints(100, 0, 0, 0) + real(0) + ints(1, 0, 1, 0)
    for columns, items, mass in ((prop, "3,0,0.25", 3), (shell, "1,1,2,3,4,,,0.25", 3), (real(3.0), "6.,", 12),
                                 (whole, "/RBODY/1\nbody\n100,0,0,0,0,1,0,1,0", 6), ("/PART/1\np\n" + ints(1, 1, 0), "/PART/1\np\n1,1,0", 6)):
        c.body("free format: " + items, deck().replace(columns, items, 1), mass, (1, 1, 0))
    # a triangle typed as a shell of four: its third node has two of four quarters
    for fourth in (0, 3):
        c.body("a shell of three nodes", deck().replace(shell, ints(1, 1, 2, 3, fourth)), 3, (1.5, 1, 0))
    # the inner submodel has ids 1100 above its own; it turns about z after the outer one has moved with all that is in it
    inside = deck().split(UNITS)[2].replace("/END\n", "")
    nested = ("//SUBMODEL/1\nouter\n" + ints(1000) + "\n" + inside + "//SUBMODEL/2\ninner\n" + ints(100) + "\n" + inside
              + "//ENDSUB\n//ENDSUB\n/TRANSFORM/TRA/1\nt\n" + ints(0) + real(10, 0, 0) + ints(0, 0, 1) + "\n/TRANSFORM/ROT/2\nt\n"
              + ints(0) + real(0, 0, 0) + ints(0, 0, 2) + "\n" + 10*" " + real(0, 0, 1) + real(90) + "\n/END\n")
    said = c.extract(deck().split(UNITS)[0] + 2*UNITS + nested).get("bodies", [])
    told = [(b["id"], b["main_node"], round(b["mass"], 9), [round(x, 9) for x in b["centre"]]) for b in said]
    c.check("a submodel in a submodel", told == [(1001, 1100, 6, [11, 1, 0]), (1101, 1200, 6, [-1, 11, 0])], told)
    # TYPE4 with fct3 counts the functions up to it: 1 and 2 stay, though nothing names 1
    line = "/FUNCT/{0}\nf\n" + real(-1, -1) + "\n" + real(1, 1) + "\n"
    spring = ("/PROP/SPRING/9\ns\n" + real(1) + "\n" + real(1) + "\n" + ints(3, 4, 0, 2, 0) + "\n\n/PART/9\ns\n" + ints(9, 0, 0)
              + "\n/SPRING/9\n" + ints(9, 1, 200) + "\n/ADMAS/0/1\nm\n" + real(1) + ints(52) + "\n")
    c.extract(deck(PARTNER.replace("its main node\n" + ints(100), "a free node\n" + ints(200)) + spring
                   + "".join(line.format(k) for k in (1, 2, 3, 5))))
    text = (c.work/"mech_0000.rad").read_text() if (c.work/"mech_0000.rad").exists() else ""
    c.check("ranks of functions", [f"/FUNCT/{k}\n" in text for k in (1, 2, 3, 5)] == [True, True, True, False], text[-3000:])


def acts(c):
    """What acts on bodies is said, and nothing of what acts elsewhere."""
    def both(name, severity, number, block, *pairs):
        for k, what in enumerate(pairs):
            c.says(f"{name} {what}", deck(PARTNER + block.format(*what)), severity if k == 0 else None, number)
    i = "{:10d}"
    for kind in ("TYPE7", "TYPE5", "TYPE10"):
        both("contact " + kind, "warning", "KJ-9426", f"/INTER/{kind}/1\nc\n{i}{i}\n", (51, 60), (51, 61))
    for kind in ("TYPE3", "TYPE19", "TYPE25"):
        both("contact " + kind, "warning", "KJ-9426", f"/INTER/{kind}/1\nc\n{i}{i}\n", (61, 60), (61, 61))
    both("contact of lines", "warning", "KJ-9426", f"/INTER/TYPE11/1\nc\n{i}{i}\n", (63, 62), (63, 63))
    both("tie", "warning", "KJ-9426", f"/INTER/TYPE2/1\nc\n{i}{i}\n", (50, 61), (51, 61))
    both("wall", "warning", "KJ-9426", f"/RWALL/PLANE/1\nc\n         0         0{i}\n", (50,), (51,))
    both("airbag", "warning", "KJ-9426", f"/MONVOL/AIRBAG1/1\nc\n{i}\n", (60,), (61,))
    both("pressure", "warning", "KJ-9426", f"/PLOAD/1\nc\n{i}\n", (60,), (61,))
    both("centrifugal", "error", "KJ-9428", "/LOAD/CENTRI/1\nc\n" + 40*" " + i + "\n", (52,), (51,))
    both("damping", "warning", "KJ-9426", "/DAMP/1\nc\n" + real(0.1, 0) + i + "\n", (52,), (51,))
    both("nodes on a line", "warning", "KJ-9426", f"/CYL_JOINT/1\nc\n{i}{i}{i}\n", (200, 201, 50), (200, 201, 51))
    both("links of a main node", "error", "KJ-9428", "/RLINK/1\nc\n   111 111         0" + i + "\n", (52,), (50,))
    both("links", "warning", "KJ-9426", "/RLINK/1\nc\n   111 111         0" + i + "\n", (50,), (51,))
    both("interpolation", "error", "KJ-9428", f"/RBE3/1\nc\n{i}\n", (1,), (200,))
    both("gear", "error", "KJ-9428", "/GJOINT/GEAR/1\nc\n         0" + real(1, 0, 0) + i + i + i + "\n", (200, 100, 201), (200, 201, 202))
    both("particles", "warning", "KJ-9426", f"/SPHCEL/2\n{i}{i}\n{i}{i}\n", (1, 200, 2, 1), (1, 200, 2, 201))
    both("rivets", "warning", "KJ-9426", f"/RIVET/2\n{i}{i}{i}\n", (1, 200, 1), (1, 200, 201))
    both("reference mesh", "warning", "KJ-9426", f"/XREF/{{}}\nc\n         0\n", (1,))
    both("initial velocities", "error", "KJ-9428", f"/INIVEL/NODE/1\nv\n{i}{i}\n", (100, 0), (200, 0))
    c.says("springs that start with a force", deck("/INISPRI/FULL\n"), "warning", "KJ-9426")
    c.says("motion to a final geometry", deck("/IMPDISP/FGEO/1\nf\n"), "warning", "KJ-9426")
    c.says("merged bodies", deck("/MERGE/RBODY/1\nm\n" + ints(1, 1, 1, 1, 0) + "\n"), "error", "KJ-9428")
    c.says("plane elements", deck("/QUAD/1\n" + ints(9, 1, 2, 3, 4) + "\n"), "error", "KJ-9428")
    c.says("parts that are rigid", deck(mat="/MAT/LAW13/1"), "error", "KJ-9428")
    c.says("a mass that is not known", deck(mat="/MAT/LAW51/1"), "error", "KJ-9427")
    c.says("coupling of some directions", deck("/RBE2/5\nr\n" + ints(200) + "   111 000         0" + ints(51) + "\n" + PARTNER), "error", "KJ-9413")
    c.says("a body that a sensor makes later", deck("/SENSOR/TIME/3\ns\n" + real(0.5) + "\n", body="/RBODY/1\nbody\n" + ints(100, 3, 0, 0)
                                                  + real(0) + ints(1) + "\n\n\n"), "error", "KJ-9116")
    damped = ENGINE + "/DYREL\n1 1\n/KEREL\n"
    said = c.extract(deck(), engine=damped)
    c.check("relaxation", said["exit_code"] == 2 and [f["id"] for f in said["findings"]] == 2*["KJ-9022"], said["findings"])
    said = c.extract(deck(), "--ignore-unsupported", engine=damped)
    c.check("relaxation, ignored", said["exit_code"] == 0 and "REL" not in (c.work/"mech_0001.rad").read_text()
            and all("--ignore-unsupported" not in f.get("hint", "") for f in said["findings"]), said["findings"])


def references(c):
    """What the mechanism of two bodies with a revolute joint and two springs names."""
    text = (pathlib.Path(__file__).parent/"two_bodies"/"two_bodies_0000.rad").read_text()
    engine = (pathlib.Path(__file__).parent/"two_bodies"/"two_bodies_0001.rad").read_text()
    apart = "/NODE\n" + node(300, 0, 20, 0) + node(301, 1, 20, 0) + node(302, 0, 21, 0)

    def changed(before, after):
        assert before in text, before
        return text.replace(before, after, 1)
    gravity = "/GRAV/1\ng\n        11         Y         0"
    c.says("a sensor of another kind", changed(gravity + ints(0), "/SENSOR/DIST/4\ns\n\n" + gravity + ints(4)), "error", "KJ-9415")
    c.says("a sensor that nothing names", changed(gravity, "/SENSOR/DIST/4\ns\n\n" + gravity), None, "KJ-9415")
    c.says("a function in Python", changed("/FUNCT/11\n", "/FUNCT_PYTHON/11\n"), "error", "KJ-9415")
    c.says("axes of a joint on no body", apart + changed("        60        61        62\n/SKEW/MOV/2", ints(60, 61, 302) + "\n/SKEW/MOV/2"),
           "error", "KJ-9422")
    still = changed("/SPRING/6\n         2         3        17", "/SKEW/MOV/9\ns\n" + ints(300, 301, 302) + "\n/SPRING/6\n"
                   + ints(2, 3, 17) + 60*" " + ints(9))
    c.says("axes of a spring on no body", apart + still, "warning", "KJ-9423")
    c.check("they stand still", "/SKEW/FIX/9\n" in (c.work/"mech_0000.rad").read_text(), "no /SKEW/FIX/9")
    c.says("springs of a law that is not read", changed("/PROP/SPRING/7", "/PROP/SPR_PRE/7"), "warning", "KJ-9426")
    c.says("a spring on a node that is not there", changed("         3         2        16", ints(3, 2, 999)), "error", "KJ-0078")
    c.says("an element on a node that is not there", changed("         1         1         2         3         4", ints(1, 1, 2, 3, 999)),
           "error", "KJ-0078")
    for words, severity, number in (("/DYREL\n1.0 1.0", "error", "KJ-9022"), ("/KEREL", "error", "KJ-9022"), ("/ADYREL", "error", "KJ-9022"),
                                    ("/RBODY/OFF\n       101", "error", "KJ-9022"), ("/RBODY/ON\n       101", None, "KJ-9022"),
                                    ("/DT/NODA/CST\n0.9 1e-3", "warning", "KJ-9425"), ("/DT/BRICK/DEL\n0.9 1e-3", None, "KJ-9022"),
                                    ("/H3D/ELEM/VONM", None, "KJ-9022"), ("/DEL/SHELL/1", None, "KJ-9022")):
        said = c.extract(text, engine=engine + words + "\n")["findings"]
        right = [f["severity"] for f in said if f["id"] == number]
        c.check(words, right[:1] == [severity] if severity else not right, said)
    c.extract(changed("/TH/SPRING/3\n", "/TH/PART/8\np\nIE\n" + ints(1, 5, 2, 6) + "\n/TH/SPRING/3\n"))
    mech = (c.work/"mech_0000.rad").read_text()
    c.check("requests of parts", "/TH/PART/8\np\nIE\n" + ints(5, 6) + "\n" in mech, mech[-900:])
    bridge = "/PART/8\nrubber\n" + ints(2, 2, 0) + "\n/TETRA4/8\n" + ints(50, 1, 2, 11, 12) + "\n"
    loose = changed("/SPRING/5\n", bridge + "/SPRING/5\n")
    c.says("bodies that a joint holds", loose, None, "KJ-9429")
    for spring in ("         1        60        63\n", "         2         3        17\n", "         3         2        16\n"):
        loose = loose.replace(spring, "")
    c.says("bodies that fall apart", loose.replace("/TH/SPRING/3\nsprings\nDEF\n         1\n         2\n         3\n", ""), "warning",
           "KJ-9429")


def engine_cards(c):
    """/BCS, /BCSR, /INIV of the engine deck do what /BCS and /INIVEL of the starter deck do."""
    more = PARTNER + "/TH/RBODY/1\nt\nDEF       X         VX        VY        VRZ       \n" + ints(1) + "\n"

    def run(name, *options):
        path = c.work/(name + ".h5")
        path.unlink(missing_ok=True)
        done = subprocess.run([c.kjoint, "run", c.work/(name.split(".")[0] + "_0000.rad"), "-q", "-o", path, *options], capture_output=True,
                              text=True, check=False)
        c.check("run of " + name, done.returncode == 0, done.stderr)
        return path
    starter = ("/INIVEL/TRA/1\nv\n" + real(3, 0, 0) + ints(52) + "\n", "/INIVEL/ROT/2\nv\n" + real(0, 0, 2) + ints(52) + "\n",
               "/BCS/1\nb\n   100 000" + ints(0, 52) + "\n", "/INIVEL/AXIS/1\nv\n" + f"{'Z':>10}" + ints(0, 52) + "\n" + real(1, 2, 3, 4) + "\n")
    for name, before, cards in (
            ("velocity", starter[0], "/INIV/TRA/X\n3.0\n200 100\n"), ("turn", starter[1], "/INIV/ROT/Z\n2.0\n100, 201\n"),
            ("a range", starter[0], "/INIV/TRA/X/1\n3\n90 110 300 400\n"), ("held", starter[0] + starter[2],
             "/INIV/TRA/X\n3.0\n100\n/BCS/TRA/X\n200\n100\n"), ("released", starter[0],
             "/INIV/TRA/X\n3.0\n100\n/BCS/TRA/XY\n100\n/BCSR/TRA/YX\n100\n"), ("an axis", starter[3], "/INIV/AXIS/Z\n0\n1 2 3 4\n100\n")):
        c.extract(deck(more + before))
        there = run("full", "--mechanism").rename(c.work/"before.h5")
        said = c.extract(deck(more), engine=ENGINE + cards)
        written = (c.work/"mech_0001.rad").read_text() if said["exit_code"] == 0 else ""
        c.check("engine cards: " + name, cards.split("\n")[0] in written and " 200" not in written and "200 " not in written,
                [written, said["findings"]])
        for one in (run("full", "--mechanism"), run("mech")):
            done = subprocess.run([c.kjoint, "diff", there, one], capture_output=True, text=True, check=False)
            c.check(f"engine cards, {name}: {one.name}", done.returncode == 0 and "SAME" in done.stdout, done.stdout[-2000:])
    said = c.extract(deck(more), engine=ENGINE + "/BCS/TRA/X\n200 201\n/MYSTERY/1\n1 2\n")
    c.check("engine cards that mean nothing here", said["exit_code"] == 0 and {"KJ-9421", "KJ-E189"} <= {f["id"] for f in said["findings"]}
            and "/BCS" not in (c.work/"mech_0001.rad").read_text(), said["findings"])


def cards_in_the_file(c):
    """Cards of nodes and elements are read from the file when somebody asks: however they are typed."""
    shell = ints(1, 1, 2, 3, 4) + "\n"
    for name, card in (("commas", "1,1,2,3,4\n"), ("a comment before", "# of the shell\n$\n" + shell), ("return and feed", shell[:-1] + "\r\n"),
                       ("behind a blank", "\n" + shell)):
        c.body(name, deck().replace(shell, card), 6, (1, 1, 0))
    c.body("all lines end with return and feed", deck().replace("\n", "\r\n"), 6, (1, 1, 0))
    # one card names a parameter: all cards of its block are lines then
    c.body("a parameter in the second of two shells", deck("/PARAMETER/GLOBAL/INTEGER/1\np\nk         " + ints(4) + "\n/PARAMETER/GLOBAL"
           "/REAL/2\np\nd         " + real(1.0) + "\n").replace(shell, shell + ints(2, 1, 2, 3) + f"{'&k':>10}" + 30*" " + f"{'&d':>20}\n"),
           18, (1, 1, 0))                                                     # thickness 1: 12 more
    c.body("a parameter among the nodes", deck("/PARAMETER/GLOBAL/REAL/1\np\nw         " + real(2.0) + "\n").replace(
        node(3, 2, 2, 0), ints(3) + f"{'&w':>20}{'&w':>20}" + real(0) + "\n"), 6, (1, 1, 0))
    # offsets 1000 of a submodel: the part, its nodes, elements and groups are 1001 ...
    inside = deck().split("/NODE")[1]
    c.body("in a submodel", deck().replace("/NODE" + inside, "//SUBMODEL/1\ns\n" + ints(1000) + "\n/NODE" + inside.replace(
        "/END\n", "//ENDSUB\n/END\n")), 6, (1, 1, 0))
    head = deck().split(node(2, 2, 0, 0))[0].count("\n")
    c.says("a node twice, behind a comment", deck().replace(node(2, 2, 0, 0), "#\n" + node(1, 2, 0, 0)), "error", "KJ-0056", head + 2)
    c.says("a node that is not defined", deck().replace(shell, "#\n" + shell + ints(2, 1, 2, 3, 9) + "\n"), "error", "KJ-0078",
           deck().split(shell)[0].count("\n") + 3)
    c.says("an id that is none", deck().replace(shell, shell + ints(2, 1, 2, 3) + "       x4\n"), "error", "KJ-9002",
           deck().split(shell)[0].count("\n") + 2)
    for tail in ("", "\n\n"):
        c.body("the file ends with an element", deck().replace("/END\n", "").replace("/SHELL/1\n" + shell, "") + "/SHELL/1\n"
               + shell.rstrip() + tail, 6, (1, 1, 0))
    # lines longer than a piece of the file, cards across its edges
    for at in (0, 13, 29, 57):
        for block in ("\n/SHELL/1\n", "\n/NODE\n"):
            fill = 2**18 - deck().index(block) - len(block) - at
            c.body("at the edge of a piece", deck().replace(block, "\n" + fill//100*("#" + "x"*98 + "\n") + "#" + "x"*(fill % 100) + block),
                   6, (1, 1, 0))
    c.body("a comment of 3 MB between shells", deck().replace(shell, shell + "#" + "x"*3000000 + "\n" + ints(2, 1, 2, 3, 4) + "\n"),
           12, (1, 1, 0))
    many = "".join(ints(k, 1, 2, 3, 4) + "\n" for k in range(1, 30001))      # a parameter a megabyte behind the first card
    c.body("a parameter late", deck("/PARAMETER/GLOBAL/INTEGER/1\np\nk         " + ints(4) + "\n").replace(
        shell, many + ints(30001, 1, 2, 3) + f"{'&k':>10}\n"), 6*30001, (1, 1, 0))


def large(c):
    """A plate of shells and bricks, 150 bodies over parts of it: masses in closed form, memory below half of the file."""
    n, m, h = 150, 200, 0.5                                                   # bodies, elements of each along x
    text = ["/BEGIN\nlarge\n      2022         0\n" + 2*UNITS + "/MAT/LAW1/1\nm\n" + real(2.0) + "\n" + real(1, 0.3)
            + "\n/PROP/SHELL/1\ns\n" + ints(24) + "\n\n" + ints(3, 0) + real(0.5) + "\n/PROP/SOLID/2\nb\n" + ints(14) + "\n\n\n"]
    for b in range(n):
        first = 10000*b
        text.append("/NODE\n" + "".join(node(first + 4*i + k + 1, h*i, h*(k % 2), 3.0*b + h*(k//2)) for i in range(m + 1) for k in range(4)))
        text.append(node(first + 9999, 0, 0, 3.0*b) + f"/PART/{2*b + 1}\ns\n" + ints(1, 1) + f"\n/PART/{2*b + 2}\nb\n" + ints(2, 1) + "\n")
        at = [first + 4*i + 1 for i in range(m)]
        text.append(f"/SHELL/{2*b + 1}\n" + "".join(ints(first + i, a, a + 4, a + 5, a + 1) + "\n" for i, a in enumerate(at, 1)))
        text.append("".join(f"/BRICK/{2*b + 2}\n" + "".join(
            ints(first + 1000*r + i, a, a + 4, a + 5, a + 1, a + 2, a + 6, a + 7, a + 3) + "\n" for i, a in enumerate(at, 1)) for r in range(1, 10)))
        group = (f"/GRNOD/PART/{b + 1}\ng\n" + ints(2*b + 1, 2*b + 2) + "\n", f"/GRSHEL/PART/{b + 1}\ng\n" + ints(2*b + 1) + f"\n/GRBRIC/PART/"
                 f"{b + 1}\ng\n" + ints(2*b + 2) + f"\n/GRNOD/GRBRIC/{b + 1}\ng\n" + ints(b + 1) + "\n",
                 f"/SET/GENERAL/{b + 1}\ng\nPART      " + ints(2*b + 2) + "\n")[b % 3]
        text.append(group + f"/RBODY/{b + 1}\nbody\n" + ints(first + 9999, 0, 0, 0) + real(0) + ints(b + 1, 0, 1, 0) + "\n\n\n")
    said = c.extract("".join(text) + "/END\n")
    # of each body m shells of h^2 and 9 m bricks of h^3, the shells at the bottom
    shells, bricks = 2.0*0.5*m*h**2, 9*2.0*m*h**3
    x, z = 0.5*m*h, bricks*0.5*h/(shells + bricks)
    wrong = [b for b in said["bodies"] if abs(b["mass"] - shells - bricks) > 1e-11*b["mass"]
             or max(abs(p - q) for p, q in zip(b["centre"], (x, 0.5*h, 3.0*(b["id"] - 1) + z))) > 1e-9]
    c.check("bodies of a large deck", len(said["bodies"]) == n and not wrong, wrong[:1])
    # of a process of its own, as that of the tests is large
    most = subprocess.run([sys.executable, "-c", "import resource, subprocess, sys\nsubprocess.run(sys.argv[1:], stdout=-3)\n"
                           "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)", c.kjoint, "extract", c.work/"full_0000.rad",
                           "-o", c.work/"mech_0000.rad"], capture_output=True, text=True, check=True).stdout
    size = (c.work/"full_0000.rad").stat().st_size
    if b"__asan_init" not in pathlib.Path(c.kjoint).read_bytes():   # sanitizers keep what is freed
        c.check("memory for a large deck", 1024*int(most) < 0.5*size + 2**23, [most, size])   # beside 8 MiB of the program


def circles(c):
    """Selections that name each other, twice each: they end, and the body has no node."""
    for kind, one in (("GRNOD/SUBSET", "SUBSET"), ("GRNOD/SURF", "SURF/SURF"), ("GRNOD/GRSHEL", "GRSHEL/GRSHEL"),
                      ("GRNOD/GRNOD", "GRNOD/GRNOD"), ("SET/GENERAL", "SET/GENERAL")):
        def ids(*numbers):
            return ("SET       " if one == "SET/GENERAL" else "") + ints(*numbers) + "\n"
        group = "".join(f"/{one}/{a}\nc\n" + ids(b, b) for a, b in ((8, 9), (9, 8)))
        group += "" if kind == one else f"/{kind}/1\ng\n" + ids(8, 9)
        said = c.extract(deck(group=group, body="/RBODY/1\nbody\n" + ints(100, 0, 0, 0) + real(0)
                              + ints(8 if kind == one else 1, 0, 1, 0) + "\n\n\n"))
        c.check("a circle of " + one, said["exit_code"] == 2, said["findings"])
    c.says("a file that includes itself", deck("#include full_0000.rad\n"), "error", "KJ-9033", 6)


def main(kjoint):
    with tempfile.TemporaryDirectory() as work:
        c = Checks(pathlib.Path(kjoint).resolve(), work)
        for part in (masses, moves, parameters, structure, acts, references, circles, engine_cards, cards_in_the_file, large):
            part(c)
    print(f"{c.n - c.wrong} of {c.n} right")
    return c.wrong > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else __doc__)
