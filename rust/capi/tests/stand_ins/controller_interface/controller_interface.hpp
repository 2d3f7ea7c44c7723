// Stands in for ros2_control and rclcpp, as far as a broadcaster uses them.
#pragma once
#include <cstdarg>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace rclcpp {
struct Time {
  double seconds = 0.0;
};
struct Duration {
  double value;
  double seconds() const { return value; }
};
struct SystemDefaultsQoS {};
template <class Message>
struct Publisher {
  using SharedPtr = std::shared_ptr<Publisher>;
  std::vector<Message> published;
};
}  // namespace rclcpp

namespace rclcpp_lifecycle {
struct State {};
}  // namespace rclcpp_lifecycle

#define RCLCPP_ERROR(logger, ...) ((void)(logger), std::fprintf(stderr, __VA_ARGS__), std::fputc('\n', stderr))

namespace controller_interface {

using Value = std::variant<std::string, double, std::vector<std::string>>;

struct Parameter {
  Value value;
  std::string as_string() const { return std::get<std::string>(value); }
  double as_double() const { return std::get<double>(value); }
  std::vector<std::string> as_string_array() const { return std::get<std::vector<std::string>>(value); }
};

struct Node {
  std::map<std::string, Parameter> parameters;
  std::shared_ptr<void> publisher;

  Parameter get_parameter(const std::string &name) const { return parameters.at(name); }
  int get_logger() const { return 0; }
  template <class Message>
  std::shared_ptr<rclcpp::Publisher<Message>> create_publisher(const std::string &, rclcpp::SystemDefaultsQoS) {
    auto made = std::make_shared<rclcpp::Publisher<Message>>();
    publisher = made;
    return made;
  }
};

struct StateInterface {
  const double *value;
  double get_value() const { return *value; }
};

enum class interface_configuration_type { NONE, INDIVIDUAL };
struct InterfaceConfiguration {
  interface_configuration_type type;
  std::vector<std::string> names;
};
enum class return_type { OK, ERROR };
enum class CallbackReturn { SUCCESS, ERROR };

class ControllerInterface {
 public:
  virtual ~ControllerInterface() = default;
  using CallbackReturn = controller_interface::CallbackReturn;
  virtual CallbackReturn on_init() = 0;
  virtual InterfaceConfiguration command_interface_configuration() const = 0;
  virtual InterfaceConfiguration state_interface_configuration() const = 0;
  virtual CallbackReturn on_configure(const rclcpp_lifecycle::State &) = 0;
  virtual CallbackReturn on_activate(const rclcpp_lifecycle::State &) = 0;
  virtual return_type update(const rclcpp::Time &, const rclcpp::Duration &) = 0;
  std::shared_ptr<Node> get_node() const { return node_; }

  std::vector<StateInterface> state_interfaces_;

 protected:
  template <class T>
  void auto_declare(const std::string &name, const T &value) {
    node_->parameters.insert({name, Parameter{value}});
  }

 private:
  std::shared_ptr<Node> node_ = std::make_shared<Node>();
};

}  // namespace controller_interface
