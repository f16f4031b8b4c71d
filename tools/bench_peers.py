"""A step of other programs for chains of balls in a row, where this Python has them.

Exudyn: explicit Lie group step of RigidBody3D with penalty joints (RigidBodySpringDamper), the same stiffness.
MuJoCo: Euler step of a tree of ball joints, which has no stiffness: fewer unknowns, longer steps.
"""
import importlib.util
import os
import time

LENGTH, MASS, INERTIA, KN = 0.1, 0.2, (2e-5, 1.8e-4, 2e-4), 1.0e6
SECONDS = 0.5
MOST = 100                                         # MuJoCo nests no deeper, Exudyn multiplies whole matrices


def found(joints):
    """Names of the programs that can be measured at a chain of so many joints"""
    return [name for name in PEERS if joints <= MOST and importlib.util.find_spec(name)]


def step_us(name, joints):
    """us of processor time a step of a chain"""
    return PEERS[name](joints)


def per_step(advance, steps):
    """us a step of `advance(steps)`, that of the start not counted"""
    advance(steps)
    while True:
        begin = time.process_time()
        advance(steps)
        spent = time.process_time() - begin
        if spent > SECONDS:
            return 1e6*spent/steps
        steps = int(1 + steps*max(2.0, 1.2*SECONDS/max(spent, 1e-3)))


def mujoco(joints):
    import mujoco as m
    body = "".join(f'<body pos="{LENGTH if k else 0} 0 0"><joint type="ball"/><inertial pos="{LENGTH/2} 0 0" mass="{MASS}" '
                   f'diaginertia="{INERTIA[0]} {INERTIA[1]} {INERTIA[2]}"/>' for k in range(joints)) + "</body>"*joints
    model = m.MjModel.from_xml_string(f'<mujoco><option timestep="1e-4" integrator="Euler"><flag contact="disable"/></option>'
                                      f'<worldbody>{body}</worldbody></mujoco>')
    data = m.MjData(model)

    return per_step(lambda steps: m.mj_step(model, data, steps), 1000)


def exudyn(joints):
    import exudyn as exu
    import numpy as np
    from exudyn.itemInterface import MarkerBodyRigid, NodeRigidBodyRotVecLG, ObjectConnectorRigidBodySpringDamper, \
        ObjectGround, ObjectRigidBody
    system = exu.SystemContainer().AddSystem()
    last = system.AddMarker(MarkerBodyRigid(bodyNumber=system.AddObject(ObjectGround()), localPosition=[0, 0, 0]))
    for k in range(joints):
        node = system.AddNode(NodeRigidBodyRotVecLG(referenceCoordinates=[LENGTH*(k + 0.5), 0, 0, 0, 0, 0]))
        body = system.AddObject(ObjectRigidBody(physicsMass=MASS, physicsInertia=[*INERTIA, 0, 0, 0], nodeNumber=node))
        left, right = (system.AddMarker(MarkerBodyRigid(bodyNumber=body, localPosition=[x, 0, 0]))
                       for x in (-LENGTH/2, LENGTH/2))
        system.AddObject(ObjectConnectorRigidBodySpringDamper(markerNumbers=[last, left],
                                                              stiffness=np.diag([KN, KN, KN, 0, 0, 0]),
                                                              damping=np.zeros((6, 6))))
        last = right
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.solutionSettings.writeSolutionToFile = False
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.explicitIntegration.useLieGroupIntegration = True

    def advance(steps):
        settings.timeIntegration.numberOfSteps = steps
        settings.timeIntegration.endTime = 1e-6*steps
        system.SolveDynamic(settings, solverType=exu.DynamicSolverType.VelocityVerlet)

    return per_step(advance, 1000)


PEERS = {"exudyn": exudyn, "mujoco": mujoco}
os.environ.setdefault("OMP_NUM_THREADS", "1")
