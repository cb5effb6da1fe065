"""Templates of an ament_python package's files, with placeholders such as ``$package``."""

MANIFEST = """\
<?xml version="1.0"?>
<?xml-model href="http://download.ros.org/schema/package_format3.xsd" \
schematypens="http://www.w3.org/2001/XMLSchema"?>
<package format="3">
  <name>$package</name>
  <version>0.1.0</version>
  <description>$description</description>
  <maintainer email="cbtui@example.com">cbtui</maintainer>
  <license>Apache-2.0</license>
$depends
  <test_depend>python3-pytest</test_depend>
  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
"""

SETUP_CFG = """\
[develop]
script_dir=$$base/lib/$package
[install]
install_scripts=$$base/lib/$package
"""

SETUP_PY = '''\
"""Installs the nodes where ROS 2 looks for executables."""

from glob import glob

from setuptools import setup

package_name = "$package"

setup(
    name=package_name,
    version="0.1.0",
    packages=[package_name],
    data_files=[
        (
            "share/ament_index/resource_index/packages",
            ["resource/" + package_name],
        ),
        ("share/" + package_name, ["package.xml"]),
        ("share/" + package_name + "/launch", glob("launch/*.launch.py")),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=True,
    maintainer="cbtui",
    maintainer_email="cbtui@example.com",
    description=$description,
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
$entries
        ],
    },
)
'''

TEST = '''\
"""Every node of the package can be imported, and has a main() to start."""

from importlib import import_module

import pytest

MODULES = [
$modules
]


@pytest.mark.parametrize("module", MODULES)
def test_a_node_can_be_started(module):
    assert callable(import_module("$package." + module).main)
'''

LAUNCH = '''\
"""Starts $name."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription(
        [
            Node(
                package="$package",
                executable="$name",
                output="screen",
                emulate_tty=True,
            ),
        ]
    )
'''

LAUNCH_WITH_ARGUMENTS = '''\
"""Starts $name with the arguments of its lesson."""

from launch import LaunchDescription
${imports}${substitutions}from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription(
        [
${declarations}            Node(
                package="$package",
                executable="$name",
                output="screen",
                emulate_tty=True,
                arguments=[
$words
                ],
            ),
        ]
    )
'''
LAUNCH_ARGUMENT_IMPORTS = "from launch.actions import DeclareLaunchArgument\n"
SUBSTITUTION_IMPORTS = "from launch.substitutions import LaunchConfiguration\n"
DECLARATION = "            DeclareLaunchArgument({}, default_value={}),\n"

README = """\
# $package

$title

The nodes of these lessons as a ROS 2 package. Each file in `$package/` is the
node of one lesson, word for word.

## Build

Put this folder into the `src` folder of a workspace. Then, in the workspace:

```bash
rosdep install --from-paths src --ignore-src -y
colcon build --packages-select $package
source install/setup.bash
```

The first line installs what the nodes import, where it is missing. The last
one is needed again in every new terminal.

## Run

Each lesson is an executable, and has a launch file that starts it with the
lesson's arguments:

```bash
ros2 launch $package $first.launch.py
```
$launching$robot
## The lessons

$lessons
"""

LAUNCHING = """
To give an argument another value, name it; `--show-args` lists them all:

```bash
ros2 launch $package $name.launch.py $argument
ros2 launch $package $name.launch.py --show-args
```
"""

ROBOT = """
## The robot

In cbtui the robot is there from the start. Here you start one, or a simulator.
It has to publish what the nodes listen to, and to listen to what they publish;
`ros2 topic list` shows its names. Where they differ, map them:
`ros2 run … --ros-args -r scan:=/my_robot/scan`.

Speeds, distances and the number of the beam that looks straight ahead stand in
capitals at the top of each node. Set them to fit your robot.
"""

CALL = 'Call it: `ros2 service call {} {} "{{data: true}}"`'
