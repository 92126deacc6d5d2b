# SPDX-License-Identifier: Apache-2.0
"""Changes each field of each ROS message that is read: the table or the notes of `tactus export csv` must change.

  ros_fields.py PROGRAM   in an empty folder
"""
import subprocess
import sys

from ros_bag import Bag, about_z, odometry, pose, tf, twist, wrench

START = 1.7e9
FIELDS = {
    "tf.stamp": 0.003, "tf.frame": "elsewhere", "tf.child": "foot", "tf.at": (5, 0, 0), "tf.turn": about_z(2),
    "pose.stamp": 0.003, "pose.frame": "elsewhere", "pose.at": (5, 0, 0), "pose.turn": about_z(2),
    "twist.stamp": 0.003, "twist.frame": "elsewhere", "twist.linear": (0, 3, 0), "twist.angular": (0, 3, 0),
    "wrench.stamp": 0.003, "wrench.frame": "elsewhere", "wrench.force": (0, 7, 0), "wrench.torque": (1, 0, 0),
    "odom.stamp": 0.003, "odom.frame": "elsewhere", "odom.child": "base", "odom.at": (5, 0, 0), "odom.turn": about_z(2),
    "odom.linear": (0, 3, 0), "odom.angular": (0, 3, 0), "odom.covariance": 0.1, "odom.twist_covariance": 0.1}


def write(path, changed):
    bag = Bag()
    arm, speed, force = bag.channel("/arm/pose", "pose"), bag.channel("/arm/speed", "twist"), bag.channel("/ft/wrench", "wrench")
    robot, tree = bag.channel("/robot/odom", "odometry"), bag.channel("/tf", "tf")

    def fields(kind, **values):
        values = {name: changed.get(f"{kind}.{name}", value) for name, value in values.items()}
        values["stamp"] = time + changed.get(f"{kind}.stamp", 0)
        return values

    for i in range(30):
        time = START + i / 100
        base = fields("tf", frame="map", child="base", at=(0, 0, 1), turn=about_z(0.5))
        bag.add(tree, time, tf([base[name] for name in ("stamp", "frame", "child", "at", "turn")], (time, "map", "odom", (2, 0, 0), about_z(0.3))))
        bag.add(arm, time, pose(**fields("pose", frame="base", at=(0.1, i * 0.01, 0), turn=about_z(0.1))))
        bag.add(speed, time, twist(**fields("twist", frame="base", linear=(1, 0, 0), angular=(0, 0, 1))))
        bag.add(force, time, wrench(**fields("wrench", frame="base", force=(1, 0, 0), torque=(0, 0, 0))))
        bag.add(robot, time, odometry(**fields("odom", frame="odom", child="body", at=(0, 0, 0.5), turn=about_z(0.7), linear=(1, 0, 0),
                                               angular=(0, 0, 1), covariance=0.0, twist_covariance=0.0)))
    bag.write(path)


def result(program, changed):
    write("fields.mcap", changed)
    done = subprocess.run([program, "export", "csv", "fields.mcap"], capture_output=True, text=True, check=True)
    return done.stdout, done.stderr


if __name__ == "__main__":
    plain = result(sys.argv[1], {})
    same = [field for field, value in FIELDS.items() if result(sys.argv[1], {field: value}) == plain]
    print(f"{len(FIELDS) - len(same)} of {len(FIELDS)} fields matter or are reported as ignored", *same)
