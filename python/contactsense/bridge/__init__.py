"""Contacts of a robot whose joint states come as messages of ROS 2 or Zenoh; see `docs/bridge.md`.

The process of `contactsense bridge` reads a configuration (`read_configuration.py`), takes in joint states
(`node.py`) and publishes what it finds, by Zenoh (`zenoh_transport.py`) or by `rclpy` (`ros2_transport.py`).
"""
