# SPDX-License-Identifier: BSD-3-Clause
"""The node over ROS 1, with rosmaster, rospy as robot and teleoperation, and rostopic."""

import json
import math
import os
import shutil
import socket
import subprocess
import threading
import time

import pytest

NODE = os.environ["KEEPOUT_ROS1_NODE"]
try:
    import genpy.dynamic
    import rospy
    from geometry_msgs.msg import PoseStamped
    from sensor_msgs.msg import JointState
    from std_msgs.msg import Bool, String
    from visualization_msgs.msg import Marker

    import rosgraph
    import rostopic
except ImportError as error:
    pytest.skip(f"needs python3-rospy and more: {error}", allow_module_level=True)

if shutil.which("rosmaster") is None:
    pytest.skip("there is no rosmaster: needs python3-rosmaster", allow_module_level=True)

import keepout

TOOL_RADIUS, MARGIN, TOP_SPEED, PERIOD = 1.0, 2.0, 200.0, 0.001  # [mm], [mm/s], [s]
TRANSLATION = (11.0, -7.0, 150.0)  # from the robot's origin to that of the mesh [mm]
PATIENCE = 5.0  # for what takes milliseconds [s]

# CRTK's definition. genpy computes the sum of its fields, by which publishers and subscribers match.
OPERATING_STATE = """std_msgs/Header header
string state
bool is_homed
bool is_busy
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
"""
OperatingState = genpy.dynamic.generate_dynamic("crtk_msgs/operating_state", OPERATING_STATE)["crtk_msgs/operating_state"]


def cube():
    """Returns a cube with sides of 40 mm around the origin, as the text of an OBJ file."""
    corners = [f"v {x} {y} {z}" for z in (-20, 20) for y in (-20, 20) for x in (-20, 20)]
    faces = ["1 3 4", "1 4 2", "5 6 8", "5 8 7", "1 2 6", "1 6 5", "3 7 8", "3 8 4", "1 5 7", "1 7 3", "2 4 8", "2 8 6"]
    return "\n".join(corners + ["f " + face for face in faces]) + "\n"


def to_robot(point):
    return [(p - t) / 1000.0 for p, t in zip(point, TRANSLATION)]


def to_mesh(point):
    return [1000.0 * p + t for p, t in zip(point, TRANSLATION)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ros1")
    (folder / "cube.obj").write_text(cube())
    matrix = [[1, 0, 0, TRANSLATION[0]], [0, 1, 0, TRANSLATION[1]], [0, 0, 1, TRANSLATION[2]], [0, 0, 0, 1]]
    (folder / "registration.json").write_text(json.dumps({"unit": "mm", "mesh_from_robot": matrix}))
    return folder


@pytest.fixture(scope="module")
def master(folder):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    os.environ.update(ROS_MASTER_URI=f"http://127.0.0.1:{port}", ROS_IP="127.0.0.1", ROS_LOG_DIR=str(folder / "log"))
    os.environ.pop("ROS_HOSTNAME", None)
    with (folder / "master.txt").open("w") as said:
        process = subprocess.Popen(["rosmaster", "--core", "-p", str(port)], stdout=said, stderr=said)
    end = time.time() + PATIENCE
    while not rosgraph.is_master_online() and time.time() < end:
        time.sleep(0.02)
    rospy.init_node("peer", anonymous=True, disable_signals=True)
    yield os.environ["ROS_MASTER_URI"]
    rospy.signal_shutdown("the tests have ended")
    process.terminate()
    process.wait()


def arguments(folder, *more):
    return [NODE, f"--registration={folder}/registration.json", "--silence=0.25", "--tool-radius=1", *more]


class Robot:
    """A robot and a teleoperation. Equal consecutive setpoints are stored once."""

    def __init__(self):
        self.pose, self.goal, self.setpoints, self.received = None, None, [], 0
        self.reason, self.state, self.seen = "", "", None
        self.lock = threading.Lock()
        self.state_out = rospy.Publisher("/PSM1/operating_state", OperatingState, queue_size=1, latch=True)
        self.measured_cp = rospy.Publisher("/PSM1/measured_cp", PoseStamped, queue_size=1, tcp_nodelay=True)
        self.setpoint_cp = rospy.Publisher("/PSM1/setpoint_cp", PoseStamped, queue_size=1, tcp_nodelay=True)
        self.servo_cp = rospy.Publisher("/keepout/PSM1/servo_cp", PoseStamped, queue_size=1, tcp_nodelay=True)
        self.servo_jp = rospy.Publisher("/keepout/PSM1/servo_jp", JointState, queue_size=1)
        self.engage_out = rospy.Publisher("/keepout/PSM1/engage", Bool, queue_size=1)
        self.inputs = [
            rospy.Subscriber("/PSM1/servo_cp", PoseStamped, self.on_servo_cp, tcp_nodelay=True),
            rospy.Subscriber("/keepout/PSM1/measured_cp", PoseStamped, self.on_measured_cp, tcp_nodelay=True),
            rospy.Subscriber("/keepout/PSM1/reason", String, lambda text: setattr(self, "reason", text.data)),
            rospy.Subscriber("/keepout/PSM1/operating_state", OperatingState, lambda m: setattr(self, "state", m.state)),
        ]

    def on_servo_cp(self, pose):
        with self.lock:
            self.received += 1
            point = (pose.pose.position.x, pose.pose.position.y, pose.pose.position.z)
            if not self.setpoints or self.setpoints[-1] != point:
                self.setpoints.append(point)

    def on_measured_cp(self, pose):
        self.seen = [pose.pose.position.x, pose.pose.position.y, pose.pose.position.z]

    def forget(self):
        with self.lock:
            self.setpoints, self.received = [], 0

    @staticmethod
    def at(point, stamp=None, frame="PSM1_base", orientation=(0, 0, 0, 1)):
        message = PoseStamped()
        message.header.stamp = rospy.Time.from_sec(time.time()) if stamp is None else stamp
        message.header.frame_id = frame
        message.pose.position.x, message.pose.position.y, message.pose.position.z = point
        q = message.pose.orientation
        q.x, q.y, q.z, q.w = orientation
        return message

    def play(self, condition, longest=PATIENCE):
        """Is robot and teleoperation until the condition holds. Returns if it holds in time."""
        end = time.time() + longest
        while time.time() < end:
            if condition():
                return True
            if self.setpoints:
                self.pose = self.setpoints[-1]
            self.measured_cp.publish(self.at(self.pose))
            self.setpoint_cp.publish(self.at(self.pose))
            if self.goal:
                self.servo_cp.publish(self.goal())
            time.sleep(0.002)
        return False

    def set_state(self, state, is_homed=True):
        self.state_out.publish(OperatingState(state=state, is_homed=is_homed))

    def engage(self):
        self.set_state("ENABLED")
        self.forget()
        # The node must know where the robot is now.
        assert self.play(lambda: self.state == "PAUSED" and self.seen == list(self.pose)), self.reason
        self.play(lambda: False, 0.03)
        asked = [0.0]

        def is_engaged():
            if self.state != "ENABLED" and time.time() > asked[0] + 0.3:
                self.engage_out.publish(Bool(True))
                asked[0] = time.time()
            return self.state == "ENABLED" and self.received > 0

        assert self.play(is_engaged), self.reason

    def release(self):
        self.goal = None
        self.engage_out.publish(Bool(False))
        assert self.play(lambda: self.state == "PAUSED"), self.reason


@pytest.fixture(scope="module")
def robot(master, folder):
    with (folder / "node.txt").open("w") as said:
        # Options on the command line and as parameters of the node.
        process = subprocess.Popen(
            [*arguments(folder), f"_mesh:={folder}/cube.obj", "_arm:=PSM1", f"_margin:={MARGIN}"],
            stdout=said, stderr=said)
    robot = Robot()
    robot.pose = to_robot((0, 0, 30))
    robot.process = process
    yield robot
    process.terminate()
    assert process.wait(PATIENCE) == 0
    assert "cycles by status: guarded" in (folder / "node.txt").read_text()


def test_the_type_of_the_operating_state_is_that_of_crtk(robot):
    robot.play(lambda: robot.reason.startswith("not_ready"))
    assert robot.reason.startswith("not_ready"), robot.reason
    assert OperatingState._md5sum == "b1bd4021639d9d9c5fbfff78d6ff3158"
    assert robot.play(lambda: robot.state_out.get_num_connections() == 1)


def direct_setpoints(guard, start, goal, count):
    """Yields the setpoints of a motion constraint at the top speed. [mm]"""
    proxy = start
    for _ in range(count):
        yield proxy
        desired = [g - p for g, p in zip(goal, proxy)]
        distance = math.sqrt(desired[0] ** 2 + (desired[1] ** 2 + desired[2] ** 2))
        radius = 5.0  # of the motion sphere
        if distance > radius:
            desired = [d * (radius / distance) for d in desired]
        motion = [float(m) for m in guard.step(proxy, desired).motion]
        length = math.sqrt(motion[0] ** 2 + (motion[1] ** 2 + motion[2] ** 2))
        fraction = min(1.0, TOP_SPEED * PERIOD / length) if length > 0.0 else 1.0
        arrives = distance <= radius and fraction == 1.0 and motion == desired
        proxy = goal if arrives else [p + fraction * m for p, m in zip(proxy, motion)]


def test_setpoints_are_bitwise_those_of_a_direct_constraint(robot, folder):
    guard = keepout.MotionConstraint(keepout.load_mesh(folder / "cube.obj"), tool_radius=TOOL_RADIUS, margin=MARGIN)
    compared, lowest = 0, math.inf
    # Straight down on the cube; down and along it; away from it.
    for start, goal in [((1, 2, 40), (1, 2, 15)), ((-12, 3, 26), (12, 3, 12)), ((3, 4, 24), (3, 4, 45))]:
        robot.pose = to_robot(start)
        first, last = to_robot(start), to_robot(goal)
        robot.engage()
        robot.goal = lambda: robot.at(last)
        robot.play(lambda: len(robot.setpoints) >= 100, 0.6)
        robot.release()
        # A slow reader loses setpoints, so those that came are a part of these.
        expected = direct_setpoints(guard, to_mesh(first), to_mesh(last), 400)
        for setpoint in robot.setpoints:
            for point in expected:
                if to_robot(point) == list(setpoint):  # bitwise: no tolerance
                    break
            else:
                pytest.fail(f"{setpoint} is no setpoint of the direct constraint")
            lowest = min(lowest, point[2])
        assert len(robot.setpoints) > 50, robot.reason
        compared += len(robot.setpoints)
    assert compared > 150
    # The tool was held at the required clearance of 3 mm above the cube, whose top is at 20 mm.
    assert lowest == pytest.approx(23, abs=1e-9)


def test_it_stands_still_with_a_reason_for_every_wrong_message(robot):
    robot.pose = to_robot((0, 0, 30))
    robot.engage()
    good = to_robot((0, 0, 29.9))
    bad = to_robot((0, 0, 29))
    robot.goal = lambda: robot.at(good)
    assert robot.play(lambda: len(robot.setpoints) >= 2 and robot.reason.startswith("guarded")), robot.reason

    def expect_still(status, goal):
        moved = len(robot.setpoints)
        robot.goal = goal
        assert robot.play(lambda: robot.reason.startswith(status + ":")), (status, robot.reason)
        robot.play(lambda: False, 0.02)
        assert len(robot.setpoints) == moved, status
        robot.goal = lambda: robot.at(good)
        assert robot.play(lambda: robot.reason.startswith("guarded")), robot.reason

    expect_still("other_frame", lambda: robot.at(bad, frame="ECM"))
    expect_still("invalid_pose", lambda: robot.at(bad, orientation=(0, 0, 0, 0)))
    expect_still("invalid_pose", lambda: robot.at(bad, orientation=(0.6, 0, 0, 0.9)))
    expect_still("invalid_pose", lambda: robot.at((math.nan, 0, 0)))
    expect_still("stale", lambda: robot.at(bad, stamp=rospy.Time.from_sec(time.time() - 1)))
    expect_still("stale", lambda: robot.at(bad, stamp=rospy.Time(0)))  # CRTK marks invalid data so
    expect_still("too_far", lambda: robot.at(to_robot((0, 0, 129))))

    def joints():
        robot.servo_jp.publish(JointState(position=[1, 2, 3]))
        return robot.at(good)
    expect_still("wrong_command", joints)

    # Another publisher of the robot's commands: then nothing is sent.
    other = rospy.Publisher("/PSM1/servo_cp", PoseStamped, queue_size=1)
    assert robot.play(lambda: robot.reason.startswith("contested:")), robot.reason
    robot.goal = lambda: robot.at(bad)
    robot.play(lambda: False, 0.03)
    robot.forget()
    robot.play(lambda: False, 0.03)
    assert robot.received == 0
    robot.goal = lambda: robot.at(good)
    other.unregister()
    assert robot.play(lambda: robot.reason.startswith("guarded")), robot.reason

    # A robot that is not ready releases the session, which stays released.
    robot.set_state("ENABLED", is_homed=False)
    assert robot.play(lambda: robot.reason.startswith("not_ready:")), robot.reason
    robot.set_state("ENABLED")
    assert robot.play(lambda: robot.reason.startswith("not_engaged:")), robot.reason
    assert robot.state == "PAUSED"


def test_rviz_gets_the_mesh_and_the_triangles_and_planes_that_limit_the_tip(robot):
    shapes = {}
    topics = [rospy.Subscriber("/keepout/PSM1/shapes/" + name, Marker, lambda m: shapes.update({m.ns: m}))
              for name in ("mesh", "limits")]
    robot.pose = to_robot((3, 2, 23.1))
    robot.engage()
    robot.goal = lambda: robot.at(to_robot((3, 2, 15)))
    assert robot.play(lambda: "mesh" in shapes and "planes" in shapes and shapes["planes"].points), shapes.keys()
    mesh, triangles, planes = shapes["mesh"], shapes["triangles"], shapes["planes"]
    # Nothing limits a tip that is at its goal, a millimeter higher.
    robot.goal = lambda: robot.at(to_robot((3, 2, 24)))
    assert robot.play(lambda: not shapes["planes"].points)
    robot.release()
    assert (mesh.type, len(mesh.points)) == (Marker.TRIANGLE_LIST, 36)
    assert {m.header.frame_id for m in shapes.values()} == {"PSM1_base"}
    assert all(abs(p.z - to_robot((0, 0, 20))[2]) < 1e-12 for p in triangles.points) and triangles.points
    # A plane of the tip is at the required clearance of 3 mm above the top.
    assert all(abs(p.z - to_robot((0, 0, 23))[2]) < 1e-9 for p in planes.points) and len(planes.points) == 8
    for topic in topics:
        topic.unregister()


def test_rostopic_sees_the_types_of_crtk(robot):
    for topic, kind in {"/PSM1/servo_cp": "geometry_msgs/PoseStamped",
                        "/keepout/PSM1/measured_cp": "geometry_msgs/PoseStamped",
                        "/keepout/PSM1/operating_state": "crtk_msgs/operating_state",
                        "/keepout/PSM1/reason": "std_msgs/String"}.items():
        assert rostopic.get_topic_type(topic)[0] == kind


def test_without_a_master_it_ends_with_a_message(folder):
    with socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        uri = f"http://127.0.0.1:{closed.getsockname()[1]}"
        run = subprocess.run([*arguments(folder), f"--mesh={folder}/cube.obj", "--arm=PSM1"], capture_output=True,
                             text=True, timeout=PATIENCE, env={**os.environ, "ROS_MASTER_URI": uri})
    assert run.returncode == 1
    assert f"no ROS master answers at {uri}" in run.stderr


