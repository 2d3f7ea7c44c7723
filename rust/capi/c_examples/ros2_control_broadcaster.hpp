// A controller of ros2_control that senses contacts, and publishes the wrench of the strongest one that is located.
//
// Parameters: `joints` (in the order of the robot's description), `urdf`, `calibration`, `rate` [Hz] of the controller manager.
// Add `contactsense` to the dependencies (pkg-config) and export the class as a plugin, as of any broadcaster.
#pragma once

#include <cmath>
#include <controller_interface/controller_interface.hpp>
#include <geometry_msgs/msg/wrench_stamped.hpp>
#include <memory>
#include <realtime_tools/realtime_publisher.hpp>
#include <string>
#include <vector>

#include "contactsense.hpp"

class ContactBroadcaster : public controller_interface::ControllerInterface {
  using CallbackReturn = controller_interface::CallbackReturn;
  using Wrench = geometry_msgs::msg::WrenchStamped;

 public:
  CallbackReturn on_init() override {
    auto_declare<std::vector<std::string>>("joints", {});
    auto_declare<std::string>("urdf", "");
    auto_declare<std::string>("calibration", "");
    auto_declare<double>("rate", 1000.0);
    return CallbackReturn::SUCCESS;
  }

  controller_interface::InterfaceConfiguration command_interface_configuration() const override {
    return {controller_interface::interface_configuration_type::NONE, {}};
  }

  // Positions, then velocities, then efforts.
  controller_interface::InterfaceConfiguration state_interface_configuration() const override {
    std::vector<std::string> names;
    for (const char *quantity : {"position", "velocity", "effort"}) {
      for (const auto &joint : joints_) names.push_back(joint + "/" + quantity);
    }
    return {controller_interface::interface_configuration_type::INDIVIDUAL, names};
  }

  // All memory is taken here.
  CallbackReturn on_configure(const rclcpp_lifecycle::State &) override {
    try {
      joints_ = get_node()->get_parameter("joints").as_string_array();
      robot_ = std::make_unique<contactsense::Robot>(get_node()->get_parameter("urdf").as_string());
      if (joints_ != robot_->joint_names() || robot_->nq() != joints_.size()) {
        RCLCPP_ERROR(get_node()->get_logger(), "joints: must be those of the URDF, in its order");
        return CallbackReturn::ERROR;
      }
      const contactsense::Calibration calibration(get_node()->get_parameter("calibration").as_string());
      contactsense::MonitorOptions options(1.0 / get_node()->get_parameter("rate").as_double());
      options.calibration = &calibration;
      monitor_ = std::make_unique<contactsense::Monitor>(*robot_, options);
    } catch (const contactsense::Error &error) {
      RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
      return CallbackReturn::ERROR;
    }
    values_.resize(3 * joints_.size());
    publisher_ = std::make_unique<realtime_tools::RealtimePublisher<Wrench>>(
        get_node()->create_publisher<Wrench>("~/contact", rclcpp::SystemDefaultsQoS()));
    // Of a robot on a fixed base, the world is the frame of its root link.
    publisher_->msg_.header.frame_id = robot_->link_name(0);
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_activate(const rclcpp_lifecycle::State &) override {
    monitor_->reset();
    return CallbackReturn::SUCCESS;
  }

  controller_interface::return_type update(const rclcpp::Time &time, const rclcpp::Duration &period) override {
    for (std::size_t k = 0; k < values_.size(); ++k) values_[k] = state_interfaces_[k].get_value();
    cs_sample sample{};
    sample.q = values_.data();
    sample.v = values_.data() + joints_.size();
    sample.tau = values_.data() + 2 * joints_.size();
    sample.dt = period.seconds();
    // A sample that is refused, such as one of NaN, counts as lost.
    if (monitor_->update(sample) != CS_OK) return controller_interface::return_type::OK;
    if (const cs_contact *contact = strongest(monitor_->report())) publish(*contact, time);
    return controller_interface::return_type::OK;
  }

 private:
  // Of the contacts whose place the torques determine; null if there is none.
  static const cs_contact *strongest(const contactsense::Report &report) {
    const cs_contact *found = nullptr;
    double largest = 0.0;
    for (const cs_contact &contact : report) {
      const double force = std::hypot(contact.force[0], contact.force[1], contact.force[2]);
      if (contact.located && force > largest) {  // false for NaN
        found = &contact;
        largest = force;
      }
    }
    return found;
  }

  // As a wrench about the origin of the frame, as tf2 expects it: the moment is point x force.
  void publish(const cs_contact &contact, const rclcpp::Time &time) {
    if (!publisher_->trylock()) return;  // the message before is still being sent
    Wrench &message = publisher_->msg_;
    message.header.stamp = time;
    const double *p = contact.point, *f = contact.force;
    message.wrench.force.x = f[0];
    message.wrench.force.y = f[1];
    message.wrench.force.z = f[2];
    message.wrench.torque.x = p[1] * f[2] - p[2] * f[1];
    message.wrench.torque.y = p[2] * f[0] - p[0] * f[2];
    message.wrench.torque.z = p[0] * f[1] - p[1] * f[0];
    publisher_->unlockAndPublish();
  }

  std::vector<std::string> joints_;
  std::unique_ptr<contactsense::Robot> robot_;
  std::unique_ptr<contactsense::Monitor> monitor_;
  std::unique_ptr<realtime_tools::RealtimePublisher<Wrench>> publisher_;
  std::vector<double> values_;
};
