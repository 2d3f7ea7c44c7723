// Calls that are wrong: each is refused with its status and a message, and nothing else happens.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "contactsense.h"

#define EXPECT(condition)                                                        \
  do {                                                                           \
    if (!(condition)) {                                                          \
      printf("line %d: %s (%s)\n", __LINE__, #condition, cs_error_message());    \
      return 1;                                                                  \
    }                                                                            \
  } while (0)

static bool told(const char *text) { return strstr(cs_error_message(), text) != NULL; }

int main(int argc, char **argv) {
  EXPECT(argc == 3);
  EXPECT(strlen(cs_version()) >= 5 && strcmp(cs_error_message(), "") == 0);

  cs_robot *robot = (cs_robot *)argv;
  EXPECT(cs_robot_from_urdf("no_such_file.urdf", NULL, &robot) == CS_ERROR_MODEL && told("no_such_file.urdf"));
  EXPECT(robot == NULL);
  EXPECT(cs_robot_from_urdf(NULL, NULL, &robot) == CS_ERROR_INPUT && told("path"));
  EXPECT(cs_robot_from_urdf("\xff", NULL, &robot) == CS_ERROR_INPUT && told("UTF-8"));
  EXPECT(cs_robot_from_urdf(argv[1], NULL, NULL) == CS_ERROR_INPUT && told("robot"));
  EXPECT(cs_robot_nq(NULL) == 0 && cs_robot_link_name(NULL, 0) == NULL);
  cs_robot_free(NULL);

  const char *folders[] = {".", "share"};
  cs_urdf_options floating = {.package_dirs = folders, .package_dir_count = 2, .floating_base = true};
  EXPECT(cs_robot_from_urdf(argv[1], &floating, &robot) == CS_OK);
  EXPECT(cs_robot_nq(robot) == 14 && cs_robot_nv(robot) == 13 && cs_robot_ntau(robot) == 7);
  cs_robot_free(robot);

  EXPECT(cs_robot_from_urdf(argv[1], NULL, &robot) == CS_OK);
  EXPECT(strcmp(cs_robot_joint_name(robot, 6), "iiwa_joint_7") == 0 && !cs_robot_joint_name(robot, 7));
  EXPECT(strcmp(cs_robot_link_name(robot, 0), "iiwa_link_0") == 0);

  cs_monitor *monitor = NULL;
  cs_monitor_options options = cs_monitor_options_default(-1.0);
  EXPECT(cs_monitor_new(robot, &options, &monitor) == CS_ERROR_INPUT && told("dt") && !monitor);
  options = cs_monitor_options_default(0.001);
  double threshold[2] = {1.0, 2.0};
  options.torque_threshold = threshold;
  options.torque_threshold_count = 2;
  EXPECT(cs_monitor_new(robot, &options, &monitor) == CS_ERROR_INPUT && told("torque_threshold"));
  EXPECT(cs_monitor_new(NULL, &options, &monitor) == CS_ERROR_INPUT && told("robot"));
  EXPECT(cs_monitor_new(robot, NULL, &monitor) == CS_ERROR_INPUT && told("options"));
  options.torque_threshold = NULL;
  cs_sensor sensor = cs_sensor_default("wrist", NULL);
  options.sensor_count = 1;
  EXPECT(cs_monitor_new(robot, &options, &monitor) == CS_ERROR_INPUT && told("sensors: must not be NULL"));
  options.sensors = &sensor;
  EXPECT(cs_monitor_new(robot, &options, &monitor) == CS_ERROR_INPUT && told("sensors: link"));
  sensor.link = "elbow";
  EXPECT(cs_monitor_new(robot, &options, &monitor) == CS_ERROR_INPUT && told("elbow"));
  sensor.link = "iiwa_link_7";
  sensor.rotation[0] = 2.0;
  EXPECT(cs_monitor_new(robot, &options, &monitor) == CS_ERROR_INPUT && told("wrist"));
  options.sensor_count = 0;
  cs_wanted_point point = {.link = "elbow"};
  options.wanted_points = &point;
  options.wanted_point_count = 1;
  EXPECT(cs_monitor_new(robot, &options, &monitor) == CS_ERROR_INPUT && told("elbow"));
  options.wanted_point_count = 0;
  EXPECT(cs_monitor_new(robot, &options, &monitor) == CS_OK);

  cs_calibration *calibration = (cs_calibration *)argv;
  EXPECT(cs_calibration_load("no_such_file.yaml", &calibration) == CS_ERROR_INPUT && told("no_such_file.yaml"));
  EXPECT(!calibration && cs_calibration_load(argv[1], &calibration) == CS_ERROR_INPUT && !calibration);
  EXPECT(cs_calibration_load(NULL, &calibration) == CS_ERROR_INPUT && told("path"));
  EXPECT(cs_calibration_load(argv[2], NULL) == CS_ERROR_INPUT && told("calibration"));
  EXPECT(cs_calibration_load(argv[2], &calibration) == CS_OK);
  cs_calibration_free(NULL);
  options.calibration = calibration;
  cs_monitor *calibrated;
  EXPECT(cs_monitor_new(robot, &options, &calibrated) == CS_OK);
  cs_calibration_free(calibration);
  cs_robot_free(robot);  // monitors live on

  double q[7] = {0}, v[7] = {0}, tau[7] = {0}, nan[7] = {0, 0, NAN};
  cs_report report = {0};
  cs_sample sample = {.q = q, .v = v, .tau = tau};
  EXPECT(cs_monitor_update(NULL, &sample, &report) == CS_ERROR_INPUT && told("monitor"));
  EXPECT(cs_monitor_update(monitor, NULL, &report) == CS_ERROR_INPUT && told("sample"));
  EXPECT(cs_monitor_update(monitor, &sample, NULL) == CS_ERROR_INPUT && told("report"));
  sample.tau = NULL;
  EXPECT(cs_monitor_update(monitor, &sample, &report) == CS_ERROR_INPUT && told("tau"));
  sample.tau = nan;
  EXPECT(cs_monitor_update(monitor, &sample, &report) == CS_ERROR_INPUT && told("tau"));
  sample.tau = tau;
  EXPECT(cs_monitor_update(monitor, &sample, &report) == CS_OK && !report.collision && isnan(report.significance));
  EXPECT(cs_monitor_update(calibrated, &sample, &report) == CS_OK && !isnan(report.significance));
  cs_monitor_free(calibrated);
  double com[3] = {0.0, 0.0, 0.1};
  EXPECT(cs_monitor_set_payload(monitor, "elbow", 1.0, com) == CS_ERROR_INPUT && told("elbow"));
  EXPECT(cs_monitor_set_payload(monitor, "iiwa_link_7", -1.0, com) == CS_ERROR_INPUT && told("mass"));
  EXPECT(cs_monitor_set_payload(monitor, "iiwa_link_7", 1.0, NULL) == CS_ERROR_INPUT && told("com"));
  EXPECT(cs_monitor_set_payload(monitor, "iiwa_link_7", 1.0, com) == CS_OK);
  EXPECT(cs_monitor_clear_payload(monitor) == CS_OK && cs_monitor_miss(monitor, 0.001) == CS_OK);
  EXPECT(cs_monitor_tare(monitor) == CS_ERROR_INPUT || cs_monitor_tare(monitor) == CS_OK);
  EXPECT(cs_monitor_update_external(monitor, &sample, &report) == CS_ERROR_INPUT && told("reset"));
  EXPECT(cs_monitor_reset(monitor) == CS_OK);
  sample.v = NULL;
  EXPECT(cs_monitor_update_external(monitor, &sample, &report) == CS_OK);
  sample.dt = -1.0;
  EXPECT(cs_monitor_update_external(monitor, &sample, &report) == CS_ERROR_INPUT && told("dt"));
  cs_monitor_free(monitor);
  cs_monitor_free(NULL);
  printf("all refused\n");
  return 0;
}
