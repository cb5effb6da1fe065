"""The robot's physics in PyBullet."""

import math

from .arena import Arena, Pose
from .bullet import BulletClient, silence
from .drive import MOTOR_TORQUE, STEP_RATE, Velocity, WheelPair
from .scene import build

_GRAVITY = 9.81

_SOFTNESS = 1e-9
"""Compliance of every constraint; without it the direct solver fails on singular matrices."""


class BulletPhysics:
    """`Physics` in a PyBullet client of its own."""

    def __init__(self, arena: Arena) -> None:
        """Build the arena and the robot, without output.

        Raises:
            WorldUnavailable: PyBullet cannot be used here; the text says what to do.
        """
        client = self._client = BulletClient()
        with silence():
            client.setGravity(0, 0, -_GRAVITY)
            client.setTimeStep(1 / STEP_RATE)
            # The direct solver is exact where the iterative one lets a standing robot creep.
            client.setPhysicsEngineParameter(
                deterministicOverlappingPairs=1,
                constraintSolverType=client.CONSTRAINT_SOLVER_LCP_DANTZIG,
                globalCFM=_SOFTNESS,
            )
            self._scene = build(client, arena)
            inertial_frame = client.getDynamicsInfo(self._scene.robot, -1)[3:5]
            self._base_in_inertial = client.invertTransform(*inertial_frame)
            self.turn_wheels(WheelPair(0.0, 0.0), MOTOR_TORQUE)
            for _ in range(STEP_RATE):
                client.stepSimulation()
            self._start: int = client.saveState()

    def step(self) -> None:
        self._client.stepSimulation()

    def turn_wheels(self, speeds: WheelPair, torque: float) -> None:
        self._client.setJointMotorControlArray(
            self._scene.robot,
            self._scene.wheels,
            self._client.VELOCITY_CONTROL,
            targetVelocities=speeds,
            forces=(torque, torque),
        )

    def pose(self) -> Pose:
        client = self._client
        inertial = client.getBasePositionAndOrientation(self._scene.robot)
        (x, y, _), orientation = client.multiplyTransforms(*inertial, *self._base_in_inertial)
        return Pose(x, y, client.getEulerFromQuaternion(orientation)[2])

    def velocity(self) -> Velocity:
        (x, y, _), (_, _, angular) = self._client.getBaseVelocity(self._scene.robot)
        yaw = self.pose().yaw
        return Velocity(x * math.cos(yaw) + y * math.sin(yaw), angular)

    def wheel_angles(self) -> WheelPair:
        left, right = self._client.getJointStates(self._scene.robot, self._scene.wheels)
        return WheelPair(left[0], right[0])

    def touching(self) -> bool:
        contacts = self._client.getContactPoints(bodyA=self._scene.robot)
        return any(contact[2] != self._scene.floor for contact in contacts)

    def reset(self) -> None:
        self._client.restoreState(self._start)

    def close(self) -> None:
        self._client.close()
