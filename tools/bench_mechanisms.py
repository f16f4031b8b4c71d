"""Mechanisms of tests/accuracy/compliant_scenes.py in MuJoCo and Exudyn: positions of their bodies, and the seconds it took.

MuJoCo: RK4; a tree of joints, loops closed by `connect`, as stiff as it lets them be: impedance 0.9999, its largest, and a
time constant of a few steps. A hinge that closes a loop in space is two of them.
Exudyn: generalised alpha, bodies with Euler parameters, all joints are constraints. It takes no redundant ones: a hinge that
closes a plane loop holds its plane alone, that of Bricard's loop in space one turn less.
"""
import os
import time

import compliant_scenes as scenes
import numpy as np

os.environ.setdefault("OMP_NUM_THREADS", "1")
STEPS = (1, 2, 3, 4, 6, 8, 11, 16, 22, 32, 45, 64, 90, 128, 180, 256, 362, 512)   # between two samples
KINDS = {"mujoco": (2.5, 5.0), "exudyn": (1.0, 0.9, 0.6)}      # time constant in steps; spectral radius


def tree(scene):
    """Parent and joint of each body, sliders first; the joints that are left close loops"""
    parent, left = {b: (None, None) for b, body in enumerate(scene.bodies, 1) if body["held"]}, list(scene.links)
    while len(parent) < len(scene.bodies):
        link = next(j for j in sorted(left, key=lambda j: j["kind"] != scenes.TRANSLATIONAL)
                    if (j["ends"][0] in parent) != (j["ends"][1] in parent))
        known, new = link["ends"] if link["ends"][0] in parent else link["ends"][::-1]
        parent[new] = (known, link)
        left.remove(link)
    return parent, left


def is_plane(scene):
    """All hinges are parallel, or turn with a shaft that has its loops in a plane"""
    axes = np.array([j["axis"] for j in scene.links if j["kind"] == scenes.REVOLUTE])
    return len(axes) == 0 or np.linalg.matrix_rank(axes) < 3


def mujoco(scene, until, samples, setting):
    import mujoco as m
    steps, constant = setting
    h = until / samples / steps
    parent, left = tree(scene)
    kinds = {scenes.REVOLUTE: "hinge", scenes.SPHERICAL: "ball", scenes.TRANSLATIONAL: "slide"}

    def text(x):
        return " ".join(f"{v:.17g}" for v in x)

    def element(b):
        body, (above, link) = scene.bodies[b - 1], parent[b]
        inside = "".join(element(c) for c in parent if parent[c][0] == b)
        if body["held"]:
            return f'<body name="b{b}" pos="{text(body["x"])}">{inside}</body>'
        j = body["inertia"]
        joint = f'<joint type="{kinds[link["kind"]]}" pos="{text(link["x"] - body["x"])}" axis="{text(link["axis"])}" ' \
                f'stiffness="{link["law"][0]}" damping="{link["law"][1]}"/>'
        return f'<body name="b{b}" pos="{text(body["x"] - scene.bodies[above - 1]["x"])}">{joint}<inertial pos="0 0 0" ' \
               f'mass="{body["mass"]}" fullinertia="{text([j[0], j[1], j[2], j[3], j[5], j[4]])}"/>{inside}</body>'

    closed = ""
    for link in left:
        one, two = link["ends"]
        for at in [0.0] if is_plane(scene) else [-0.5, 0.5]:
            closed += f'<connect body1="b{one}" body2="b{two}" solref="{constant*h:.17g} 1" solimp="0.9999 0.9999 0.001" ' \
                      f'anchor="{text(link["x"] + at*link["axis"] - scene.bodies[one - 1]["x"])}"/>'
    pull = np.zeros(3)
    if scene.gravity:
        pull[scene.gravity[0]] = scene.gravity[1]
    model = m.MjModel.from_xml_string(
        f'<mujoco><compiler autolimits="false"/><option timestep="{h:.17g}" integrator="RK4" gravity="{text(pull)}" tolerance="1e-14" '
        f'iterations="50"><flag contact="disable"/></option><worldbody>'
        + "".join(element(b) for b in parent if parent[b][0] is None) + f"</worldbody><equality>{closed}</equality></mujoco>")
    data = m.MjData(model)
    m.mj_forward(model, data)
    rows, wanted = [], []
    for b, body in enumerate(scene.bodies, 1):
        if not body["held"]:
            jac = np.zeros((6, model.nv))
            m.mj_jacBodyCom(model, data, jac[:3], jac[3:], m.mj_name2id(model, m.mjtObj.mjOBJ_BODY, f"b{b}"))
            rows.append(jac)
            wanted.append(body["speed"])
    data.qvel[:] = np.linalg.lstsq(np.vstack(rows), np.concatenate(wanted), rcond=None)[0]
    order = [m.mj_name2id(model, m.mjtObj.mjOBJ_BODY, f"b{b}") for b in range(1, len(scene.bodies) + 1)]
    places, spent = [data.xpos[order].copy()], 0.0
    for _ in range(samples):
        begin = time.process_time()
        m.mj_step(model, data, steps)
        spent += time.process_time() - begin
        m.mj_kinematics(model, data)
        places.append(data.xpos[order].copy())
    return np.array(places), spent, samples * steps


def exudyn(scene, until, samples, setting):
    import exudyn as exu
    from exudyn.itemInterface import GenericJoint, MarkerBodyRigid, RigidBodySpringDamper, SensorBody
    from exudyn.utilities import RigidBodyInertia
    steps, radius = setting
    system = exu.SystemContainer().AddSystem()
    ground = system.CreateGround()
    pull = np.zeros(3)
    if scene.gravity:
        pull[scene.gravity[0]] = scene.gravity[1]
    numbers, sensors = {}, []
    for b, body in enumerate(scene.bodies, 1):
        if body["held"]:
            numbers[b] = ground
            continue
        xx, yy, zz, xy, yz, xz = body["inertia"]
        inertia = RigidBodyInertia(mass=body["mass"], inertiaTensor=np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
        numbers[b] = system.CreateRigidBody(inertia=inertia, referencePosition=list(body["x"]), initialVelocity=list(body["speed"][:3]),
                                            initialAngularVelocity=list(body["speed"][3:]), gravity=list(pull))
        sensors.append((b, system.AddSensor(SensorBody(bodyNumber=numbers[b], storeInternal=True, writeToFile=False,
                                                       outputVariableType=exu.OutputVariableType.Position))))
    _, left = tree(scene)
    for link in scene.links:
        z = link["axis"]
        x = np.cross(z, [0, 0, 1] if abs(z[2]) < 0.9 else [1, 0, 0])
        frame = np.stack([x, np.cross(z, x), z], axis=1)
        markers = [system.AddMarker(MarkerBodyRigid(bodyNumber=numbers[b], localPosition=list(
            link["x"] - (0 if scene.bodies[b - 1]["held"] else scene.bodies[b - 1]["x"])))) for b in link["ends"]]
        axes = {scenes.REVOLUTE: [1, 1, 1, 1, 1, 0], scenes.SPHERICAL: [1, 1, 1, 0, 0, 0],
                scenes.TRANSLATIONAL: [1, 1, 0, 1, 1, 1]}[link["kind"]]
        if link in left:
            axes = [1, 1, 0, 0, 0, 0] if is_plane(scene) else [1, 1, 1, 1, 0, 0]
        system.AddObject(GenericJoint(markerNumbers=markers, constrainedAxes=axes, rotationMarker0=frame, rotationMarker1=frame))
        if any(link["law"]):
            stiff, damp = (np.zeros((6, 6)) for _ in range(2))
            stiff[2, 2], damp[2, 2] = link["law"]
            system.AddObject(RigidBodySpringDamper(markerNumbers=markers, stiffness=stiff, damping=damp, rotationMarker0=frame,
                                                   rotationMarker1=frame))
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = until / samples
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.numberOfSteps = samples * steps
    settings.timeIntegration.endTime = until
    settings.timeIntegration.generalizedAlpha.spectralRadius = radius
    settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = True
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.linearSolverType = exu.LinearSolverType.EXUdense if len(scene.bodies) < 12 else exu.LinearSolverType.EigenSparse
    begin = time.process_time()
    system.SolveDynamic(settings)
    spent = time.process_time() - begin
    places = np.tile(np.array([body["x"] for body in scene.bodies], float), (samples + 1, 1, 1))
    for b, sensor in sensors:
        places[:, b - 1] = system.GetSensorStoredData(sensor)[:, 1:4]
    return places, spent, samples * steps


PEERS = {"mujoco": mujoco, "exudyn": exudyn}
