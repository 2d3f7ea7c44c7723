// Runs the broadcaster of the examples on rows of a file, q, v and tau, and prints what it publishes.
#include "../c_examples/ros2_control_broadcaster.hpp"

#include <cstdio>

int main(int argc, char **argv) {
  if (argc != 4) return 2;
  using controller_interface::CallbackReturn;
  ContactBroadcaster controller;
  if (controller.on_init() != CallbackReturn::SUCCESS) return 3;
  const contactsense::Robot robot(argv[1]);
  auto &parameters = controller.get_node()->parameters;
  parameters["urdf"] = {std::string(argv[1])};
  parameters["calibration"] = {std::string("no_such_file.yaml")};
  parameters["joints"] = {robot.joint_names()};
  if (controller.on_configure({}) != CallbackReturn::ERROR) return 4;
  parameters["calibration"] = {std::string(argv[2])};
  parameters["joints"] = {std::vector<std::string>{"elbow"}};
  if (controller.on_configure({}) != CallbackReturn::ERROR) return 5;
  parameters["joints"] = {robot.joint_names()};
  if (controller.on_configure({}) != CallbackReturn::SUCCESS) return 6;
  if (controller.state_interface_configuration().names.at(7) != "iiwa_joint_1/velocity") return 7;

  std::vector<double> row(3 * robot.nv());
  for (const double &value : row) controller.state_interfaces_.push_back({&value});
  if (controller.on_activate({}) != CallbackReturn::SUCCESS) return 8;
  std::FILE *file = std::fopen(argv[3], "rb");
  if (!file) return 9;
  for (int tick = 0; std::fread(row.data(), sizeof(double), row.size(), file) == row.size(); ++tick) {
    controller.update({0.001 * tick}, {0.001});
  }
  std::fclose(file);
  using Sent = rclcpp::Publisher<geometry_msgs::msg::WrenchStamped>;
  for (const auto &message : std::static_pointer_cast<Sent>(controller.get_node()->publisher)->published) {
    const auto &[force, torque] = message.wrench;
    std::printf("%a %s", message.header.stamp.seconds, message.header.frame_id.c_str());
    std::printf(" %a %a %a %a %a %a\n", force.x, force.y, force.z, torque.x, torque.y, torque.z);
  }
}
