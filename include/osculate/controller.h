/* A controller of your own in the closed loop of osculate: the interface of a shared library.
 *
 * Units are SI and radians. Six-vectors are angular first: wx wy wz vx vy vz. Quaternions are w x y z. Joint lists
 * run from base to tip. Tip quantities are those of the tip link's origin, resolved in the base frame (with a moving
 * base: in the inertial frame, which is the base frame at t = 0); accelerations are ordinary derivatives of velocities.
 *
 * A library needs one line and one function:
 *
 *     #include <osculate/controller.h>
 *     OSCULATE_CONTROLLER_PLUGIN
 *     int osculate_controller_torque(void* self, const osculate_controller_input* in, osculate_controller_output* out) {
 *       ...
 *       return 0;
 *     }
 *
 *     cc -O2 -shared -fPIC -I PREFIX/include mylaw.c -o mylaw.so
 *
 * docs/your-controller.md says how it is called, what it costs and what happens when it fails. */
#ifndef OSCULATE_CONTROLLER_H
#define OSCULATE_CONTROLLER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define OSCULATE_CONTROLLER_C extern "C"
extern "C" {
#else
#define OSCULATE_CONTROLLER_C
#endif

/* Changes only when the meaning or place of a member changes. Members are added at the end of a structure; its first
 * member `size` says how much of it the caller has, so that a later library can tell which members are there. */
#define OSCULATE_CONTROLLER_ABI 1

#if defined(__GNUC__) || defined(__clang__)
#define OSCULATE_CONTROLLER_EXPORT __attribute__((visibility("default")))
#else
#define OSCULATE_CONTROLLER_EXPORT
#endif

/* Once in one source file, outside any function: tells which version of this interface the library was compiled for. */
#define OSCULATE_CONTROLLER_PLUGIN                                                      \
  OSCULATE_CONTROLLER_C OSCULATE_CONTROLLER_EXPORT int32_t osculate_controller_abi(void); \
  int32_t osculate_controller_abi(void) { return OSCULATE_CONTROLLER_ABI; }

/* What does not change along a run. */
typedef struct osculate_controller_model {
  size_t size;                    /* bytes of this structure */
  const char* urdf;               /* text of the model's URDF file */
  const char* base;               /* links: where the chain begins, and whose motion is controlled */
  const char* tip;
  int32_t lump_side_branches;     /* 1: links beside the chain add their mass, joints frozen at 0; 0: left out */
  double gravity[3];              /* m/s^2, acceleration of free fall, base frame */
  int32_t joints;                 /* of the chain, fixed ones not counted */
  int32_t positions, velocities;  /* coordinates of these joints: one each for revolute and prismatic joints */
  const char* const* joint_names; /* joints */
  const double* armature;         /* velocities; kg m^2 or kg, added to the diagonal of M */
  int32_t rows;                   /* of the task, 1..6 */
  const int32_t* row;             /* rows; 0..5 for wx wy wz vx vy vz */
  double stiffness[6];            /* 1/s^2, of the pose error, for each of wx wy wz vx vy vz */
  double damping[6];              /* 1/s */
  double period;                  /* s, between samples; 0: the law is called at every instant, see below */
  const char* options;            /* controller.law.options of the experiment */
} osculate_controller_model;

/* What the law is given at one instant. Pointers are valid during the call. */
typedef struct osculate_controller_input {
  size_t size;                   /* bytes of this structure */
  double t;                      /* s */
  int32_t positions, velocities; /* numbers of joint coordinates */
  int32_t rows;                  /* of the task */
  int32_t tip_force_known;       /* 1: the law is to take tip_force into account */
  const int32_t* row;            /* rows; 0..5 for wx wy wz vx vy vz */
  const double* q;               /* positions; rad, m. As the sensors give them, if the experiment has sensors */
  const double* qd;              /* velocities; rad/s, m/s */
  double stiffness[6];           /* 1/s^2, as in the model */
  double damping[6];             /* 1/s */
  double tip_position[3];        /* m, of the model at q */
  double tip_orientation[4];     /* of the tip link's axes */
  double tip_velocity[6];        /* rad/s, m/s */
  double reference_position[3];
  double reference_orientation[4];
  double reference_velocity[6];
  double reference_acceleration[6];
  double base_position[3]; /* how the base stands and moves in the inertial frame; at rest: 0, 1 0 0 0, 0, 0 */
  double base_orientation[4];
  double base_velocity[6];
  double base_acceleration[6];
  double tip_force[6];             /* N m, N: wrench of the surroundings on the tip; zero if not known */
  const double* u;                 /* rows; rad/s^2, m/s^2: the tip acceleration that osculate's tracking law commands */
  const double* null_space_torque; /* velocities; N m, N: T0 of controller.null_space; zero without it */
  /* Terms of the model at (q, qd), M qdd + C + G = T + J^T tip_force and acceleration = J qdd + Jdot_qd on the task
   * rows. NULL unless the experiment says controller.law.terms: true. */
  const double* M;       /* velocities x velocities, symmetric, with armature */
  const double* C;       /* velocities; centrifugal and Coriolis torques C(q, qd) qd */
  const double* G;       /* velocities; gravity: what holds the arm at rest */
  const double* J;       /* rows x velocities, row after row */
  const double* Jdot_qd; /* rows */
} osculate_controller_input;

/* What the law answers. The arrays are there already. */
typedef struct osculate_controller_output {
  size_t size;    /* bytes of this structure */
  double* torque; /* velocities; N m, N: every one must be set, to a finite number. Without joint friction: osculate adds
                   * what model.friction names (controller.compensate_friction) */
  double* u;      /* rows; preset to in->u. Set it if your own error law asks for another tip acceleration: the torque is
                   * then judged by whether it gives that one */
  double* null_space_torque; /* velocities; preset to in->null_space_torque. Set it to the T0 of your own that you have
                              * projected, so that the torque can be judged; not read with controller.null_space */
  char* message;             /* preset to "". Why the law refuses, where it returns something else than 0 */
  size_t message_capacity;   /* bytes, the ending 0 among them */
} osculate_controller_output;

/* Looked up by name. Each call comes from the same thread of a process that has loaded nothing else of yours. */

/* Optional. Returns 0 and sets *self to what the other two functions are given; else writes a message why not. */
OSCULATE_CONTROLLER_EXPORT int osculate_controller_create(const osculate_controller_model* model, void** self,
                                                          char* message, size_t message_capacity);

/* Required. Returns 0, or something else to end the run with out->message. `self`: NULL without create.
 * period == 0: called for states that the integrator only tries, in any order of time, so the answer must depend on `in`
 * alone. period > 0: called once for each sample, in order, so the law may remember; a run has several such laws side by
 * side, each created in a process of its own. */
OSCULATE_CONTROLLER_EXPORT int osculate_controller_torque(void* self, const osculate_controller_input* in,
                                                          osculate_controller_output* out);

/* Optional. Called at the end, unless the process was ended. */
OSCULATE_CONTROLLER_EXPORT void osculate_controller_destroy(void* self);

#ifdef __cplusplus
}
#endif

#endif
