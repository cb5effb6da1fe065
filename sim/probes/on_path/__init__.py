"""What is put on the path of a program that runs on real ROS 2: nothing but the probe, and what starts it."""
