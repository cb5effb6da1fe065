"""What ``import sensor_msgs_py`` gives: helpers for the messages of sensor_msgs."""
