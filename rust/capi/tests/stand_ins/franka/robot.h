// Stands in for libfranka: a robot whose measurements are the rows of a file, q, dq and tau_J.
#pragma once
#include <array>
#include <cstdio>
#include <functional>
#include <string>

#include "exception.h"

namespace franka {

struct Duration {
  double seconds;
  double toSec() const noexcept { return seconds; }
};

struct RobotState {
  std::array<double, 7> q{}, dq{}, tau_J{};
};

struct Torques {
  explicit Torques(const std::array<double, 7> &torques) noexcept : tau_J(torques) {}
  std::array<double, 7> tau_J;
  bool motion_finished = false;
};

inline Torques MotionFinished(Torques command) noexcept {
  command.motion_finished = true;
  return command;
}

class Robot {
 public:
  explicit Robot(const std::string &address) : file_(std::fopen(address.c_str(), "rb")) {
    if (!file_) throw Exception("no connection to " + address);
  }
  Robot(const Robot &) = delete;
  ~Robot() { std::fclose(file_); }

  void control(const std::function<Torques(const RobotState &, Duration)> &callback) {
    RobotState state;
    double period = 0.0;
    while (std::fread(&state, sizeof state, 1, file_) == 1) {
      const Torques command = callback(state, {period});
      for (double torque : command.tau_J) {
        if (torque != 0.0) throw Exception("a torque was commanded");
      }
      if (command.motion_finished) return;
      period = 0.001;
    }
    throw Exception("the rows are over");
  }

 private:
  std::FILE *file_;
};

}  // namespace franka
