// The C interface of contactsense for C++17: objects that free themselves, and errors as exceptions.
//
// All of it is in this file; programs link the library of the C interface.
#ifndef CONTACTSENSE_HPP
#define CONTACTSENSE_HPP

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "contactsense.h"

namespace contactsense {

// What a call refused, with its status.
class Error : public std::runtime_error {
 public:
  explicit Error(cs_status status) : std::runtime_error(cs_error_message()), status_(status) {}
  cs_status status() const noexcept { return status_; }

 private:
  cs_status status_;
};

namespace detail {

inline void check(cs_status status) {
  if (status != CS_OK) throw Error(status);
}

template <class T, void (*Free)(T *)>
struct Deleter {
  void operator()(T *object) const noexcept { Free(object); }
};

template <class T, void (*Free)(T *)>
using Owned = std::unique_ptr<T, Deleter<T, Free>>;

}  // namespace detail

// A robot. It does not change: any number of threads may use it.
class Robot {
 public:
  explicit Robot(const std::string &urdf, const std::vector<std::string> &package_dirs = {},
                 bool floating_base = false) {
    std::vector<const char *> folders;
    for (const auto &folder : package_dirs) folders.push_back(folder.c_str());
    cs_urdf_options options{};
    options.package_dirs = folders.empty() ? nullptr : folders.data();
    options.package_dir_count = folders.size();
    options.floating_base = floating_base;
    cs_robot *made = nullptr;
    detail::check(cs_robot_from_urdf(urdf.c_str(), &options, &made));
    robot_.reset(made);
  }

  std::size_t nq() const noexcept { return cs_robot_nq(get()); }
  std::size_t nv() const noexcept { return cs_robot_nv(get()); }
  // Numbers in a motor torque: without those of a floating base.
  std::size_t ntau() const noexcept { return cs_robot_ntau(get()); }
  std::vector<std::string> joint_names() const { return names(cs_robot_joint_name); }
  std::vector<std::string> link_names() const { return names(cs_robot_link_name); }
  // What is unusual about the description.
  std::vector<std::string> warnings() const { return names(cs_robot_warning); }
  // The name of a contact's link; it lives as long as the robot.
  const char *link_name(std::size_t link) const noexcept { return cs_robot_link_name(get(), link); }
  const cs_robot *get() const noexcept { return robot_.get(); }

 private:
  std::vector<std::string> names(const char *(*name)(const cs_robot *, std::size_t)) const {
    std::vector<std::string> found;
    while (const char *text = name(get(), found.size())) found.emplace_back(text);
    return found;
  }

  detail::Owned<cs_robot, cs_robot_free> robot_;
};

// What motion without contact taught of one robot, from the file of `contactsense calibrate`.
class Calibration {
 public:
  explicit Calibration(const std::string &path) {
    cs_calibration *made = nullptr;
    detail::check(cs_calibration_load(path.c_str(), &made));
    calibration_.reset(made);
  }

  const cs_calibration *get() const noexcept { return calibration_.get(); }

 private:
  detail::Owned<cs_calibration, cs_calibration_free> calibration_;
};

// A force/torque sensor where a link joins its parent; the fields are those of `cs_sensor`.
struct Sensor {
  std::string name;
  std::string link;
  std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 3> translation{};
  bool reads_support = false;
  bool wanted = false;
  std::array<double, 6> offset{};
};

// A point at which contacts are meant, in the link's frame (m).
struct WantedPoint {
  std::string link;
  std::array<double, 3> point{};
};

// How a monitor works; the numbers are those of `cs_monitor_options`.
struct MonitorOptions {
  explicit MonitorOptions(double dt) : numbers(cs_monitor_options_default(dt)) {}

  // All but what stands below, which takes the place of its pointers.
  cs_monitor_options numbers;
  // Of this robot, or null; it need not outlive the making of the monitor.
  const Calibration *calibration = nullptr;
  std::vector<double> torque_threshold;
  std::vector<double> wrench_threshold;
  std::vector<Sensor> sensors;
  std::vector<WantedPoint> wanted_points;
};

// The report of a tick: the fields of `cs_report`, with room for its numbers.
class Report : public cs_report {
 public:
  Report(std::size_t nv, std::size_t sensor_count)
      : cs_report{}, torque_(nv, NAN), collision_(nv, NAN), sensed_(6 * sensor_count, NAN) {
    external_torque = torque_.data();
    collision_torque = collision_.data();
    wrenches = sensed_.data();
  }
  Report(const Report &) = delete;
  Report &operator=(const Report &) = delete;

  const cs_contact *begin() const noexcept { return contacts; }
  const cs_contact *end() const noexcept { return contacts + contact_count; }

 private:
  std::vector<double> torque_, collision_, sensed_;
};

// The sense of touch of one robot, called once a control tick. One thread at a time may use it.
class Monitor {
 public:
  Monitor(const Robot &robot, const MonitorOptions &options)
      : report_(std::make_unique<Report>(robot.nv(), options.sensors.size())) {
    cs_monitor_options given = options.numbers;
    given.calibration = options.calibration ? options.calibration->get() : nullptr;
    given.torque_threshold = options.torque_threshold.empty() ? nullptr : options.torque_threshold.data();
    given.torque_threshold_count = options.torque_threshold.size();
    given.wrench_threshold = options.wrench_threshold.empty() ? nullptr : options.wrench_threshold.data();
    given.wrench_threshold_count = options.wrench_threshold.size();
    std::vector<cs_sensor> sensors;
    for (const auto &sensor : options.sensors) {
      cs_sensor one = cs_sensor_default(sensor.name.c_str(), sensor.link.c_str());
      for (std::size_t k = 0; k < 9; ++k) one.rotation[k] = sensor.rotation[k];
      for (std::size_t k = 0; k < 3; ++k) one.translation[k] = sensor.translation[k];
      for (std::size_t k = 0; k < 6; ++k) one.offset[k] = sensor.offset[k];
      one.reads_support = sensor.reads_support;
      one.wanted = sensor.wanted;
      sensors.push_back(one);
    }
    given.sensors = sensors.empty() ? nullptr : sensors.data();
    given.sensor_count = sensors.size();
    std::vector<cs_wanted_point> points;
    for (const auto &place : options.wanted_points) {
      points.push_back({place.link.c_str(), {place.point[0], place.point[1], place.point[2]}});
    }
    given.wanted_points = points.empty() ? nullptr : points.data();
    given.wanted_point_count = points.size();
    cs_monitor *made = nullptr;
    detail::check(cs_monitor_new(robot.get(), &given, &made));
    monitor_.reset(made);
  }

  // Takes in a tick: no memory is allocated and nothing is thrown. The status says whether the sample was refused; the
  // report is then that of the tick before. What stands in `sample` is as in `cs_sample`.
  cs_status update(const cs_sample &sample) noexcept {
    return cs_monitor_update(monitor_.get(), &sample, report_.get());
  }
  // The same with an external torque that the robot's controller estimates, in `tau`.
  cs_status update_external(const cs_sample &sample) noexcept {
    return cs_monitor_update_external(monitor_.get(), &sample, report_.get());
  }
  // The sample of a tick is lost.
  cs_status miss(double dt = 0.0) noexcept { return cs_monitor_miss(monitor_.get(), dt); }
  // What the monitor said of the last tick.
  const Report &report() const noexcept { return *report_; }

  // What is measured now is free of contact.
  void tare() { detail::check(cs_monitor_tare(monitor_.get())); }
  // A payload that the description lacks (kg, m in the link's frame). Not for the control loop.
  void set_payload(const std::string &link, double mass, const std::array<double, 3> &com) {
    detail::check(cs_monitor_set_payload(monitor_.get(), link.c_str(), mass, com.data()));
  }
  void clear_payload() { detail::check(cs_monitor_clear_payload(monitor_.get())); }
  // Forgets all ticks.
  void reset() { detail::check(cs_monitor_reset(monitor_.get())); }
  cs_monitor *get() noexcept { return monitor_.get(); }

 private:
  std::unique_ptr<Report> report_;
  detail::Owned<cs_monitor, cs_monitor_free> monitor_;
};

}  // namespace contactsense

#endif  // CONTACTSENSE_HPP
