/* What a host may do wrong: every call must give an error and a message, none may crash.
 * usage: misuse DECK_0000.rad */
#include <kjoint.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

static int failed = 0, checked = 0;

/* status is wanted, and the message has this word */
static void expect(int line, int status, int wanted, const char *message, const char *word) {
  checked++;
  if (status == wanted && (!word || strstr(message, word))) return;
  failed++;
  printf("misuse.c:%d: status %d, wanted %d; message \"%s\", wanted \"%s\"\n", line, status, wanted,
         message, word ? word : "");
}

static char text[2000];
#define NEW(call, word) (text[0] = 0, expect(__LINE__, call, KJ_INPUT, text, word))
#define WRONG(call, word) \
  do { int result_ = call; kj_joints_message(joints, text, sizeof text); \
       expect(__LINE__, result_, KJ_INPUT, text, word); } while (0)
#define RIGHT(call) \
  do { int result_ = call; kj_joints_message(joints, text, sizeof text); \
       expect(__LINE__, result_, KJ_OK, text, NULL); } while (0)
#define BAD(call, status, word) \
  do { int result_ = call; kj_model_message(model, text, sizeof text); \
       expect(__LINE__, result_, status, text, word); } while (0)
#define NULLS(call) expect(__LINE__, call, KJ_INPUT, "", NULL)

enum { N = 4 };
static double x[N][3] = {{0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, zero[N][3], f[N][3], m[N][3];
static double mass[N] = {1, 1, 1, 1}, inertia[N][3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
static double turn[N][4] = {{1}, {1}, {1}, {1}};
typedef const double (*vec)[3];
typedef const double (*quat)[4];

static kj_joint_spec good(void) {
  kj_joint_spec s;
  kj_joint_spec_init(&s);
  s.id = 7;
  s.type = 2;
  s.node[0] = 0;
  s.node[1] = 1;
  s.kn = 1.0e6;
  return s;
}

static void wrong_specs(kj_joints *joints) {
  kj_joint_spec s;
#define SPEC(change, word) s = good(), change; WRONG(kj_joints_add(joints, &s), word)
  SPEC(s.type = 0, "no type 0");
  SPEC(s.type = 10, "no type 10");
  SPEC(s.node[1] = N, "node");
  SPEC(s.node[0] = -5, "node");
  SPEC(s.node[0] = 2147483647, "node");
  SPEC(s.carrier[0] = N, "node");
  SPEC(s.carrier[0] = 1, "same carrier");
  SPEC(s.node[1] = 0, "same carrier");
  SPEC(s.axis_node[0][0] = 2, "three nodes");
  SPEC(s.axes[0][0] = 2.0, "axes");
  SPEC(s.axes[2][2] = -1.0, "axes");
  SPEC(s.axes[1][1] = NAN, "axes");
  SPEC(s.kn = 0.0, "kn");
  SPEC(s.kn = -1.0, "kn");
  SPEC(s.kn = INFINITY, "finite");
  SPEC(s.k[3] = NAN, "finite");
  SPEC(s.k[3] = -1.0, "negative");
  SPEC(s.k[0] = 1.0, "blocked");
  SPEC(s.cr = 1.5, "cr");
  SPEC(s.k_curve[3] = 3, "curve");
  SPEC(s.k_curve[3] = -7, "curve");
  WRONG(kj_joints_add(joints, NULL), "null");
}

static void element_level(void) {
  kj_joints *joints = NULL, *other = NULL;
  kj_joint_spec s = good();
  kj_joint_result r;
  double h, state[5000], a[3] = {0, 1, 2}, down[3] = {2, 1, 0}, nan2[2] = {0, NAN};
  int n;

  NULLS(kj_joint_spec_init(NULL));
  NULLS(kj_joints_add(NULL, &s));
  NULLS(kj_joints_count(NULL, &n));
  NULLS(kj_joints_message(NULL, text, sizeof text));
  NULLS(kj_joints_forces(NULL, 0, 0, N, (vec)x, (vec)zero, (vec)zero, NULL, f, m));
  kj_joints_free(NULL);
  NEW(kj_joints_new("wrong", N, &joints, text, sizeof text), "no formulation wrong");
  NEW(kj_joints_new(NULL, N, &joints, text, sizeof text), "formulation");
  NEW(kj_joints_new("legacy", -1, &joints, text, sizeof text), "negative");
  NEW(kj_joints_new("legacy", N, NULL, text, sizeof text), "null");
  NULLS(kj_joints_new("wrong", N, &joints, NULL, 0));

  if (kj_joints_new("consistent", N, &joints, text, sizeof text) != KJ_OK) return;
  wrong_specs(joints);
  WRONG(kj_joints_curve(joints, 3, a, NULL, &n), "null");
  WRONG(kj_joints_curve(joints, 3, down, a, &n), "ascend");
  WRONG(kj_joints_curve(joints, 1, a, a, &n), "two");
  WRONG(kj_joints_curve(joints, 2, nan2, a, &n), "finite");
  WRONG(kj_joints_curve(joints, -1, a, a, &n), "negative");
  RIGHT(kj_joints_curve(joints, 3, a, a, &n));
  WRONG(kj_joints_forces(joints, 0, 0, N, (vec)x, (vec)zero, (vec)zero, (quat)turn, f, m),
        "not been started");
  WRONG(kj_joints_critical_step(joints, &h), "not been started");
  WRONG(kj_joints_result(joints, 0, &r), "not been started");
  RIGHT(kj_joints_add(joints, &s));
  WRONG(kj_joints_start(joints, N + 1, (vec)x, mass, (vec)inertia, (quat)turn), "expected");
  WRONG(kj_joints_start(joints, 0, (vec)x, mass, (vec)inertia, (quat)turn), "expected");
  WRONG(kj_joints_start(joints, N, (vec)x, mass, (vec)inertia, NULL), "attitudes");
  WRONG(kj_joints_start(joints, N, NULL, mass, (vec)inertia, (quat)turn), "null");
  RIGHT(kj_joints_start(joints, N, (vec)x, mass, (vec)inertia, (quat)turn));
  WRONG(kj_joints_add(joints, &s), "started");
  WRONG(kj_joints_start(joints, N, (vec)x, mass, (vec)inertia, (quat)turn), "started");
#define FORCES(t, h, n, x, v, w, q, word) \
  WRONG(kj_joints_forces(joints, t, h, n, (vec)x, (vec)v, (vec)w, (quat)q, f, m), word)
  FORCES(0, 0, N - 1, x, zero, zero, turn, "expected");
  FORCES(0, -1.0, N, x, zero, zero, turn, "step");
  FORCES(0, NAN, N, x, zero, zero, turn, "step");
  FORCES(NAN, 0, N, x, zero, zero, turn, "time");
  FORCES(0, 0, N, NULL, zero, zero, turn, "null");
  FORCES(0, 0, N, x, zero, zero, NULL, "attitudes");
  x[1][2] = NAN;
  FORCES(0, 0, N, x, zero, zero, turn, "node 2");
  x[1][2] = 0;
  zero[0][0] = INFINITY;
  FORCES(0, 0, N, x, zero, zero, turn, "finite");
  zero[0][0] = 0;
  turn[0][0] = 0;
  FORCES(0, 0, N, x, zero, zero, turn, "quaternion");
  turn[0][0] = 1;
  RIGHT(kj_joints_forces(joints, 0, 0, N, (vec)x, (vec)zero, (vec)zero, (quat)turn, f, m));
  WRONG(kj_joints_stiffness(joints, N - 1, mass, mass), "values");
  WRONG(kj_joints_stiffness(joints, N, NULL, mass), "null");
  WRONG(kj_joints_result(joints, 1, &r), "no joint");
  WRONG(kj_joints_result(joints, -1, &r), "no joint");
  WRONG(kj_joints_result(joints, 2147483647, &r), "no joint");
  WRONG(kj_joints_result(joints, 0, NULL), "null");
  RIGHT(kj_joints_state_size(joints, &n));
  if (n > 5000) return;
  WRONG(kj_joints_save(joints, n - 1, state), "numbers");
  RIGHT(kj_joints_save(joints, n, state));
  state[0] = 99;
  WRONG(kj_joints_restore(joints, n, state), "no state");
  state[0] = NAN;
  WRONG(kj_joints_restore(joints, n, state), "no state");
  WRONG(kj_joints_restore(joints, 2, state), "numbers");
  WRONG(kj_joints_take(joints, NULL, N, NULL, NULL), "null");
  kj_joints_free(joints);

  /* what shows only at the start; then the set is spoilt */
  kj_joints_new("legacy", N, &other, text, sizeof text);
  joints = other;
  s.type = 5;
  WRONG(kj_joints_add(joints, &s), "axis_node");
  s.type = 1;
  RIGHT(kj_joints_add(joints, &s));
  mass[0] = mass[1] = 0;
  WRONG(kj_joints_start(joints, N, (vec)x, mass, (vec)inertia, NULL), "mass 0");
  WRONG(kj_joints_start(joints, N, (vec)x, mass, (vec)inertia, NULL), "new_joint_set");
  mass[0] = mass[1] = 1;
  kj_joints_free(joints);
  kj_joints_new("legacy", N, &joints, text, sizeof text);
  RIGHT(kj_joints_add(joints, &s));
  mass[1] = NAN;
  WRONG(kj_joints_start(joints, N, (vec)x, mass, (vec)inertia, NULL), "not finite");
  mass[1] = 1;
  kj_joints_free(joints);
  kj_joints_new("legacy", N, &joints, text, sizeof text);
  for (int i = 0; i < 3; i++) s.axis_node[0][i] = s.axis_node[1][i] = 2; /* a point: no axes */
  RIGHT(kj_joints_add(joints, &s));
  WRONG(kj_joints_start(joints, N, (vec)x, mass, (vec)inertia, NULL), "no frame");
  kj_joints_free(joints);
}

/* Does in a tick what only a host may do; the run goes on as if nothing had been. */
static int meddle(const kj_run_status *status, void *user) {
  kj_model *model = user;
  kj_run_status now;
  double v[3] = {0, 0, 0}, q[4] = {1, 0, 0, 0};

  BAD(kj_model_run(model, NULL, NULL), KJ_INPUT, "runs");
  BAD(kj_model_start(model), KJ_INPUT, "runs");
  BAD(kj_model_advance(model, 1.0), KJ_INPUT, "runs");
  BAD(kj_model_step(model), KJ_INPUT, "runs");
  BAD(kj_model_sample(model), KJ_INPUT, "runs");
  BAD(kj_model_set_body_load(model, 2, v, v), KJ_INPUT, "runs");
  BAD(kj_model_set_load_factor(model, 1, 0.0), KJ_INPUT, "runs");
  BAD(kj_model_set_body_velocity(model, 2, v, v), KJ_INPUT, "runs");
  BAD(kj_model_set_body_pose(model, 2, v, q), KJ_INPUT, "runs");
  BAD(kj_model_lock_joint(model, 900, 1), KJ_INPUT, "runs");
  kj_model_free(model);
  BAD(kj_model_status(model, &now), KJ_OK, "");
  expect(__LINE__, now.cycle != status->cycle, 0, "another cycle", NULL);
  return 0;
}

/* A state goes by a file of the host, and gives the bits of the model that went on; less of it is refused */
static void kept(kj_model *model) {
  static char state[200000];
  kj_run_status went, other;
  size_t size = 0;
  FILE *file = tmpfile();

  BAD(kj_model_save(model, 10, state, &size), KJ_INPUT, "");
  BAD(kj_model_save(model, 0, NULL, &size), KJ_OK, "");
  if (!file || size > sizeof state) { failed++; return; }
  BAD(kj_model_save(model, size, state, NULL), KJ_OK, "");
  if (fwrite(state, 1, size, file) != size) failed++;
  rewind(file);
  memset(state, 0, size);
  BAD(kj_model_steps(model, 5), KJ_OK, "");
  BAD(kj_model_status(model, &went), KJ_OK, "");
  if (fread(state, 1, size, file) != size) failed++;
  fclose(file);
  BAD(kj_model_restore(model, size - 1, state), KJ_INPUT, "damaged");
  BAD(kj_model_restore(model, size, state), KJ_OK, "");
  BAD(kj_model_steps(model, 5), KJ_OK, "");
  BAD(kj_model_status(model, &other), KJ_OK, "");
  checked++;
  if (went.cycle != other.cycle || memcmp(&went.time, &other.time, sizeof went.time) ||
      memcmp(&went.kinetic, &other.kinetic, sizeof went.kinetic)) failed++;
}

static void meddled_run(const char *deck) {
  kj_model *model = NULL;
  kj_run_status plain, meddled;

  if (kj_model_load(deck, NULL, "until=0.001", &model, text, sizeof text) != KJ_OK) return;
  BAD(kj_model_run(model, NULL, NULL), KJ_OK, "");
  BAD(kj_model_status(model, &plain), KJ_OK, "");
  BAD(kj_model_run(model, meddle, model), KJ_OK, "");
  BAD(kj_model_status(model, &meddled), KJ_OK, "");
  expect(__LINE__, plain.cycle != meddled.cycle, 0, "not the same cycles", NULL);
  expect(__LINE__, plain.kinetic != meddled.kinetic, 0, "not the same run", NULL);
  BAD(kj_model_start(model), KJ_OK, "");
  kept(model);
  kj_model_free(model);
}

static void model_level(const char *deck) {
  kj_model *model = NULL;
  kj_joints *joints = NULL;
  kj_body body;
  kj_joint_result r;
  double v[3] = {0, 0, 0}, nan3[3] = {NAN, 0, 0}, q[4] = {0, 0, 0, 0};
  int n, ids[9], e, c, nodes[2] = {100, 100};

  NULLS(kj_model_run(NULL, NULL, NULL));
  NULLS(kj_options_list(NULL, 0));
  NULLS(kj_rate_iso18571(9, NULL, v, v));
  NULLS(kj_joint_type(2, text, sizeof text, NULL));
  NULLS(kj_joint_type(99, text, sizeof text, ids));
  NULLS(kj_model_options(NULL, text, sizeof text));
  kj_model_free(NULL);
  expect(__LINE__, kj_model_load("there_is_no_such_0000.rad", NULL, NULL, &model, text, sizeof text),
         KJ_FILE, text, "there_is_no_such");
  expect(__LINE__, kj_model_load(deck, "there_is_no_such_0001.rad", NULL, &model, text, sizeof text),
         KJ_FILE, text, "there_is_no_such");
  NEW(kj_model_load(NULL, NULL, NULL, &model, text, sizeof text), "null");
  NEW(kj_model_load(deck, NULL, NULL, NULL, text, sizeof text), "null");
  NEW(kj_model_load(deck, NULL, "formulation=fast", &model, text, sizeof text), "fast");
  NEW(kj_model_load(deck, NULL, "until=1 quick=1", &model, text, sizeof text), "no option quick");
  NEW(kj_model_load(deck, NULL, "until", &model, text, sizeof text), "until needs a value");
  NEW(kj_model_load(deck, NULL, "until=0,1", &model, text, sizeof text), "a number");
  NEW(kj_model_load(deck, NULL, "threads=0", &model, text, sizeof text), "whole number");
  NEW(kj_model_load(deck, NULL, "islands=yes", &model, text, sizeof text), "1 or 0");
  NEW(kj_model_load(deck, NULL, "formulation=legacy islands=1", &model, text, sizeof text),
      "islands");
  if (kj_model_load(deck, NULL, NULL, &model, text, sizeof text) != KJ_OK) {
    printf("misuse.c: %s\n", text);
    failed++;
    return;
  }
  BAD(kj_model_advance(model, 1.0), KJ_INPUT, "not started");
  BAD(kj_model_step(model), KJ_INPUT, "not started");
  BAD(kj_model_steps(model, 2), KJ_INPUT, "not started");
  BAD(kj_model_sample(model), KJ_INPUT, "not started");
  BAD(kj_model_body(model, 1, &body), KJ_INPUT, "not started");
  BAD(kj_model_write_history(model, "/no/such/folder/x.h5"), KJ_INPUT, "no samples");
  BAD(kj_model_start(model), KJ_OK, "");
  BAD(kj_model_advance(model, NAN), KJ_INPUT, "finite");
  BAD(kj_model_steps(model, -1), KJ_INPUT, "negative");
  BAD(kj_model_body(model, 99, &body), KJ_INPUT, "no rigid body 99");
  BAD(kj_model_body(model, 1, NULL), KJ_INPUT, "null");
  BAD(kj_model_joint(model, 99, &r), KJ_INPUT, "no joint 99");
  BAD(kj_model_node(model, 99, v), KJ_INPUT, "no node 99");
  BAD(kj_model_set_body_load(model, 2, nan3, v), KJ_INPUT, "finite");
  BAD(kj_model_set_body_load(model, 2, NULL, v), KJ_INPUT, "null");
  BAD(kj_model_set_load_factor(model, 1, 2.0), KJ_INPUT, "no concentrated load 1");
  BAD(kj_model_set_body_velocity(model, 2, v, nan3), KJ_INPUT, "finite");
  BAD(kj_model_set_body_pose(model, 2, v, q), KJ_INPUT, "quaternion");
  BAD(kj_model_lock_joint(model, 900, 1), KJ_INPUT, "cannot lock");
  BAD(kj_model_body_ids(model, 1, ids), KJ_INPUT, "2 ids");
  BAD(kj_model_shape(model, "joint/farce", &n, &e, &c), KJ_INPUT, "no channel");
  BAD(kj_model_series(model, "time", 17, v), KJ_INPUT, "values");
  BAD(kj_model_sample(model), KJ_OK, "");
  BAD(kj_model_write_history(model, ""), KJ_INPUT, "no name");
  BAD(kj_model_set_body_velocity(model, 2, (double[3]){1e300, 0, 0}, v), KJ_OK, "");
  BAD(kj_model_advance(model, 1.0), KJ_RUN, "not finite");
  BAD(kj_model_advance(model, 1.0), KJ_INPUT, "ended");
  BAD(kj_model_start(model), KJ_OK, "");

  kj_joints_new("legacy", 2, &joints, text, sizeof text);
  WRONG(kj_joints_take(joints, model, 2, nodes, NULL), "formulation");
  kj_joints_free(joints);
  kj_joints_new("consistent", 2, &joints, text, sizeof text);
  WRONG(kj_joints_take(joints, model, 2, nodes, (quat)turn), "twice");
  kj_joints_free(joints);
  kj_joints_new("consistent", 2, &joints, text, sizeof text);
  nodes[1] = 101;
  WRONG(kj_joints_take(joints, model, 2, nodes, (quat)turn), "no node 200");
  kj_joints_free(joints);
  kj_model_free(model);
}

int main(int argc, char **argv) {
  element_level();
  model_level(argc > 1 ? argv[1] : "");
  meddled_run(argc > 1 ? argv[1] : "");
  printf("%d of %d wrong calls were not refused as they should be\n", failed, checked);
  return failed > 0;
}
