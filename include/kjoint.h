/* kjoint: kinematic joints between rigid bodies. C interface of both levels.
 *
 * Every function returns a status: KJ_OK, or what went wrong; kj_joints_message and
 * kj_model_message then say it in a sentence. Nothing prints, stops or crashes for a wrong
 * argument: null pointers, wrong counts, unknown ids and numbers that are not finite give KJ_INPUT,
 * and the call has changed nothing.
 *
 * Handles are independent of each other; there is no other state. One handle may be used by one
 * thread at a time, different handles by different threads at once (kj_model_write_history apart:
 * HDF5 libraries are often built without thread safety).
 *
 * Units are those of the host or of the deck; angles in radian. Vectors are in the global frame W
 * where nothing else is said. Arrays of n nodes are x[n][3]: node by node. Quaternions are w x y z.
 * Nodes, joints and curves count from 0; KJ_NONE stands for none. Ids are those of the deck.
 * Six-vectors are tx ty tz rx ry rz. docs/embedding.md is the guide.
 */
#ifndef KJOINT_H
#define KJOINT_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum kj_status {
  KJ_OK = 0,
  KJ_RUN = 1,      /* a run left its valid range or its energy limit */
  KJ_INPUT = 2,    /* the deck or the call is wrong */
  KJ_FILE = 3,     /* a file cannot be read or written */
  KJ_INTERNAL = 4  /* a bug in kjoint */
};

#define KJ_NONE (-1)

typedef struct kj_joints kj_joints; /* element level: joints of a host */
typedef struct kj_model kj_model;   /* model level: a deck and its run */

/* Version such as "0.1.0" */
int kj_version(char *buffer, size_t size);

/* ------------------------------------------------------------------ element level
 * The host owns nodes, masses and time. Per cycle: positions at t and velocities at t - h/2 go in,
 * forces and moments at t are added into the host's arrays. */

/* Name of a joint type and its free directions (1 free, 0 blocked: tx ty tz rx ry rz); an error where
 * there is no such type. They count from 1: spherical, revolute, cylindrical, ... */
int kj_joint_type(int type, char *name, size_t size, int free[6]);

/* A joint; call kj_joint_spec_init first, then set what differs */
typedef struct kj_joint_spec {
  int id;              /* any number, for messages */
  int type;            /* number of the joint type, see kj_joint_type */
  int node[2];         /* nodes of end 1 and end 2 */
  int carrier[2];      /* nodes that take force and moment and whose rotation the ends follow, such
                          as the main node of a rigid body; KJ_NONE: the node itself */
  int first_frame;     /* 1: the joint frame is that of end 1; 0: midway between both ends */
  int axis_node[2][3]; /* nodes that span the axes of each end: x from the first to the second, the
                          third in the x-y plane; KJ_NONE: `axes` holds */
  double axes[3][3];   /* joint frame at the start: axes[0] is x, axes[1] y, axes[2] z, in W;
                          universal: y the axis of end 1, z that of end 2 */
  double kn;           /* stiffness of blocked directions, force/length */
  double cr;           /* twice their damping ratio, 0 to 1; 0 stands for 0.05 */
  double k[6], c[6];   /* stiffness and damping of free directions, or scale of the curve (0: 1) */
  int k_curve[6];      /* force over displacement, a number from kj_joints_curve, or KJ_NONE */
  int c_curve[6];      /* force over velocity */
} kj_joint_spec;

typedef struct kj_joint_result {
  int id, type;
  double force[6];        /* force and moment on end 1, joint frame */
  double displacement[6]; /* of end 2 from end 1, joint frame */
  double frame[3][3];     /* axes x, y, z of the joint frame, in W */
  double energy;          /* work done on the joint since the start */
  double dissipated;      /* part of it that dampers took (legacy: 0, not told apart) */
  double orthogonality;   /* loss of right angles [rad]; 0 between rigid bodies */
} kj_joint_result;

/* Defaults: everything 0, no carrier, no axis nodes, axes = W, no curves. KJ_INPUT: null */
int kj_joint_spec_init(kj_joint_spec *spec);

/* An empty set for a host with n_node nodes. formulation: "legacy" (frames follow nodes and angular
 * velocities as in Radioss) or "consistent" (frames follow the attitudes of the carriers).
 * message (may be NULL, size 0) takes what went wrong. */
int kj_joints_new(const char *formulation, int n_node, kj_joints **joints, char *message,
                  size_t size);
/* Free a set; NULL is fine */
void kj_joints_free(kj_joints *joints);
/* What the last call on this set had to say; "" after success */
int kj_joints_message(const kj_joints *joints, char *buffer, size_t size);

/* Add a function of n >= 2 points, x ascending, for laws of joints that follow */
int kj_joints_curve(kj_joints *joints, int n, const double *x, const double *y, int *curve);
/* Add a joint; joints are numbered from 0 in this order */
int kj_joints_add(kj_joints *joints, const kj_joint_spec *spec);
/* Fix the joints in the present places, free of force. mass[n], inertia[n][3] principal along the
 * axes of the attitude; mass 0: the host holds or drives that carrier. attitude[n][4] world from
 * node axes; may be NULL under legacy. */
int kj_joints_start(kj_joints *joints, int n, const double (*x)[3], const double *mass,
                    const double (*inertia)[3], const double (*attitude)[4]);
/* Instead of add and start: the joints of a loaded deck with its masses. node_id[n]: id in the deck
 * of each host node; attitude as above */
int kj_joints_take(kj_joints *joints, const kj_model *model, int n, const int *node_id,
                   const double (*attitude)[4]);

/* Forces of all joints at time t, ADDED to f[n][3] and moments to m[n][3] at the carriers. h: step
 * since the last call, 0 in the first; x at t; v, omega (angular velocity) at t - h/2; attitude at t
 * (NULL under legacy). Consistent: call it when f and m hold all other forces. */
int kj_joints_forces(kj_joints *joints, double time, double h, int n, const double (*x)[3],
                     const double (*v)[3], const double (*omega)[3], const double (*attitude)[4],
                     double (*f)[3], double (*m)[3]);
/* Stiffness for the nodal time step of the host, ADDED to kn[n] (force/length), kr[n] (moment/rad):
 * h = sqrt(2 m/kn), sqrt(2 I/kr) */
int kj_joints_stiffness(kj_joints *joints, int n, double *kn, double *kr);
/* Largest stable step of the joints alone, in the present pose (legacy: nodal rule, take 0.9) */
int kj_joints_critical_step(kj_joints *joints, double *h);

int kj_joints_count(const kj_joints *joints, int *n);
int kj_joints_result(kj_joints *joints, int joint, kj_joint_result *result);
/* Work done on all joints since the start, and the part that dampers took */
int kj_joints_energy(kj_joints *joints, double *work, double *dissipated);
/* Number of joints whose loss of orthogonality newly passes a limit [rad]; the message names them */
int kj_joints_warnings(kj_joints *joints, double limit, int *n);

/* State as n numbers; restored, the joints go on with the same bits */
int kj_joints_state_size(const kj_joints *joints, int *n);
int kj_joints_save(kj_joints *joints, int n, double *state);
int kj_joints_restore(kj_joints *joints, int n, const double *state);

/* ------------------------------------------------------------------ model level */

/* Options of a run are a text, name=value with blanks between them: "formulation=legacy until=0.1";
 * those that are left out have their defaults, of the same name twice the later holds. A flag is 1
 * or 0. kj_options_list gives all, a line each: name, kind (word, real, integer, flag), words that
 * it may be, default, meaning, with tabs between them. */
int kj_options_list(char *buffer, size_t size);

typedef struct kj_run_status {
  long long cycle;
  double time, time_end, time_step;
  double kinetic, internal, work; /* energies of the last sample */
  double energy_error;            /* fraction, of the last sample */
  int n_joint, n_body, n_node, n_sample;
} kj_run_status;

typedef struct kj_body {
  int id;
  double mass;
  double position[3]; /* centre of gravity (main node) */
  double attitude[4]; /* turn since the start */
  double velocity[3], omega[3]; /* under legacy half a step older */
  double force[3];    /* of joints and loads, gravity apart */
  double moment[3];   /* about the centre of gravity */
} kj_body;

/* Watches a run; returns other than 0 to end it. It may read kj_model_status; whatever loads, runs,
 * starts, steps or changes the model is refused with KJ_INPUT meanwhile, and kj_model_free does
 * nothing. */
typedef int (*kj_tick)(const kj_run_status *status, void *user);

/* Read a deck. starter: path of ROOT_0000.rad; engine: NULL for ROOT_0001.rad (not read when
 * until is given); options: a text as above, NULL for the defaults; message (may be NULL, size 0):
 * all errors of the deck, a line each. *model is NULL when it fails: KJ_FILE when a file cannot be
 * read, else KJ_INPUT. */
int kj_model_load(const char *starter, const char *engine, const char *options, kj_model **model,
                  char *message, size_t size);
void kj_model_free(kj_model *model);
int kj_model_message(const kj_model *model, char *buffer, size_t size);
/* The options that are not left to the deck, with what the formulation decides, in the same form */
int kj_model_options(const kj_model *model, char *buffer, size_t size);
/* Title of the deck, and warnings about it, a line each */
int kj_model_title(const kj_model *model, char *buffer, size_t size);
int kj_model_warnings(const kj_model *model, char *buffer, size_t size);

/* Run from the start to the end; samples are kept in memory. tick, user: may be NULL */
int kj_model_run(kj_model *model, kj_tick tick, void *user);

/* n models, each as kj_model_run does and with the same bits; outcome[i] is what that would return.
 * Small scenes that differ in numbers alone, such as variants of a deck, take their steps together,
 * which is faster. KJ_INPUT, and nothing runs, when a model runs already or is there
 * twice. */
int kj_models_run(int n, kj_model *const *models, kj_tick tick, void *user, int *outcome);

/* Or step by step: state at t = 0; march to a time (legacy: to the first cycle at or beyond it);
 * march one step, or n; keep a sample of the present */
int kj_model_start(kj_model *model);
int kj_model_advance(kj_model *model, double until);
int kj_model_step(kj_model *model);
int kj_model_steps(kj_model *model, int n);
int kj_model_sample(kj_model *model);
int kj_model_status(const kj_model *model, kj_run_status *status);

/* State as bytes: of a started model, restored to one that is loaded from the same deck by the same
 * version. Restored, it is started: go on with advance, step or run, with the same bits. needed: its
 * number of bytes, or NULL; with size 0: that alone */
int kj_model_save(kj_model *model, size_t size, void *state, size_t *needed);
int kj_model_restore(kj_model *model, size_t size, const void *state);

/* Samples in memory. Channels are named as in the history file: "time", "joint/force",
 * "rigid_body/position"; kj_model_channels lists them, a line each. values[n_row][n_entity][n_comp],
 * count = n_row*n_entity*n_comp */
int kj_model_channels(const kj_model *model, char *buffer, size_t size);
int kj_model_shape(kj_model *model, const char *channel, int *n_row, int *n_entity, int *n_comp);
int kj_model_series(kj_model *model, const char *channel, int count, double *values);
/* One curve over the samples, as the command line names it: "joint/force[pin C].x", "mass".
 * values[count], count = n_row */
int kj_model_curve(kj_model *model, const char *name, int count, double *values);
/* Unit of a channel, such as "kg m s-2" */
int kj_model_unit(kj_model *model, const char *channel, char *buffer, size_t size);
/* What a channel means, then a line for each of its entities: id, a blank, label */
int kj_model_about(kj_model *model, const char *channel, char *buffer, size_t size);
/* The samples as a history file (HDF5); KJ_FILE when the library was built without it */
int kj_model_write_history(kj_model *model, const char *path);

/* Overall rating of a curve against another after ISO/TS 18571, 1 = equal: n samples of both, evenly
 * spaced. NaN where it is not defined, as with less than 9; KJ_FILE as above */
int kj_rate_iso18571(int n, const double *reference, const double *curve, double *rating);

/* Ids of all bodies or joints; count: room in ids, must be enough */
int kj_model_body_count(const kj_model *model, int *n);
int kj_model_joint_count(const kj_model *model, int *n);
int kj_model_body_ids(kj_model *model, int count, int *ids);
int kj_model_joint_ids(kj_model *model, int count, int *ids);

/* Between steps: ask ... */
int kj_model_body(kj_model *model, int id, kj_body *body);
int kj_model_joint(kj_model *model, int id, kj_joint_result *result);
int kj_model_node(kj_model *model, int id, double x[3]);
/* ... and change: force and moment on a body until set anew; factor on /CLOAD/id; velocity; pose
 * (consistent only; attitude is the turn since the start); lock of a /PROP/KJOINT2 joint */
int kj_model_set_body_load(kj_model *model, int id, const double force[3], const double moment[3]);
int kj_model_set_load_factor(kj_model *model, int id, double factor);
int kj_model_set_body_velocity(kj_model *model, int id, const double velocity[3],
                               const double omega[3]);
int kj_model_set_body_pose(kj_model *model, int id, const double position[3],
                           const double attitude[4]);
int kj_model_lock_joint(kj_model *model, int id, int locked);

#ifdef __cplusplus
}
#endif
#endif
