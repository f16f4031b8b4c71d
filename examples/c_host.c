/* A C host with one rigid body and a leap-frog of its own: a physical pendulum on a revolute joint
 * of kjoint (consistent formulation). Its period is checked against theory. */
#include <kjoint.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { GROUND, BODY, PIN, N_NODE }; /* the pin is a point of the ground at the hinge */

static const double MASS = 2.0, LENGTH = 0.3, GRAVITY = 9.81, START = 1.0; /* kg m s rad */
static const double INERTIA[3] = {0.02, 0.03, 0.03};                      /* about the centre */

static void check(int status, const kj_joints *joints) {
  char message[500];
  if (status == KJ_OK) return;
  kj_joints_message(joints, message, sizeof message);
  fprintf(stderr, "c_host: %s\n", message);
  exit(2);
}

/* b = a turned by the quaternion q, or back */
static void turn(const double q[4], int back, const double a[3], double b[3]) {
  double s = back ? -1.0 : 1.0, x = s * q[1], y = s * q[2], z = s * q[3];
  double t[3] = {2 * (y * a[2] - z * a[1]), 2 * (z * a[0] - x * a[2]), 2 * (x * a[1] - y * a[0])};
  b[0] = a[0] + q[0] * t[0] + y * t[2] - z * t[1];
  b[1] = a[1] + q[0] * t[1] + z * t[0] - x * t[2];
  b[2] = a[2] + q[0] * t[2] + x * t[1] - y * t[0];
}

/* q := exp(phi) q */
static void rotate(const double phi[3], double q[4]) {
  double angle = sqrt(phi[0] * phi[0] + phi[1] * phi[1] + phi[2] * phi[2]);
  double s = angle > 0 ? sin(angle / 2) / angle : 0.5, c = cos(angle / 2);
  double p[4] = {c, s * phi[0], s * phi[1], s * phi[2]}, r[4];
  r[0] = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3];
  r[1] = p[0] * q[1] + q[0] * p[1] + p[2] * q[3] - p[3] * q[2];
  r[2] = p[0] * q[2] + q[0] * p[2] + p[3] * q[1] - p[1] * q[3];
  r[3] = p[0] * q[3] + q[0] * p[3] + p[1] * q[2] - p[2] * q[1];
  for (int i = 0; i < 4; i++) q[i] = r[i];
}

/* omega += h J^-1 (moment - omega x J omega), in the axes of the body */
static void spin(double h, const double q[4], const double moment[3], double omega[3]) {
  double w[3], m[3];
  turn(q, 1, omega, w);
  turn(q, 1, moment, m);
  double d[3];
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    d[i] = h * (m[i] + (INERTIA[j] - INERTIA[k]) * w[j] * w[k]) / INERTIA[i];
  }
  for (int i = 0; i < 3; i++) w[i] += d[i];
  turn(q, 0, w, omega);
}

int main(void) {
  double x[N_NODE][3] = {{0}}, v[N_NODE][3] = {{0}}, w[N_NODE][3] = {{0}};
  double f[N_NODE][3], m[N_NODE][3], attitude[N_NODE][4] = {{1}, {1}, {1}};
  const double mass[N_NODE] = {0.0, MASS, 0.0}; /* 0: held */
  const double inertia[N_NODE][3] = {{0}, {INERTIA[0], INERTIA[1], INERTIA[2]}, {0}};
  kj_joints *joints;
  kj_joint_spec hinge;
  char message[500];

  /* the body hangs from the origin in the x-z plane, START off the vertical, x along its arm */
  x[BODY][0] = LENGTH * sin(START);
  x[BODY][2] = -LENGTH * cos(START);
  double lean[3] = {0.0, acos(0.0) - START, 0.0};
  rotate(lean, attitude[BODY]);

  if (kj_joints_new("consistent", N_NODE, &joints, message, sizeof message) != KJ_OK) {
    fprintf(stderr, "c_host: %s\n", message);
    return 2;
  }
  /* Both ends sit at the origin. End 2 is node PIN, a point that the body carries */
  kj_joint_spec_init(&hinge);
  hinge.id = 1;
  hinge.type = 2;
  hinge.node[0] = GROUND;
  hinge.node[1] = PIN;
  hinge.carrier[1] = BODY;
  hinge.axes[0][0] = 0.0, hinge.axes[0][1] = 1.0; /* x, the free axis, is y of the world */
  hinge.axes[1][0] = -1.0, hinge.axes[1][1] = 0.0;
  hinge.kn = 1.0e7;
  check(kj_joints_add(joints, &hinge), joints);
  check(kj_joints_start(joints, N_NODE, (const double(*)[3])x, mass, inertia,
                        (const double(*)[4])attitude), joints);

  double h, time = 0.0, before = START, crossing[2] = {0.0, 0.0};
  int found = 0;
  check(kj_joints_critical_step(joints, &h), joints);
  h *= 0.5;
  for (long cycle = 0; found < 2 && time < 10.0; cycle++) {
    for (int i = 0; i < N_NODE; i++)
      for (int k = 0; k < 3; k++) f[i][k] = m[i][k] = 0.0;
    f[BODY][2] = -MASS * GRAVITY; /* own forces first, then those of the joints */
    check(kj_joints_forces(joints, time, cycle > 0 ? h : 0.0, N_NODE, (const double(*)[3])x,
                           (const double(*)[3])v, (const double(*)[3])w,
                           (const double(*)[4])attitude, f, m), joints);
    double kick = cycle > 0 ? h : 0.5 * h; /* from rest to h/2, then from t - h/2 to t + h/2 */
    for (int k = 0; k < 3; k++) v[BODY][k] += kick * f[BODY][k] / MASS;
    spin(kick, attitude[BODY], m[BODY], w[BODY]);
    for (int k = 0; k < 3; k++) x[BODY][k] += h * v[BODY][k];
    double phi[3] = {h * w[BODY][0], h * w[BODY][1], h * w[BODY][2]};
    rotate(phi, attitude[BODY]);
    time += h;
    double angle = atan2(x[BODY][0], -x[BODY][2]);
    if (angle * before < 0) crossing[found++] = time - h * angle / (angle - before);
    before = angle;
  }

  /* half a period between two crossings; exact by the arithmetic-geometric mean */
  double a = 1.0, b = cos(START / 2);
  for (int i = 0; i < 6; i++) {
    double mean = (a + b) / 2;
    b = sqrt(a * b);
    a = mean;
  }
  double rate = sqrt(MASS * GRAVITY * LENGTH / (INERTIA[1] + MASS * LENGTH * LENGTH));
  double exact = acos(-1.0) / rate / a, half = crossing[1] - crossing[0];
  kj_joint_result result;
  check(kj_joints_result(joints, 0, &result), joints);
  printf("half period %.9f s, exact %.9f s, relative error %.1e, step %.1e s\n", half, exact,
         fabs(half / exact - 1.0), h);
  kj_joints_free(joints);
  return found == 2 && fabs(half / exact - 1.0) < 2.0e-5 ? 0 : 1;
}
