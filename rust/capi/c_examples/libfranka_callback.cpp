// Stops a Franka arm at the first contact: a monitor inside libfranka's control callback, at 1 kHz.
//
//     c++ -std=c++17 libfranka_callback.cpp $(pkg-config --cflags --libs contactsense) -lfranka -o stop_at_contact
//     ./stop_at_contact 172.16.0.2 panda.urdf panda.yaml
//
// No safety function: the arm's own limits and stops stay what protects people.
#include <franka/exception.h>
#include <franka/robot.h>

#include <cstdio>

#include "contactsense.hpp"

int main(int argc, char **argv) try {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s HOST URDF CALIBRATION\n", argv[0]);
    return 2;
  }
  const contactsense::Robot model(argv[2]);
  const contactsense::Calibration calibration(argv[3]);
  contactsense::MonitorOptions options(0.001);
  options.calibration = &calibration;
  contactsense::Monitor monitor(model, options);

  franka::Robot robot(argv[1]);
  std::size_t refused = 0;
  robot.control([&](const franka::RobotState &state, franka::Duration period) -> franka::Torques {
    // libfranka adds gravity to what is commanded, and measures it with the rest in tau_J.
    const franka::Torques still{{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}};
    cs_sample sample{};
    sample.q = state.q.data();
    sample.v = state.dq.data();
    sample.tau = state.tau_J.data();
    sample.dt = period.toSec();  // 0 in the first call, which is what the options say
    if (monitor.update(sample) != CS_OK) {
      ++refused;
      return still;
    }
    return monitor.report().onset ? franka::MotionFinished(still) : still;
  });

  // The loop is over: printing may take its time.
  const contactsense::Report &report = monitor.report();
  std::printf("contact at %.3f s, %zu samples refused\n", report.time, refused);
  for (const cs_contact &contact : report) {
    std::printf("%s, probability %.2f%s\n", model.link_name(contact.link), contact.probability,
                contact.located ? ", located" : "");
  }
  return 0;
} catch (const franka::Exception &error) {
  std::fprintf(stderr, "libfranka: %s\n", error.what());
  return 1;
} catch (const contactsense::Error &error) {
  std::fprintf(stderr, "contactsense: %s\n", error.what());
  return 1;
}
