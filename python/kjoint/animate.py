"""`kjoint animate`: the mechanism as a film, or its picture at one time.

usage: python3 -m kjoint.animate RUN.h5 --output FILE.mp4|gif|png [--colour force|moment|gap] [--at T]
                                 [--seconds S]

A plane mechanism is seen along its normal, any other in space. Drawn by matplotlib, so it needs no
OpenGL; mp4 by the ffmpeg of imageio-ffmpeg or of the system.
"""
from __future__ import annotations

import pathlib
import shutil
import subprocess
from typing import Any, Iterator

from ._error import Parser
from ._scene import Scene
from ._show import command, fail, need

RATE = 25                                        # pictures a second
TRAIL = 40                                       # pictures that the trail of a joint shows


def draw_film(scene: Any, options: Any) -> None:
    np, plt = need("animate", "numpy", "matplotlib.pyplot")
    plt.switch_backend("Agg")
    suffix = pathlib.Path(options.output).suffix
    plt.rcParams["figure.dpi"] = 70 if suffix == ".gif" else 110
    picture = Picture(np, plt, scene, options.colour)
    if suffix == ".png":
        at = scene.time[-1] if options.at is None else options.at
        last = int(np.abs(scene.time - at).argmin())
        picture.show(last, np.linspace(0, last, min(last + 1, TRAIL * 5)).astype(int))
        picture.figure.savefig(options.output)
        return
    n = max(2, min(len(scene.time), round(options.seconds * RATE)))
    times = np.linspace(scene.time[0], scene.time[-1], n)
    frames = np.searchsorted(scene.time, times).clip(0, len(scene.time) - 1)
    size = picture.figure.canvas.get_width_height()
    pictures = (picture.pixels(frames[k], np.linspace(frames[max(0, k - TRAIL)], frames[k], TRAIL * 5).astype(int))
                for k in range(n))
    if suffix == ".gif":
        Image, = need("animate", "PIL.Image")
        first, *others = (Image.frombuffer("RGBA", size, pixels).convert("RGB").quantize() for pixels in pictures)
        first.save(options.output, save_all=True, append_images=others, duration=1000 // RATE, loop=0)
    else:
        write_film(options.output, size, pictures)


def write_film(path: str, size: tuple[int, int], pictures: Iterator[bytes]) -> None:
    """Pictures of (width, height) pixels, RGBA, into an mp4"""
    ffmpeg = shutil.which("ffmpeg") or need("animate FILE.mp4", "imageio_ffmpeg")[0].get_ffmpeg_exe()
    words = [ffmpeg, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba", "-s", "{}x{}".format(*size),
             "-r", str(RATE), "-i", "-", "-c:v", "libx264", "-pix_fmt", "yuv420p",
             "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", path]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdin and process.stderr
        try:
            for pixels in pictures:
                process.stdin.write(pixels)
            process.stdin.close()
        except BrokenPipeError:
            pass                                 # it says why
        said = process.stderr.read().decode(errors="replace").strip()
    if process.returncode:
        raise OSError(said.splitlines()[-1] if said else "ffmpeg failed")


class Picture:
    """One figure, whose lines and points move before a background that is drawn once."""

    def __init__(self, np: Any, plt: Any, scene: Any, colour: Any) -> None:
        self.np, self.scene = np, scene
        self.values = scene.loads.get(colour)
        flat = scene.flat_direction()
        middle, reach = scene.box()
        reach *= 1.08
        self.axes: tuple[int, ...] = tuple(k for k in range(3) if k != flat)
        if flat is None:
            self.figure, axis = plt.subplots(figsize=(7.0, 5.6), layout="constrained",
                                             subplot_kw={"projection": "3d"})
            axis.set_box_aspect((1, 1, 1))
            axis.set_zlim(middle[2] - reach, middle[2] + reach)
            axis.set_zlabel(f"z [{scene.units['length']}]")
        else:
            a, b = self.axes[:2]
            extent = np.ptp(np.concatenate([scene.joints.reshape(-1, 3),
                                            scene.points.reshape(-1, 3)]), axis=0)
            height = max(0.35, min(1.4, (extent[b] + 0.2 * reach) / (extent[a] + 0.2 * reach)))
            self.figure, axis = plt.subplots(figsize=(7.0, 1.1 + 6.0 * height),
                                             layout="constrained")
            axis.set_aspect("equal")
        self.axis = axis
        a, b = self.axes[:2]
        extent = 0.5 * np.ptp(np.concatenate([scene.joints.reshape(-1, 3),
                                              scene.points.reshape(-1, 3)]), axis=0)
        for k, limit, name in ((a, axis.set_xlim, axis.set_xlabel), (b, axis.set_ylim, axis.set_ylabel)):
            half = reach if flat is None else extent[k] + 0.08 * reach
            limit(middle[k] - half, middle[k] + half)
            name(f"{'xyz'[k]} [{scene.units['length']}]")
        axis.grid(True, color="#e8e8e8")
        axis.set_axisbelow(True)
        colours = ("#006ba4", "#595959", "#5f9ed1", "#898989", "#a2c8ec", "#c85200")
        body_of = scene.point_body if scene.points.shape[1] else []
        self.lines = [axis.plot([], [], *([[]] if flat is None else []), "-", lw=4.0,
                                solid_capstyle="round", alpha=0.85,
                                color=colours[body_of[s[0]] % len(colours)])[0]
                      for s in scene.segments]
        self.trails = [axis.plot([], [], *([[]] if flat is None else []), "-", lw=0.9,
                                 color="#ff800e", alpha=0.7)[0] for _ in scene.joint_ids]
        self.dots = axis.scatter(*([0.0] * len(scene.joint_ids),) * len(self.axes), s=52, zorder=5,
                                 c=[0.0] * len(scene.joint_ids), cmap="plasma", edgecolors="black",
                                 linewidths=0.8, depthshade=False) if flat is None else \
            axis.scatter([0.0] * len(scene.joint_ids), [0.0] * len(scene.joint_ids), s=52, zorder=5,
                         c=[0.0] * len(scene.joint_ids), cmap="plasma", edgecolors="black",
                         linewidths=0.8)
        if self.values is not None and self.values.size:
            self.dots.set_clim(0.0, max(float(np.nanmax(self.values)), 1e-300))
            self.figure.colorbar(self.dots, ax=axis, shrink=0.7,
                                 label=f"{colour} of the joint [{scene.units[colour]}]")
        self.title = axis.set_title("", fontsize=10, loc="left", fontfamily="DejaVu Sans")
        self.show(0, [0])
        self.figure.canvas.draw()               # the layout is found once, not for each picture
        self.figure.set_layout_engine("none")
        self.moving = [*self.lines, *self.trails, self.dots, self.title]
        for artist in self.moving:
            artist.set_animated(True)
        self.figure.canvas.draw()
        self.background = self.figure.canvas.copy_from_bbox(self.figure.bbox)

    def pixels(self, i: Any, trail: Any) -> bytes:
        """The picture of sample i, RGBA."""
        canvas = self.figure.canvas
        canvas.restore_region(self.background)
        self.show(i, trail)
        if len(self.axes) == 3:
            self.dots.do_3d_projection()
        for artist in self.moving:
            self.axis.draw_artist(artist)
        return bytes(canvas.buffer_rgba())

    def show(self, i: Any, trail: Any) -> None:
        scene = self.scene
        for line, (p, q) in zip(self.lines, scene.segments):
            self.put(line, scene.points[i, [p, q]])
        for line, j in zip(self.trails, range(len(scene.joint_ids))):
            self.put(line, scene.joints[trail, j])
        place = scene.joints[i][:, self.axes]
        if len(self.axes) == 3:
            self.dots._offsets3d = tuple(place.T)
        else:
            self.dots.set_offsets(place)
        if self.values is not None:
            self.dots.set_array(self.values[i])
        self.title.set_text(f"{scene.title}   t = {scene.time[i]:.5g} {scene.units['time']}")

    def put(self, line: Any, xyz: Any) -> None:
        a, b = self.axes[:2]
        line.set_data(xyz[:, a], xyz[:, b])
        if len(self.axes) == 3:
            line.set_3d_properties(xyz[:, 2])


def main() -> None:
    parser = Parser(prog="kjoint animate")
    parser.add_argument("run")
    parser.add_argument("--output", required=True)
    parser.add_argument("--colour", choices=("force", "moment", "gap"), default="force")
    parser.add_argument("--at", type=float)
    parser.add_argument("--seconds", type=float, default=6.0)
    options = parser.read()
    if pathlib.Path(options.output).suffix not in (".mp4", ".gif", ".png"):
        fail("a film is .mp4 or .gif, a picture .png: -o FILE.mp4")
    try:
        draw_film(Scene(options.run, "animate"), options)
    except OSError as problem:
        fail(f"cannot write {options.output}: {problem}", 3)
    print(options.output)


if __name__ == "__main__":
    command(main)
