// The C interface of contactsense. Written by cbindgen from rust/capi: `make header`.

#ifndef CONTACTSENSE_H
#define CONTACTSENSE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Contacts in a report at most.
#define CS_MAX_CONTACTS 8

// How a call ended.
typedef enum {
  CS_OK = 0,
  // An argument cannot be used; objects are unchanged, but a refused sample counts as time that passed.
  CS_ERROR_INPUT = 1,
  // The description of the robot cannot be used.
  CS_ERROR_MODEL = 2,
  // A mesh or a primitive cannot be used.
  CS_ERROR_GEOMETRY = 3,
  // There is not enough memory.
  CS_ERROR_MEMORY = 4,
  // A fault of the library. The object of the call must not be used any more, except to free it.
  CS_ERROR_FAULT = 5,
} cs_status;

// What motion without contact taught of one robot. It does not change: any number of threads may use it.
typedef struct cs_calibration cs_calibration;

// The sense of touch of one robot. One thread at a time may use it: a call during another one is refused.
typedef struct cs_monitor cs_monitor;

// A robot. It does not change: any number of threads may use it, and monitors share it.
typedef struct cs_robot cs_robot;

// A force/torque sensor where a link joins its parent: the link and all behind it load it.
// `cs_sensor_default` has the defaults.
typedef struct {
  // A name that no other sensor has.
  const char *name;
  // The link.
  const char *link;
  // The sensor's axes in the link's frame: rows of a rotation matrix.
  double rotation[9];
  // The sensor's origin in the link's frame (m).
  double translation[3];
  // Whether a reading is what holds the load, not the load itself.
  bool reads_support;
  // Whether contacts behind it are meant, as those of feet and hands are, and no collision.
  bool wanted;
  // What it reads without load (N, Nm).
  double offset[6];
} cs_sensor;

// A point at which contacts are meant that no sensor measures, such as that of a tool.
typedef struct {
  // Name of the link.
  const char *link;
  // The point in the link's frame (m).
  double point[3];
} cs_wanted_point;

// How a monitor works; `cs_monitor_options_default` has the defaults, with which programs begin.
typedef struct {
  // Time between two calls (s).
  double dt;
  // Gain of the momentum observer (1/s).
  double observer_gain;
  // Of this robot, or NULL: corrects measurements and inertias, and gives thresholds and noise.
  const cs_calibration *calibration;
  // Torques that are a contact: one number for all joints, or one for each (Nm; N for sliding joints). NULL: 0.5, or, with
  // a calibration, a test of all joints at once for the calibration's rate of false alarms.
  const double *torque_threshold;
  // Number of these: 1, or that of `cs_robot_nv`.
  size_t torque_threshold_count;
  // Force/torque sensors, in the order of the readings; NULL for none.
  const cs_sensor *sensors;
  size_t sensor_count;
  // Wrenches of sensors that are a contact: one number, or 6, or 6 for each sensor (N, Nm). NULL: 2.
  const double *wrench_threshold;
  size_t wrench_threshold_count;
  // Points at which contacts are meant; NULL for none.
  const cs_wanted_point *wanted_points;
  size_t wanted_point_count;
  // Time constant of the bias that is tracked without contact (s); 0 for none, or 3 s where all joints are tested at once.
  double bias_time_constant;
  // Greatest bias of each joint, in its thresholds.
  double bias_limit;
  // A torque that stands still for so long becomes the bias (s); 0: a contact may last for ever.
  double bias_settle_time;
  // Share of its greatest torque in a contact that a joint's gear or sensor may keep after it.
  double hysteresis;
  // A signal stays on so long after it was last over its threshold (s).
  double hold_time;
  // Contacts reported at most.
  size_t max_contacts;
  // A contact is located if 90 % of the places that explain the torques are this near to its point (m).
  double locate_within;
  // Samples of the surface for the posterior of a contact; 0 for closed forms only.
  size_t samples;
} cs_monitor_options;

// The measurements of a tick.
typedef struct {
  // Configuration, `cs_robot_nq` numbers.
  const double *q;
  // Velocity, `cs_robot_nv` numbers.
  const double *v;
  // Motor torque, `cs_robot_ntau` numbers.
  const double *tau;
  // Torque of friction, which is subtracted from `tau`; NULL for none.
  const double *friction;
  // Readings of the force/torque sensors, 6 numbers for each, in the sensor's axes (N, Nm); a sensor whose numbers are NaN
  // is left out, and all are where this is NULL.
  const double *wrenches;
  // Time since the last accepted sample (s); 0 for that of the options.
  double dt;
} cs_sample;

// A contact. Numbers that are not known are NaN.
typedef struct {
  // Index of the link, for `cs_robot_link_name`.
  size_t link;
  // Whether 90 % of the places that explain the torques lie within `locate_within` of the point.
  bool located;
  // Whether redundant torques agree with the contacts of the report.
  bool verified;
  // Where it is, world frame (m).
  double point[3];
  // Outward normal of the surface there, world frame.
  double normal[3];
  // Force on the robot, world frame (N).
  double force[3];
  // Force and moment on the robot at the link's origin, world axes (N, Nm).
  double wrench[6];
  // Standard deviation of the point (m).
  double point_std;
  // Probability that the contact is on this link.
  double probability;
  // The ball of this radius about the point holds 90 % of the posterior (m).
  double region_radius;
  // The same contact has the same number in all ticks, from 0 on; -1 where contacts are not followed.
  int64_t id;
  // When it began, since the first call (s).
  double since;
  // Its largest force so far (N).
  double peak_force;
} cs_contact;

// What a monitor says of a tick. The caller's memory: nothing in it has to be freed.
typedef struct {
  // Since the first call (s).
  double time;
  // How unlikely the torques are without contact, in standard deviations; NaN with thresholds for each joint.
  double significance;
  // Whether there is a contact.
  bool collision;
  // Whether it began with this tick.
  bool onset;
  // Whether a torque that stood still became the bias.
  bool remainder_learned;
  // Whether there were more contacts, or explanations, than are reported.
  bool truncated;
  size_t contact_count;
  cs_contact contacts[CS_MAX_CONTACTS];
  // Room for `nv` numbers that the caller owns, or NULL: the external torque without bias (Nm, N).
  double *external_torque;
  // The same without wanted contacts and stops of joints.
  double *collision_torque;
  // Room for 6 numbers for each sensor, or NULL: the external wrench that it sees, world axes, at its origin; NaN where it
  // is left out (N, Nm).
  double *wrenches;
} cs_report;

// How a URDF is read.
typedef struct {
  // Folders that `package://` names and mesh files may come from, besides the URDF's own; NULL for none.
  const char *const *package_dirs;
  size_t package_dir_count;
  // Whether the root link moves freely.
  bool floating_base;
} cs_urdf_options;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Reads the YAML file that `contactsense calibrate` or `Calibration.save` of Python wrote.
//
// The calibration belongs to the caller, who frees it with `cs_calibration_free`. Whether it fits a robot is known when a
// monitor is made with it.
//
// # Safety
// `path` ends with NUL; `calibration` can be written to.
cs_status cs_calibration_load(const char *path,
                              cs_calibration **calibration);

// Frees a calibration; NULL is allowed. Monitors that were made with it live on.
//
// # Safety
// `calibration` is NULL, or was made by `cs_calibration_load` and not freed before.
void cs_calibration_free(cs_calibration *calibration);

// Makes a monitor, which belongs to the caller, who frees it with `cs_monitor_free`. All that it is made of may be freed
// before.
//
// # Safety
// `robot` and `options` live, with all that they point to; `monitor` can be written to.
cs_status cs_monitor_new(const cs_robot *robot,
                         const cs_monitor_options *options,
                         cs_monitor **monitor);

// Frees a monitor; NULL is allowed.
//
// # Safety
// `monitor` is NULL, or was made by `cs_monitor_new`, not freed before, and no thread uses it.
void cs_monitor_free(cs_monitor *monitor);

// Takes in a tick, and writes what the monitor says of it. Allocates no memory, unless it fails.
//
// # Safety
// `monitor` lives; `sample` and its numbers live; `report` can be written to, and has room where it points to some.
cs_status cs_monitor_update(cs_monitor *monitor,
                            const cs_sample *sample,
                            cs_report *report);

// Takes in a tick with an external torque that the robot's controller estimates; `tau` of the sample is that torque,
// `cs_robot_nv` numbers, `v` may be NULL, and `friction` is not read.
//
// # Safety
// As of `cs_monitor_update`.
cs_status cs_monitor_update_external(cs_monitor *monitor,
                                     const cs_sample *sample,
                                     cs_report *report);

// Says that the sample of a tick is lost; `dt` is the time since the last that was accepted (s), or 0.
//
// # Safety
// `monitor` lives.
cs_status cs_monitor_miss(cs_monitor *monitor,
                          double dt);

// Takes what is measured now for free of contact: bias and offsets of sensors become so.
//
// # Safety
// `monitor` lives.
cs_status cs_monitor_tare(cs_monitor *monitor);

// From the next tick on, a link carries a payload that the description lacks, with its centre of mass in the link's frame
// (kg, m); one that was set before is gone. Not for the control loop: it allocates.
//
// # Safety
// `monitor` lives; `link` ends with NUL; `com` has three numbers.
cs_status cs_monitor_set_payload(cs_monitor *monitor,
                                 const char *link,
                                 double mass,
                                 const double *com);

// From the next tick on, there is no such payload. Not for the control loop: it frees memory.
//
// # Safety
// `monitor` lives.
cs_status cs_monitor_clear_payload(cs_monitor *monitor);

// Forgets all ticks; the next one is the first.
//
// # Safety
// `monitor` lives.
cs_status cs_monitor_reset(cs_monitor *monitor);

// The defaults, for calls every `dt` seconds.
cs_monitor_options cs_monitor_options_default(double dt);

// Reads a robot from a URDF file.
//
// `options` may be NULL. The robot belongs to the caller, who frees it with `cs_robot_free`.
//
// # Safety
// `path` and the folders end with NUL; `robot` can be written to.
cs_status cs_robot_from_urdf(const char *path, const cs_urdf_options *options, cs_robot **robot);

// Frees a robot; NULL is allowed. Monitors of it live on.
//
// # Safety
// `robot` is NULL, or was made by `cs_robot_from_urdf` and not freed before.
void cs_robot_free(cs_robot *robot);

// Numbers in a configuration `q`.
//
// # Safety
// `robot` is NULL, which gives 0, or lives.
size_t cs_robot_nq(const cs_robot *robot);

// Numbers in a velocity `v`, and in an external torque.
//
// # Safety
// `robot` is NULL, which gives 0, or lives.
size_t cs_robot_nv(const cs_robot *robot);

// Numbers in a motor torque `tau`: without those of a floating base.
//
// # Safety
// `robot` is NULL, which gives 0, or lives.
size_t cs_robot_ntau(const cs_robot *robot);

// The name of a moving joint, in the order of `v`. NULL beyond the last one; lives as long as the robot.
//
// # Safety
// `robot` is NULL or lives.
const char *cs_robot_joint_name(const cs_robot *robot,
                                size_t index);

// The name of a link, by the index that contacts have. NULL beyond the last one; lives as long as the robot.
//
// # Safety
// `robot` is NULL or lives.
const char *cs_robot_link_name(const cs_robot *robot,
                               size_t index);

// What is unusual about the description. NULL beyond the last one; lives as long as the robot.
//
// # Safety
// `robot` is NULL or lives.
const char *cs_robot_warning(const cs_robot *robot, size_t index);

// A sensor in the link's frame that reads the load. The texts must live until a monitor is made.
cs_sensor cs_sensor_default(const char *name, const char *link);

// What was wrong in the last call of this thread that failed; empty before. Valid until another call of this thread
// fails.
const char *cs_error_message(void);

// The version of the library, such as "0.1.0".
const char *cs_version(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* CONTACTSENSE_H */
