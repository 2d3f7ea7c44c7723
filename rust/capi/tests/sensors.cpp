// A monitor with sensors of two kinds and a payload, on rows of a file: q, v, tau and two wrenches.
#include <cstdio>
#include <vector>

#include "contactsense.hpp"

int main(int argc, char **argv) try {
  if (argc != 3) return 2;
  const contactsense::Robot robot(argv[1]);
  const std::size_t nv = robot.nv();
  contactsense::MonitorOptions options(0.001);
  options.torque_threshold.assign(nv, 0.8);
  options.wrench_threshold = {3.0};
  options.numbers.bias_time_constant = 0.05;
  contactsense::Sensor wrist{"wrist", "iiwa_link_7"};
  wrist.rotation = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  wrist.translation = {0, 0, 0.02};
  wrist.offset = {0, 0, 3, 0, 0, 0};
  wrist.reads_support = true;
  wrist.wanted = true;
  options.sensors = {wrist, {"elbow", "iiwa_link_4"}};
  contactsense::Monitor made(robot, options);
  contactsense::Monitor monitor = std::move(made);
  monitor.set_payload("iiwa_link_7", 0.4, {0.0, 0.0, 0.1});
  try {
    monitor.set_payload("elbow", 0.4, {});
    return 3;
  } catch (const contactsense::Error &error) {
    if (error.status() != CS_ERROR_INPUT) return 4;
  }

  std::vector<double> row(3 * nv + 12);
  std::FILE *file = std::fopen(argv[2], "rb");
  if (!file) return 5;
  for (int tick = 0; std::fread(row.data(), sizeof(double), row.size(), file) == row.size(); ++tick) {
    if (tick == 50) {
      monitor.miss();
      continue;
    }
    if (tick == 300) monitor.clear_payload();
    cs_sample sample{};
    sample.q = row.data();
    sample.v = row.data() + nv;
    sample.tau = row.data() + 2 * nv;
    sample.wrenches = row.data() + 3 * nv;
    if (monitor.update(sample) != CS_OK) throw contactsense::Error(CS_ERROR_INPUT);
    const contactsense::Report &report = monitor.report();
    std::printf("%d", report.collision);
    for (std::size_t k = 0; k < nv; ++k) std::printf(" %a", report.external_torque[k]);
    for (std::size_t k = 0; k < nv; ++k) std::printf(" %a", report.collision_torque[k]);
    for (std::size_t k = 0; k < 12; ++k) std::printf(" %a", report.wrenches[k]);
    std::printf("\n");
  }
  std::fclose(file);
} catch (const contactsense::Error &error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
