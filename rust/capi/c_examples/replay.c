// Gives the rows of a file to a monitor, as a control loop would, and prints the contacts.
//
//     cc -std=c11 replay.c $(pkg-config --cflags --libs contactsense) -o replay
//     ./replay arm.urdf rows.bin arm.yaml
//
// The file has doubles in the order of this machine: for each row q, v and tau. The calibration is from
// `contactsense calibrate`.
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "contactsense.h"

static int fail(const char *what) {
  fprintf(stderr, "%s: %s\n", what, cs_error_message());
  return EXIT_FAILURE;
}

int main(int argc, char **argv) {
  if (argc != 4) {
    fprintf(stderr, "usage: replay URDF ROWS CALIBRATION\n");
    return EXIT_FAILURE;
  }
  cs_robot *robot;
  if (cs_robot_from_urdf(argv[1], NULL, &robot) != CS_OK) return fail(argv[1]);
  for (size_t k = 0; cs_robot_warning(robot, k); ++k) fprintf(stderr, "warning: %s\n", cs_robot_warning(robot, k));

  cs_calibration *calibration;
  if (cs_calibration_load(argv[3], &calibration) != CS_OK) return fail(argv[3]);
  cs_monitor_options options = cs_monitor_options_default(0.001);
  options.calibration = calibration;
  cs_monitor *monitor;
  if (cs_monitor_new(robot, &options, &monitor) != CS_OK) return fail("monitor");

  size_t nq = cs_robot_nq(robot), nv = cs_robot_nv(robot), ntau = cs_robot_ntau(robot);
  size_t width = nq + nv + ntau;
  double *row = malloc(width * sizeof *row);
  cs_report report = {.external_torque = malloc(nv * sizeof *row)};
  FILE *file = fopen(argv[2], "rb");
  if (!row || !report.external_torque || !file) return EXIT_FAILURE;

  int code = EXIT_SUCCESS;
  for (size_t tick = 0; fread(row, sizeof *row, width, file) == width; ++tick) {
    cs_sample sample = {.q = row, .v = row + nq, .tau = row + nq + nv};
    if (cs_monitor_update(monitor, &sample, &report) != CS_OK) {
      code = fail("tick");
      continue;  // a sample that is refused counts as one that was lost
    }
    printf("tick %zu %d %d", tick, report.collision, report.onset);
    // Hexadecimal: every bit.
    for (size_t k = 0; k < nv; ++k) printf(" %a", report.external_torque[k]);
    printf("\n");
    for (size_t k = 0; k < report.contact_count; ++k) {
      const cs_contact *contact = &report.contacts[k];
      printf("contact %s %d %" PRId64, cs_robot_link_name(robot, contact->link), contact->located, contact->id);
      for (int axis = 0; axis < 3; ++axis) printf(" %a", contact->point[axis]);
      for (int axis = 0; axis < 3; ++axis) printf(" %a", contact->force[axis]);
      printf(" %a %a\n", contact->probability, contact->region_radius);
    }
  }
  fclose(file);
  free(report.external_torque);
  free(row);
  cs_monitor_free(monitor);
  cs_calibration_free(calibration);
  cs_robot_free(robot);
  return code;
}
