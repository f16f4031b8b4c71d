/* What a step costs a host, in us of processor time, median of nine: asked for one by one, by n, inside of
 * kj_model_advance, and with the state of a body read after each. usage: bench_step DECK OPTIONS STEPS */
#define _POSIX_C_SOURCE 200809L
#include <kjoint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { ROUNDS = 9, WAYS = 4, FIRST = 500 };    /* FIRST: steps of the start, which are shorter */

static double clock_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9*(double)t.tv_nsec;
}

static int order(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* n steps one of the ways; the status of what failed */
static int march(kj_model *model, int way, int n, double span, int id) {
  kj_run_status now;
  kj_body body;
  int i, status = 0;
  if (way == 1) return kj_model_steps(model, n);
  if (way == 2) {
    status = kj_model_status(model, &now);
    return status ? status : kj_model_advance(model, now.time + span);
  }
  for (i = 0; i < n && !status; i++) {
    status = kj_model_step(model);
    if (way == 3 && !status) status = kj_model_body(model, id, &body);
  }
  return status;
}

int main(int argc, char **argv) {
  static const char *name[WAYS] = {"one", "many", "advance", "body"};
  double cost[WAYS][ROUNDS], span;
  kj_model *model = NULL;
  kj_run_status before, after;
  char message[500];
  int n, n_body, *ids, way, round;
  if (argc != 4) return 2;
  n = atoi(argv[3]);
  if (kj_model_load(argv[1], NULL, argv[2], &model, message, sizeof message)) {
    fprintf(stderr, "%s\n", message);
    return 1;
  }
  if (kj_model_start(model) || kj_model_steps(model, FIRST) || kj_model_body_count(model, &n_body)) return 1;
  ids = calloc((size_t)n_body + 1, sizeof *ids);
  if (!ids || kj_model_body_ids(model, n_body, ids)) return 1;
  kj_model_status(model, &before);
  if (kj_model_steps(model, n)) return 1;
  kj_model_status(model, &after);
  span = after.time - before.time;
  for (round = 0; round < ROUNDS; round++)
    for (way = 0; way < WAYS; way++) {
      double start;
      kj_model_status(model, &before);
      start = clock_now();
      if (march(model, way, n, span, ids[0])) return 1;
      cost[way][round] = 1e6*(clock_now() - start);
      kj_model_status(model, &after);
      cost[way][round] /= (double)(after.cycle - before.cycle);
    }
  for (way = 0; way < WAYS; way++) {
    qsort(cost[way], ROUNDS, sizeof cost[way][0], order);
    printf("%s\"%s\": %.3f", way ? ", " : "{", name[way], cost[way][ROUNDS/2]);
  }
  puts("}");
  free(ids);
  kj_model_free(model);
  return 0;
}
