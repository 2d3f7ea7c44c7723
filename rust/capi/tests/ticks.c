// Times the ticks of a monitor on the rows of a file (q, v and tau): ticks URDF ROWS CALIBRATION REPEATS. Prints the fastest of
// all repeats for each tick, in nanoseconds, as examples/ticks.rs does without the C interface.
#define _POSIX_C_SOURCE 199309L
#include <stdint.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "contactsense.h"

static uint64_t now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

int main(int argc, char **argv) {
  cs_robot *robot;
  cs_calibration *calibration;
  cs_monitor *monitor;
  cs_monitor_options options = cs_monitor_options_default(0.001);
  if (argc != 5 || cs_robot_from_urdf(argv[1], NULL, &robot) != CS_OK) return 2;
  if (cs_calibration_load(argv[3], &calibration) != CS_OK) return 3;
  options.calibration = calibration;
  if (cs_monitor_new(robot, &options, &monitor) != CS_OK) return 4;
  FILE *file = fopen(argv[2], "rb");
  if (!file || fseek(file, 0, SEEK_END)) return 5;
  const size_t nv = cs_robot_nv(robot), size = (size_t)ftell(file), count = size / (3 * nv * sizeof(double));
  double *rows = malloc(size), *torque = malloc(nv * sizeof *torque);
  uint64_t *fastest = malloc(count * sizeof *fastest);
  rewind(file);
  if (!rows || !torque || !fastest || fread(rows, 1, size, file) != size) return 6;
  fclose(file);

  cs_report report = {.external_torque = torque};
  for (size_t k = 0; k < count; ++k) fastest[k] = UINT64_MAX;
  for (long repeat = 0; repeat < atol(argv[4]); ++repeat) {
    cs_monitor_reset(monitor);
    for (size_t k = 0; k < count; ++k) {
      const double *row = rows + 3 * nv * k;
      const uint64_t start = now();
      cs_sample sample = {.q = row, .v = row + nv, .tau = row + 2 * nv};
      if (cs_monitor_update(monitor, &sample, &report) != CS_OK) return 7;
      const uint64_t time = now() - start;
      if (time < fastest[k]) fastest[k] = time;
    }
  }
  for (size_t k = 0; k < count; ++k) printf("%" PRIu64 "\n", fastest[k]);
  free(rows);
  free(torque);
  free(fastest);
  cs_monitor_free(monitor);
  cs_calibration_free(calibration);
  cs_robot_free(robot);
}
