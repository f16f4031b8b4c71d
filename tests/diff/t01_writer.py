"""Writes Radioss time histories of type /TFILE/1 that hold globals alone, for the tests here; `order` is that of the
bytes: < of machines like this one, > of the others."""
import struct

import numpy as np

# Global variables of a T01 that kjoint has channels for: code and name of the channel
GLOBALS = {1: "internal_energy", 2: "kinetic_energy_trans", 3: "momentum_x", 4: "momentum_y",
           5: "momentum_z", 6: "mass", 7: "time_step", 8: "kinetic_energy_rot",
           9: "external_work"}


def record(payload, order="<"):
    """A record of a Fortran unformatted file."""
    length = struct.pack(order + "i", len(payload))
    return length + payload + length


def title(text, length):
    """A title: each group of 4 characters fills 8 bytes."""
    text = text.ljust(length).encode()
    return b"".join(text[i:i + 4] + b"    " for i in range(0, length, 4))


def write_t01(path, time, columns, order="<"):
    """Write curves: `columns` maps codes of globals to arrays like `time`."""

    def ints(*values):
        return struct.pack(f"{order}{len(values)}i", *values)

    codes = sorted(columns)
    data = [ints(3040) + title("curves", 80), title("", 80), ints(0, 0, 0, 0, 0, len(codes))]
    data += [ints(*codes)] if codes else []        # no record without content
    for i, t in enumerate(time):
        data.append(struct.pack(order + "d", t))
        if codes:
            data.append(np.array([columns[c][i] for c in codes], order + "f8").tobytes())
    data = [record(payload, order) for payload in data]
    path.write_bytes(b"".join(data))
