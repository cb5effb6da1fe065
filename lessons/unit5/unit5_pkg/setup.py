"""Installs the nodes of unit 5 where ROS 2 looks for executables."""

from glob import glob

from setuptools import setup

package_name = "unit5_pkg"

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
    zip_safe=True,
    maintainer="cbtui",
    maintainer_email="cbtui@example.com",
    description="Callback groups and executors",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "exercise51 = unit5_pkg.exercise51:main",
            "exercise52 = unit5_pkg.exercise52:main",
            "exercise53 = unit5_pkg.exercise53:main",
            "callback_groups_examples = "
            "unit5_pkg.callback_groups_examples:main",
        ],
    },
)
