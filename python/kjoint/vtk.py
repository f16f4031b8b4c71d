"""`kjoint export --to vtkhdf|pvd`: the moving mechanism for ParaView.

usage: python3 -m kjoint.vtk RUN.h5 --to vtkhdf|pvd --output FILE

Points of the bodies and places of the joints; lines join the points of a body, a vertex is each joint.
Point data: id (of joint or body), is_joint, force, moment and gap of the joints, 0 elsewhere.
"""
from __future__ import annotations

import pathlib
from typing import Any

from ._error import Parser
from ._scene import Scene
from ._show import command, fail, need


def mesh(scene: Any) -> Any:
    """Numbers of points, and connectivity, offsets, types of lines and vertices: constant."""
    np = scene.np
    n_point, n_joint = scene.points.shape[1], scene.joints.shape[1]
    connectivity = np.concatenate([scene.segments.ravel(), n_point + np.arange(n_joint)])
    sizes = np.concatenate([np.full(len(scene.segments), 2), np.ones(n_joint, int)])
    types = np.concatenate([np.full(len(scene.segments), 3), np.ones(n_joint, int)])
    return connectivity.astype("i8"), np.concatenate([[0], np.cumsum(sizes)]).astype("i8"), \
        types.astype("u1")


def point_data(scene: Any) -> Any:
    """{name: (sample, point)}"""
    np = scene.np
    n, n_point = len(scene.time), scene.points.shape[1]
    bodies = scene.point_body if n_point else np.zeros(0)
    data = {"is_joint": np.broadcast_to(np.concatenate([np.zeros(n_point), np.ones(
        len(scene.joint_ids))]), (n, n_point + len(scene.joint_ids))),
            "id": np.broadcast_to(np.concatenate([bodies, scene.joint_ids]).astype(float),
                                  (n, n_point + len(scene.joint_ids)))}
    for name, values in scene.loads.items():
        data[name] = np.concatenate([np.zeros((n, n_point)), values], axis=1)
    return data


def write_vtkhdf(scene: Any, path: Any) -> None:
    """Temporal UnstructuredGrid of VTKHDF 2.1, which ParaView 5.12 and later read."""
    np, h5py = scene.np, scene.h5py
    n, xyz = len(scene.time), np.concatenate([scene.points, scene.joints], axis=1)
    n_point = xyz.shape[1]
    connectivity, offsets, types = mesh(scene)
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF", track_order=True)
        root.attrs["Version"] = (2, 1)
        root.attrs.create("Type", b"UnstructuredGrid",
                          dtype=h5py.string_dtype("ascii", len("UnstructuredGrid")))
        for name, count in (("Points", n_point), ("Cells", len(types)),      # one part for all steps
                            ("ConnectivityIds", len(connectivity))):
            root[f"NumberOf{name}"] = np.array([count], "i8")
        root.create_dataset("Points", data=xyz.reshape(-1, 3), compression="gzip", shuffle=True)
        root["Connectivity"], root["Offsets"], root["Types"] = connectivity, offsets, types
        data, steps = root.create_group("PointData"), root.create_group("Steps")
        steps.attrs["NSteps"] = n
        steps["Values"] = scene.time
        steps["NumberOfParts"] = np.ones(n, "i8")
        steps["PartOffsets"] = np.zeros(n, "i8")
        steps["PointOffsets"] = np.arange(n, dtype="i8") * n_point
        for name in ("CellOffsets", "ConnectivityIdOffsets"):      # the cells of all steps are one
            steps[name] = np.zeros((n, 1), "i8")
        offsets = steps.create_group("PointDataOffsets")
        for name, values in point_data(scene).items():
            data.create_dataset(name, data=values.reshape(-1), compression="gzip", shuffle=True)
            offsets[name] = np.arange(n, dtype="i8") * n_point


def write_pvd(scene: Any, path: Any) -> None:
    """A .pvd that names a .vtp for each sample, in a folder of its name."""
    vtk, numpy_support = need("export --to pvd", "vtk", "vtk.util.numpy_support")
    np = scene.np
    path = pathlib.Path(path)
    folder = path.with_suffix("")
    folder.mkdir(exist_ok=True)
    xyz = np.concatenate([scene.points, scene.joints], axis=1)
    data, n_point = point_data(scene), scene.points.shape[1]
    lines, vertices = vtk.vtkCellArray(), vtk.vtkCellArray()
    for a, b in scene.segments:
        lines.InsertNextCell(2, [int(a), int(b)])
    for j in range(scene.joints.shape[1]):
        vertices.InsertNextCell(1, [n_point + j])
    entries = []
    for i, t in enumerate(scene.time):
        grid, points = vtk.vtkPolyData(), vtk.vtkPoints()
        points.SetDataTypeToDouble()
        points.SetData(numpy_support.numpy_to_vtk(np.ascontiguousarray(xyz[i]), deep=True))
        grid.SetPoints(points)
        grid.SetLines(lines)
        grid.SetVerts(vertices)
        for name, values in data.items():
            array = numpy_support.numpy_to_vtk(np.ascontiguousarray(values[i]), deep=True)
            array.SetName(name)
            grid.GetPointData().AddArray(array)
        writer = vtk.vtkXMLPolyDataWriter()
        name = folder / f"{folder.name}_{i:05d}.vtp"
        writer.SetFileName(str(name))
        writer.SetInputData(grid)
        if not writer.Write():
            raise OSError(f"{name} cannot be written")
        entries.append(f'    <DataSet timestep="{t:.17g}" file="{folder.name}/{name.name}"/>\n')
    path.write_text('<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n'
                    f'  <Collection>\n{"".join(entries)}  </Collection>\n</VTKFile>\n',
                    encoding="ascii")


def main() -> None:
    parser = Parser(prog="kjoint export")
    parser.add_argument("run")
    parser.add_argument("--to", choices=("vtkhdf", "pvd"), required=True)
    parser.add_argument("--output", required=True)
    options = parser.read()
    scene = Scene(options.run, "export")
    try:
        (write_vtkhdf if options.to == "vtkhdf" else write_pvd)(scene, options.output)
    except OSError as problem:
        fail(f"cannot write {options.output}: {problem}", 3)
    print(options.output)


if __name__ == "__main__":
    command(main)
