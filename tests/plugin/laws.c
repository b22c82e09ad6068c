/* Controllers that the tests load: right ones, wrong ones, and ones that fail. controller.law.options chooses. */
#define _POSIX_C_SOURCE 200809L
#define osculate_controller_torque right
#include "../../experiments/your_controller.c"
#undef osculate_controller_torque

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

OSCULATE_CONTROLLER_EXPORT int osculate_controller_torque(void*, const osculate_controller_input*,
                                                          osculate_controller_output*);

static const double failing_from = 0.05; /* s */

typedef struct {
  char kind[32];
  double period, gravity;
  long calls;
  double sum;
} Law;

int osculate_controller_create(const osculate_controller_model* model, void** self, char* message, size_t capacity) {
  if (strcmp(model->options, "refuse_to_start") == 0) {
    snprintf(message, capacity, "no \"%s\" here, %d joints, first %s", "gripper", model->joints, model->joint_names[0]);
    return 3;
  }
  if (strcmp(model->options, "crash_at_start") == 0) raise(SIGSEGV);
  if (strcmp(model->options, "hang_at_start") == 0) pause();
  if (model->size != sizeof *model || strstr(model->urdf, "<robot") == NULL || model->rows < 1) return 4;
  Law* law = calloc(1, sizeof *law);
  snprintf(law->kind, sizeof law->kind, "%s", model->options);
  law->period = model->period;
  law->gravity = -model->gravity[2];
  *self = law;
  return 0;
}

void osculate_controller_destroy(void* self) {
  Law* law = self;
  if (strcmp(law->kind, "say_goodbye") == 0) fprintf(stderr, "goodbye after %ld calls\n", law->calls);
  free(law);
}

/* models/planar_2r.urdf in closed form, from (q, qd, u) and what the comment in that file says alone. */
static void planar(const Law* law, const osculate_controller_input* in, osculate_controller_output* out) {
  const double l1 = 1, c1 = 0.5, m1 = 2, I1 = 0.2, l2 = 0.8, c2 = 0.4, m2 = 1.5, I2 = 0.1, g = law->gravity;
  const double q1 = in->q[0], q12 = in->q[0] + in->q[1], w1 = in->qd[0], w12 = in->qd[0] + in->qd[1];
  const double M11 = I1 + I2 + m1 * c1 * c1 + m2 * (l1 * l1 + c2 * c2 + 2 * l1 * c2 * cos(in->q[1]));
  const double M12 = I2 + m2 * (c2 * c2 + l1 * c2 * cos(in->q[1])), M22 = I2 + m2 * c2 * c2;
  const double h = m2 * l1 * c2 * sin(in->q[1]);
  const double C1 = -h * (w12 * w12 - w1 * w1), C2 = h * w1 * w1;
  const double G2 = m2 * c2 * g * cos(q12), G1 = (m1 * c1 + m2 * l1) * g * cos(q1) + G2;
  /* rows vx, vz: J qdd + Jdot qd = u, two equations for two accelerations */
  const double J11 = -l1 * sin(q1) - l2 * sin(q12), J12 = -l2 * sin(q12);
  const double J21 = l1 * cos(q1) + l2 * cos(q12), J22 = l2 * cos(q12);
  const double b1 = in->u[0] + l1 * cos(q1) * w1 * w1 + l2 * cos(q12) * w12 * w12;
  const double b2 = in->u[1] + l1 * sin(q1) * w1 * w1 + l2 * sin(q12) * w12 * w12;
  const double det = J11 * J22 - J12 * J21;
  const double a1 = (J22 * b1 - J12 * b2) / det, a2 = (J11 * b2 - J21 * b1) / det;
  out->torque[0] = M11 * a1 + M12 * a2 + C1 + G1;
  out->torque[1] = M12 * a1 + M22 * a2 + C2 + G2;
}

int osculate_controller_torque(void* self, const osculate_controller_input* in, osculate_controller_output* out) {
  Law* law = self;
  const int n = in->velocities, m = in->rows;
  const char* kind = law->kind;
  const int fails = in->t >= failing_from;
  ++law->calls;
  if (in->size != sizeof *in || out->size != sizeof *out) return 9;
  if (strcmp(kind, "planar") == 0) return planar(law, in, out), 0;
  if (strcmp(kind, "no_jdot_qd") == 0) {
    const double none[6] = {0};
    osculate_controller_input part = *in;
    part.Jdot_qd = none;
    return right(NULL, &part, out);
  }
  if (strcmp(kind, "own_u") == 0) { /* another error law: half the damping */
    osculate_controller_input part = *in;
    for (int i = 0; i < m; ++i)
      out->u[i] = in->u[i] + 0.5 * in->damping[in->row[i]] *
                                 (in->tip_velocity[in->row[i]] - in->reference_velocity[in->row[i]]);
    part.u = out->u;
    return right(NULL, &part, out);
  }
  if (strcmp(kind, "own_null_space") == 0) { /* T0 = -5 qd, projected: T0 - J^T Lambda J M^-1 T0 by shifting C */
    double shifted[n];
    osculate_controller_input part = *in;
    for (int k = 0; k < n; ++k) out->null_space_torque[k] = -5 * in->qd[k], shifted[k] = in->C[k] + 5 * in->qd[k];
    part.C = shifted;
    if (right(NULL, &part, out) != 0) return 1;
    for (int k = 0; k < n; ++k) out->torque[k] -= 5 * in->qd[k];
    return 0;
  }
  if (strcmp(kind, "springs") == 0) { /* simple enough that Python computes the same bits */
    for (int k = 0; k < n; ++k) out->torque[k] = in->G[k] - 3.7 * in->qd[k] - 41.3 * (in->q[k] - 0.1 * k);
    return 0;
  }
  if (strcmp(kind, "count") == 0 && in->t != (law->calls - 1) * law->period) { /* a memory that nobody else writes to */
    snprintf(out->message, out->message_capacity, "call %ld came at t = %g s", law->calls, in->t);
    return 1;
  }
  if (strcmp(kind, "integrate") == 0) {
    law->sum += in->q[0];
    if (right(NULL, in, out) != 0) return 1;
    out->torque[0] -= law->sum;
    return 0;
  }
  if (fails && strcmp(kind, "crash") == 0) *(volatile int*)8 = 1;
  if (fails && strcmp(kind, "abort") == 0) abort();
  if (fails && strcmp(kind, "exit") == 0) exit(7);
  if (fails && strcmp(kind, "hang") == 0)
    for (;;) pause();
  if (fails && strcmp(kind, "unset") == 0) return 0;
  if (fails && strcmp(kind, "refuse") == 0) {
    snprintf(out->message, out->message_capacity, "joint 3 is too warm");
    return 5;
  }
  if (strcmp(kind, "print") == 0) printf("this must not mix with the results\n");
  if (right(NULL, in, out) != 0) return 1;
  if (fails && strcmp(kind, "nan") == 0) out->torque[n - 1] = NAN;
  if (fails && strcmp(kind, "overrun") == 0) out->torque[n] = 1;
  return 0;
}
