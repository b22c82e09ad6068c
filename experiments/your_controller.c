/* A controller of your own in C: operational space control (4) from the terms of the model (law.terms: true).
 *   cc -O2 -shared -fPIC -I ../include your_controller.c -o your_controller.so
 *   osculate run puma560_your_controller.yaml --set 'controller.law={plugin: your_controller.so, terms: true}' */
#include <osculate/controller.h>

#include <stdio.h>
#include <string.h>

OSCULATE_CONTROLLER_PLUGIN

/* A = L D L^T in place: L below the diagonal, D on it. A is n x n, symmetric and positive definite. */
static void factor(int n, double* A) {
  for (int j = 0; j < n; ++j)
    for (int i = j; i < n; ++i) {
      double sum = A[i * n + j];
      for (int k = 0; k < j; ++k) sum -= A[i * n + k] * A[k * n + k] * A[j * n + k];
      A[i * n + j] = i == j ? sum : sum / A[j * n + j];
    }
}

/* b becomes A^-1 b. */
static void solve(int n, const double* A, double* b) {
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < i; ++k) b[i] -= A[i * n + k] * b[k];
  for (int i = n - 1; i >= 0; --i) {
    b[i] /= A[i * n + i];
    for (int k = i + 1; k < n; ++k) b[i] -= A[k * n + i] * b[k];
  }
}

static double dot(int n, const double* a, const double* b) {
  double sum = 0;
  for (int k = 0; k < n; ++k) sum += a[k] * b[k];
  return sum;
}

int osculate_controller_torque(void* self, const osculate_controller_input* in, osculate_controller_output* out) {
  const int n = in->velocities, m = in->rows;
  if (in->M == NULL) {
    snprintf(out->message, out->message_capacity, "set controller.law.terms: true");
    return 1;
  }
  double M[n * n], X[m * n], Omega[m * m], F[m];
  memcpy(M, in->M, sizeof M);
  memcpy(X, in->J, sizeof X);
  factor(n, M);
  for (int i = 0; i < m; ++i) {
    solve(n, M, X + i * n); /* row i of J M^-1 */
    for (int j = 0; j < m; ++j) Omega[i * m + j] = dot(n, X + i * n, in->J + j * n);
    F[i] = in->u[i] - in->Jdot_qd[i] + dot(n, X + i * n, in->C) + dot(n, X + i * n, in->G);
  }
  factor(m, Omega);
  solve(m, Omega, F); /* Lambda u + c + g */
  for (int i = 0; i < m; ++i) F[i] -= in->tip_force[in->row[i]]; /* zero if it is not known */
  for (int k = 0; k < n; ++k) {
    out->torque[k] = 0;
    for (int i = 0; i < m; ++i) out->torque[k] += in->J[i * n + k] * F[i];
  }
  (void)self;
  return 0;
}
