// Stands in for the message of ROS 2.
#pragma once
#include <string>
namespace geometry_msgs::msg {
struct Vector3 {
  double x, y, z;
};
struct Wrench {
  Vector3 force, torque;
};
struct WrenchStamped {
  struct {
    rclcpp::Time stamp;
    std::string frame_id;
  } header;
  Wrench wrench;
};
}  // namespace geometry_msgs::msg
