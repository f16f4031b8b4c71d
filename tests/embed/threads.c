/* Two threads, each with a model and a set of joints of its own, give the bits that one thread
 * gives. Run under helgrind, too: no data race.
 * usage: threads CYCLES DECK_A_0000.rad DECK_B_0000.rad */
#include <kjoint.h>

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = 2, KEPT = 64 };

typedef struct {
  const char *deck, *formulation;
  int cycles, status;
  double kept[KEPT];
} job_t;

/* Model level: step a deck, with a load of the host; keep what joints and bodies do */
static int run_model(job_t *job, int *n) {
  kj_model *model = NULL;
  kj_joint_result r;
  kj_body b;
  char text[500], options[50];
  int ids[20], n_body;
  snprintf(options, sizeof options, "formulation=%s until=1", job->formulation);
  if (kj_model_load(job->deck, NULL, options, &model, text, sizeof text)) return 1;
  if (kj_model_start(model) || kj_model_body_count(model, &n_body)) return 2;
  if (kj_model_body_ids(model, 20, ids)) return 3;
  double push[3] = {1, 2, 3};
  if (kj_model_set_body_load(model, ids[n_body - 1], push, push)) return 4;
  for (int i = 0; i < job->cycles; i++) {
    if (kj_model_step(model)) return 5;
    if (i % 16 == 0 && kj_model_sample(model)) return 6;
  }
  if (kj_model_body(model, ids[n_body - 1], &b)) return 7;
  memcpy(job->kept + *n, b.position, sizeof b.position);
  memcpy(job->kept + *n + 3, b.omega, sizeof b.omega);
  *n += 6;
  if (kj_model_joint_ids(model, 20, ids) || kj_model_joint(model, ids[0], &r)) return 8;
  memcpy(job->kept + *n, r.force, sizeof r.force);
  *n += 6;
  kj_model_free(model);
  return 0;
}

/* Element level: a joint between a held node and one that moves by a rule */
static int run_joint(job_t *job, int *n) {
  kj_joints *joints = NULL;
  kj_joint_spec s;
  double x[N][3] = {{0}}, v[N][3] = {{0}}, w[N][3] = {{0}}, q[N][4] = {{1}, {1}};
  double f[N][3], m[N][3], mass[N] = {0, 1}, inertia[N][3] = {{0}, {1, 2, 3}};
  double xs[3] = {-1, 0, 1}, ys[3] = {-5, 0, 20};
  if (kj_joints_new(job->formulation, N, &joints, NULL, 0)) return 11;
  kj_joint_spec_init(&s);
  s.type = 2;
  s.node[0] = 0;
  s.node[1] = 1;
  s.kn = 1000;
  if (kj_joints_curve(joints, 3, xs, ys, &s.k_curve[3])) return 12;
  if (kj_joints_add(joints, &s)) return 13;
  if (kj_joints_start(joints, N, (const double(*)[3])x, mass, (const double(*)[3])inertia,
                      (const double(*)[4])q)) return 14;
  for (int i = 0; i < job->cycles; i++) {
    memset(f, 0, sizeof f);
    memset(m, 0, sizeof m);
    x[1][0] = 0.01 * i;
    w[1][0] = 0.1;
    if (kj_joints_forces(joints, 0.01 * i, i ? 0.01 : 0.0, N, (const double(*)[3])x,
                         (const double(*)[3])v, (const double(*)[3])w, (const double(*)[4])q, f, m))
      return 15;
  }
  memcpy(job->kept + *n, f, sizeof f);
  memcpy(job->kept + *n + 6, m, sizeof m);
  *n += 12;
  kj_joints_free(joints);
  return 0;
}

static void *work(void *argument) {
  job_t *job = argument;
  int n = 0;
  job->status = run_model(job, &n);
  if (!job->status) job->status = run_joint(job, &n);
  return NULL;
}

int main(int argc, char **argv) {
  job_t alone[2] = {{0}}, beside[2] = {{0}};
  pthread_t thread[2];
  if (argc != 4) return 9;
  for (int i = 0; i < 2; i++) {
    alone[i].cycles = atoi(argv[1]);
    alone[i].deck = argv[2 + i];
    alone[i].formulation = i ? "legacy" : "consistent";
    beside[i] = alone[i];
  }
  for (int i = 0; i < 2; i++) pthread_create(&thread[i], NULL, work, &beside[i]);
  for (int i = 0; i < 2; i++) pthread_join(thread[i], NULL);
  for (int i = 0; i < 2; i++) {
    work(&alone[i]);
    if (alone[i].status || beside[i].status) {
      printf("threads: job %d failed: %d alone, %d beside\n", i, alone[i].status,
             beside[i].status);
      return 2;
    }
    if (memcmp(alone[i].kept, beside[i].kept, sizeof alone[i].kept)) {
      printf("threads: job %d gives other bits beside another\n", i);
      return 1;
    }
  }
  printf("threads: equal bits alone and beside each other, %d cycles\n", alone[0].cycles);
  return 0;
}
