#!/usr/bin/env python3
"""Decks written in another way must give the same history.

usage: run_twins.py KJOINT WORK text|units [DECK ...]

text: comments, commas, numbers anywhere in their fields, D exponents, missing cards and fields at
the end, #include, CRLF, units as numbers, nonsense after /END - bit for bit the same.
units: input in Mg, mm, ms, work units as they were, and one block in a /UNIT of its own - the same
to 1e-12 of each peak.
"""
import pathlib
import random
import re
import subprocess
import sys

DECKS = pathlib.Path(__file__).parents[2] / "decks"
UNTITLED = {"/NODE", "/SPRING", "/ANALY", "/IOFLAG", "/END"}
KG, M, S = (1, 0, 0), (0, 1, 0), (0, 0, 1)
ONE, FORCE, MOMENT, INERTIA = (0, 0, 0), (1, 1, -2), (1, 2, -2), (1, 2, 0)
K, KR, C, CR = (1, 0, -2), (1, 2, -2), (1, 0, -1), (1, 2, -1)
SPEED, SPIN, ACCELERATION = (0, 1, -1), (0, 0, -1), (0, 1, -2)
FACTORS = (1e3, 1e-3, 1e-3)                      # Mg, mm, ms in kg, m, s
FREE = {1: "rx ry rz", 2: "rx", 3: "tx rx", 4: "ty tz rx", 5: "ry rz", 6: "tx", 7: "ty tz", 8: "",
        9: "tx ty tz rx ry rz"}


def ints(n):
    return [(10, "i", ONE)] * n


def reals(*dims):
    return [(20, "r", dim) for dim in dims]


LAYOUTS = {
    "/RBODY": [ints(4) + reals(KG) + ints(4), reals(*[INERTIA] * 3), reals(*[INERTIA] * 3), ints(3)],
    "/SKEW/MOV": [ints(3) + [(10, "a", ONE)]],
    "/PART": [ints(3)],
    "/GRAV": [[(10, "i", ONE), (10, "a", ONE)] + ints(3) + [(10, "b", ONE)] + reals(S, ACCELERATION)],
    "/IMPVEL": [[(10, "i", ONE), (10, "a", ONE)] + ints(5), reals(S, None, S, S)],
    "/INIVEL/TRA": [reals(SPEED, SPEED, SPEED) + ints(2)],
    "/INIVEL/ROT": [reals(SPIN, SPIN, SPIN) + ints(2)],
    "/INIVEL/AXIS": [[(10, "a", ONE)] + ints(2), reals(SPEED, SPEED, SPEED, SPIN)],
}
ROWS = {"/NODE": ints(1) + reals(M, M, M), "/SPRING": ints(7), "/FUNCT": reals(ONE, ONE)}


BLANK30 = [(30, "b", ONE)]


class Block:
    def __init__(self, header, title, cards):
        self.header, self.title, self.cards = header, title, cards
        self.key = re.sub(r"(/\d+)+$", "", header)

    def layouts(self):
        """The fields of each card, None where the card is left as it is."""
        if self.key in ROWS:
            return [ROWS[self.key]] * len(self.cards)
        if self.key in ("/PROP/KJOINT", "/PROP/TYPE33"):
            return joint_layout(int(self.cards[0][:10]))
        if self.key in ("/PROP/KJOINT2", "/PROP/TYPE45"):
            return joint2_layout(int(self.cards[0][:10]))
        if self.key in ("/PROP/TYPE4", "/PROP/SPRING"):
            return [reals(KG) + BLANK30 + ints(3)] + spring_layout(False)
        if self.key in ("/PROP/TYPE8", "/PROP/SPR_GENE"):
            return [reals(KG, INERTIA) + ints(6)] + 3 * spring_layout(False) + 3 * spring_layout(True)
        return LAYOUTS.get(self.key, [None] * len(self.cards))


def joint_layout(kind):
    free = FREE[kind].split()
    k = [KR if d[0] == "r" else K for d in free]
    c = [CR if d[0] == "r" else C for d in free]
    cards = [ints(2), ints(2) + reals(K, ONE)]
    if kind == 9:
        for dims in (k, c):
            cards += [reals(*dims[:3]), reals(*dims[3:]), ints(3), ints(3)]
    elif kind == 1:
        cards += [reals(K, *k), ints(3), reals(*c), ints(3)]
    elif kind == 4:
        cards += [reals(K, K, K) + ints(2), reals(KR) + ints(1), reals(C, C, CR), ints(3)]
    else:
        cards += [reals(K, *k) + ints(len(free))]
        if free:
            cards += [reals(*c) + ints(len(free))]
    return cards


def joint2_layout(kind):
    cards = [ints(1) + reals(K, ONE, ONE) + ints(3)]
    for d in FREE[kind].split():
        turn = d[0] == "r"
        stop = ONE if turn else M
        cards += [reals(KR if turn else K) + ints(1) + reals(stop, stop) + ints(1),
                  reals(CR if turn else C) + ints(1),
                  reals(KR if turn else K, MOMENT if turn else FORCE) + ints(1)]
    return cards


def spring_layout(turn):
    """The three cards of one direction of a spring; factors of functions and gaps stay 0 here."""
    return [reals(KR if turn else K, CR if turn else C, ONE, ONE, ONE), ints(5) + [(10, "b", ONE)] + reals(ONE, ONE),
            reals(ONE, ONE, ONE, ONE)]


def parse(text):
    blocks = []
    for line in text.splitlines():
        if line.startswith(("#", "$")):
            continue
        if line.startswith("/"):
            blocks.append(Block(line.rstrip(), None, []))
        elif blocks and blocks[-1].title is None and blocks[-1].key not in UNTITLED:
            blocks[-1].title = line
        elif blocks:
            blocks[-1].cards.append(line)
    return blocks


def cut(card, layout):
    at, fields = 0, []
    for width, _, _ in layout:
        fields.append(card[at:at + width].strip())
        at += width
    return fields


def is_zero(text):
    return text in ("", "0", "0.0")


def other_real(rng, text):
    """The same number in another spelling of at most 20 columns."""
    value = float(text.lower().replace("d", "e")) if text else 0.0
    if text == "" and rng.random() < 0.5:
        return ""
    mantissa, _, exponent = f"{value!r}".partition("e")
    forms = [repr(value), text or "0."]
    for digits in range(17):
        short = f"{value:.{digits}e}"
        if float(short) == value:
            mantissa, _, exponent = short.partition("e")
            exponent = int(exponent)
            forms += [f"{mantissa}D{exponent:+03d}", f"{mantissa}d{exponent}",
                      f"{mantissa}E{exponent:+d}", f"{mantissa}{exponent:+d}"]
            break
    forms = [form for form in forms if len(form) <= 20]
    return rng.choice(forms)


def odd_card(rng, fields, layout):
    out = [other_real(rng, text) if kind == "r" else text
           for text, (_, kind, _) in zip(fields, layout)]
    while out and is_zero(out[-1]) and rng.random() < 0.7:
        out.pop()
    if len(out) > 1 and rng.random() < 0.4:
        blanks = [" " * rng.randrange(3) for _ in out]
        return ",".join(blank + text for blank, text in zip(blanks, out))
    card = ""
    for text, (width, _, _) in zip(out, layout):
        card += rng.choice((text.rjust, text.ljust, text.center))(width)
    return card.rstrip()


def odd_block(rng, block):
    lines = [block.header]
    if block.title is not None:
        lines.append(block.title)
    cards = []
    layouts = block.layouts()
    for card, layout in zip(block.cards, layouts):
        cards.append(card if layout is None else odd_card(rng, cut(card, layout), layout))
    if block.key in ("/RBODY", "/PROP/KJOINT"):
        least = 1 if block.key == "/RBODY" else 3
        while len(cards) > least and all(is_zero(f) for f in cut(block.cards[len(cards) - 1],
                                                                 layouts[len(cards) - 1])):
            cards.pop()
    lines += cards
    out = []
    for line in lines:
        if rng.random() < 0.3:
            out.append(rng.choice(("# a comment", "$ another", "#", "#---1----|----2")))
        out.append(line)
    return out


def units_as_numbers(lines):
    codes = {"kg": "1.0", "m": "1", "s": "1.0", "mm": "0.001", "ms": "1.0E-3"}
    return ["".join(codes.get(word, word).rjust(20) for word in line.split()) for line in lines]


def text_twin(name, starter, folder):
    """Write the starter deck in many other ways at once; returns its path."""
    rng = random.Random(name)
    folder.mkdir(parents=True, exist_ok=True)
    out, part, parts = [], None, 0
    for block in parse(starter):
        if block.key == "/BEGIN":
            block.cards[1:] = units_as_numbers(block.cards[1:])
            out += [block.header, block.title, *block.cards]
            continue
        if block.key == "/END":
            break
        if part is None and rng.random() < 0.25:
            parts += 1
            part = []
        lines = odd_block(rng, block)
        (out if part is None else part).extend(lines)
        if part is not None and rng.random() < 0.5:
            write(folder / f"part{parts}.inc", part, "\r\n" if rng.random() < 0.5 else "\n")
            out.append(rng.choice(("#include", "#INCLUDE")) + f" part{parts}.inc")
            part = None
    if part is not None:
        write(folder / f"part{parts}.inc", part, "\n")
        out.append(f"#include part{parts}.inc")
    if rng.random() < 0.7:
        out += ["/END", "nonsense", "/MORE"]
    path = folder / f"{name}_0000.rad"
    write(path, out, "\r\n" if rng.random() < 0.5 else "\n")
    return path


def write(path, lines, end):
    path.write_bytes((end.join(lines) + end).encode())


def factor(dim, factors):
    return factors[0]**dim[0]*factors[1]**dim[1]*factors[2]**dim[2]


def function_use(blocks):
    """What the abscissae of each function are, where a joint uses it."""
    use = {}
    for block in blocks:
        if not block.key.startswith("/PROP/KJOINT"):
            continue
        for role, number in functions_of(block):
            if number:
                use[number] = {"K": {"t": M, "r": ONE}, "C": {"t": SPEED, "r": SPIN},
                               "F": {"t": M, "r": ONE}}[role[0]][role[1]]
    return use


def functions_of(block):
    """(role, function) of each scale on the cards: Kt, Kr, Ct, Cr, Ft, Fr"""
    kind = int(block.cards[0][:10])
    free = FREE[kind].split()
    fields = [cut(card, layout) for card, layout in zip(block.cards, block.layouts())]
    fields += [[""] * len(layout) for layout in block.layouts()[len(fields):]]
    number = lambda text: int(text or 0)
    found = []
    if block.key == "/PROP/KJOINT2":
        for i, d in enumerate(free):
            a, b, c = fields[3*i + 1:3*i + 4]
            found += [("K" + d[0], number(a[1])), ("C" + d[0], number(b[1])), ("F" + d[0], number(c[2]))]
        return found
    if kind == 9:
        places = [(4, 0), (4, 1), (4, 2), (5, 0), (5, 1), (5, 2)], [(8, 0), (8, 1), (8, 2), (9, 0), (9, 1), (9, 2)]
    elif kind == 1:
        places = [(3, i) for i in range(3)], [(5, i) for i in range(3)]
    elif kind == 4:
        places = [(2, 3), (2, 4), (3, 1)], [(5, i) for i in range(3)]
    else:
        n = len(free)
        places = [(2, 1 + n + i) for i in range(n)], [(3, n + i) for i in range(n)]
    for letter, cells in zip("KC", places):
        for d, (card, field) in zip(free, cells):
            found.append((letter + d[0], number(fields[card][field])))
    return found


def unit_twin(name, starter, folder, units_work):
    """The starter deck with input units Mg, mm, ms and the same work units."""
    work = {"kg": (1.0, 1.0, 1.0)}.get(units_work[0])
    work = tuple({"kg": 1.0, "Mg": 1e3, "m": 1.0, "mm": 1e-3, "s": 1.0, "ms": 1e-3}[u]
                 for u in units_work)
    si = FACTORS
    local = (1.0, 1e-2, 60.0)                    # kg, cm, min in the /UNIT
    blocks = parse(starter)
    use = function_use(blocks)
    out, localized = [], False
    for block in blocks:
        if block.key == "/END":
            break
        if block.key == "/BEGIN":
            out += [block.header, block.title, block.cards[0],
                    "".join(u.rjust(20) for u in ("Mg", "mm", "ms")), block.cards[2],
                    "/UNIT/77", "local", "kg,0.01,60."]
            continue
        header, system = block.header, si
        if block.key in ("/RBODY", "/INIVEL/TRA", "/INIVEL/ROT") and not localized:
            header, system, localized = header + "/77", local, True
        out.append(header)
        if block.title is not None:
            out.append(block.title)
        factors = tuple(a/b for a, b in zip(system, work))
        roles = dict()
        if block.key.startswith("/PROP/KJOINT"):
            roles = scale_roles(block)
        for i, (card, layout) in enumerate(zip(block.cards, block.layouts())):
            if layout is None:
                out.append(card)
                continue
            fields = cut(card, layout)
            for j, (_, kind, dim) in enumerate(layout):
                if kind != "r":
                    continue
                value = float((fields[j] or "0").lower().replace("d", "e"))
                if dim is None:                  # scale of an imposed velocity
                    direction = cut(block.cards[0], block.layouts()[0])[1]
                    dim = SPEED if len(direction) == 1 else SPIN
                if block.key in ("/GRAV", "/IMPVEL") and value == 0.0 and dim in (ACCELERATION, SPEED, SPIN):
                    value = 1.0
                if block.key in ("/GRAV", "/IMPVEL") and j == 0 and i == 1 and value == 0.0:
                    value = 1.0
                if block.key == "/FUNCT":
                    number = int(block.header.split("/")[2])
                    dim = use.get(number, ONE) if j == 0 else ONE
                if (i, j) in roles:
                    dim = FORCE if roles[i, j][1] == "t" else MOMENT
                    value = value or 1.0
                value /= factor(dim, factors)
                fields[j] = repr(value)
            out.append(",".join(fields))
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}_0000.rad"
    write(path, out, "\n")
    return path


def scale_roles(block):
    """Places (card, field) of scales of functions, which are forces or moments."""
    kind = int(block.cards[0][:10])
    free = FREE[kind].split()
    found = functions_of(block)
    if block.key == "/PROP/KJOINT2":
        places = [(3*i + k, field) for i in range(len(free)) for k, field in ((1, 0), (2, 0), (3, 1))]
    elif kind == 9:
        places = [(2, 0), (2, 1), (2, 2), (3, 0), (3, 1), (3, 2), (6, 0), (6, 1), (6, 2), (7, 0), (7, 1), (7, 2)]
    elif kind == 1:
        places = [(2, 1), (2, 2), (2, 3), (4, 0), (4, 1), (4, 2)]
    elif kind == 4:
        places = [(2, 1), (2, 2), (3, 0), (4, 0), (4, 1), (4, 2)]
    else:
        n = len(free)
        places = [(2, 1 + i) for i in range(n)] + [(3, i) for i in range(n)]
    return {place: role for place, (role, number) in zip(places, found) if number}


def main():
    kjoint, work, mode = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]), sys.argv[3]
    # the value of a parameter begins where its & stands and has no units: such decks stay as they are
    names = sys.argv[4:] or sorted(p.name[:-9] for p in DECKS.glob("*_0000.rad")
                                   if "/PARAMETER" not in p.read_text())
    failed = 0
    for name in names:
        starter = (DECKS / f"{name}_0000.rad").read_text()
        engine = DECKS / f"{name}_0001.rad"
        formulation = ["--legacy"] if "/PROP/KJOINT2" in starter else []
        folder = work / mode / name
        if mode == "text":
            twin = text_twin(name, starter, folder)
            until, profile = [], ["--profile", "exact"]
        else:
            begin = next(b for b in parse(starter) if b.key == "/BEGIN")
            twin = unit_twin(name, starter, folder, begin.cards[2].split())
            # a hundred cycles or so: rounding grows with the number of turns, not with units
            until, profile = ["--sample", "0"], ["--profile", "repeat"]
        files = []
        for label, deck in (("plain", DECKS / f"{name}_0000.rad"), ("twin", twin)):
            files.append(folder / f"{label}.h5")
            words = [kjoint, "run", "-q", deck, engine, "-o", files[-1], *formulation, *until]
            if mode == "units":
                words += ["--until", short_end(kjoint, DECKS / f"{name}_0000.rad", formulation)]
            done = subprocess.run(words, capture_output=True, text=True)
            if done.returncode:
                print(f"FAIL   {name}: {label}: exit {done.returncode}\n{done.stderr}")
                failed += 1
                break
        else:
            done = subprocess.run([kjoint, "diff", *files, *profile], capture_output=True, text=True)
            verdict = done.stdout.strip().splitlines()[-1]
            print(("ok     " if done.returncode == 0 else "FAIL   ") + name + ": " + verdict)
            failed += done.returncode != 0
    sys.exit(failed > 0)


def short_end(kjoint, deck, formulation):
    """Fifty critical steps."""
    import json
    said = json.loads(subprocess.run([kjoint, "check", "--json", deck, *formulation], check=True,
                                     capture_output=True, text=True).stdout)
    return repr(50.0*said["nodal_step"])


main()
