/* dynoid runtime. The bench in time: speed controller, torque control, two masses and a shaft.
 *
 * SI units. T_d is positive when it brakes the dynamometer:
 *   J_d dw_d/dt = T_shaft - T_d, J_e dw_e/dt = T_e - T_shaft, T_shaft = K twist + B (w_e - w_d).
 * The controller runs every sample time. At a sample it reads the encoder and its demand, and its output takes effect
 * after its delay. The torque control follows after another delay, through a lag. Between the instants at which a demand
 * changes, the state moves by the exact solution. A step may therefore have any length and end at any time.
 *
 * Use: bench_start, then bench_step with the inputs of each step; read the outputs by the functions below. A bench is
 * plain data: a copy of the struct is a copy of the bench. No function allocates or keeps anything elsewhere. */
#ifndef DYNOID_BENCH_H
#define DYNOID_BENCH_H

#include "matrix.h"

/* The numbers of the model. */
enum {
    BENCH_DYNO_INERTIA,              /* J_d, kg m2 */
    BENCH_ENGINE_INERTIA,            /* J_e, kg m2 */
    BENCH_STIFFNESS,                 /* K, Nm/rad */
    BENCH_DAMPING,                   /* B, Nm s/rad */
    BENCH_PROPORTIONAL,              /* K_p, Nm s/rad */
    BENCH_INTEGRAL,                  /* K_i, Nm/rad */
    BENCH_CONTROLLER_DELAY,          /* delay of the PI controller's output, s */
    BENCH_DEMAND_DELAY,              /* delay of the speed demand in the speed error, s */
    BENCH_SPEED_FEED_FORWARD,        /* k, Nm s/rad */
    BENCH_ACCELERATION_FEED_FORWARD, /* k_a, Nm s2/rad */
    BENCH_FEED_FORWARD_DELAY,        /* s */
    BENCH_TORQUE_DELAY,              /* delay of the torque control, s */
    BENCH_TORQUE_BANDWIDTH,          /* a of the lag a/(s + a), rad/s; 0 for a delay alone */
    BENCH_TORQUE_LIMIT,              /* limit of |T_d*|, Nm; 0 for none */
    BENCH_ENCODER_GATE,              /* time over which an encoder averages, s; 0 for none */
    BENCH_SAMPLE_TIME,               /* of the controller, s */
    BENCH_PARAMETERS
};

/* Control of the dynamometer. */
enum { BENCH_SPEED_CONTROL = 1, BENCH_TORQUE_CONTROL = 2 };

/* The state: w_d, w_e, twist, torque control's output, and the angles of both sides. */
enum { BENCH_DYNO_SPEED, BENCH_ENGINE_SPEED, BENCH_TWIST, BENCH_TORQUE, BENCH_DYNO_ANGLE, BENCH_ENGINE_ANGLE };

/* Samples that a bench remembers: no delay and no gate may be longer. A power of two. */
#define BENCH_HISTORY 512

/* Where the bench starts. */
typedef struct {
    double speed_rad_s;              /* of both sides */
    double torque_nm;                /* through the whole bench */
    double speed_difference_rad_s;   /* w_e - w_d */
    double twist_offset_rad;         /* beyond torque / K */
    double air_gap_torque_offset_nm; /* T_d beyond the torque */
    double integrator_offset_nm;     /* beyond the torque less the feed-forward of the speed */
} bench_initial;

/* What acts on the bench. */
typedef struct {
    double speed_demand_rad_s;
    double torque_demand_nm;
    double engine_torque_nm;          /* at the start of a step */
    double engine_torque_rate_nm_s;   /* within the step */
} bench_inputs;

/* A part of a sample within which no demand changes. */
typedef struct {
    double from, to;                  /* 0 ... 1 */
    int delayed_back, immediate_back; /* samples that the demand is older than the last one */
    linear_step step;                 /* over the whole part */
} bench_part;

/* What follows from the parameters alone. */
typedef struct {
    linear_system system;
    bench_part part[3];
    int parts;
    linear_step shorter[16];          /* steps over less than a part, as they were needed */
    int shorter_count, shorter_next;
} bench_tables;

/* Everything else. */
typedef struct {
    double parameter[BENCH_PARAMETERS];
    int mode;
    double x[STATES];
    long long tick;                   /* the last sample reached */
    double phase;                     /* how far beyond it, 0 ... 1 */
    double remainder;                 /* of a step that ended so near to a sample that it counts as one */
    int due;                          /* the controller has not run at this sample */
    double held_nm;                   /* T_d* at the torque control's lag */
    double limited_nm;                /* T_d* as the controller gives it, limited */
    double reading[2];                /* speeds as the encoders show them */
    double speeds_seen[2];            /* lowest and highest reading of the dynamometer's speed in the last step */
    double torques_seen[2];           /* lowest and highest T_d in the last step, at its samples and its end */
    double integral_nm;
    double before_nm;                 /* output of the PI controller before the start */
    long long newest;                 /* the last sample with an output of the PI controller; -1 for none */
    double demands[BENCH_HISTORY];    /* the rings: value of sample i at i modulo BENCH_HISTORY */
    double readings[BENCH_HISTORY];
    double delayed[BENCH_HISTORY];
    double immediate[BENCH_HISTORY];
    double angles[2][BENCH_HISTORY];
    double speeds[2][BENCH_HISTORY];
} bench_state;

typedef struct {
    bench_state state;
    bench_tables tables;
} bench;

/* What a parameter must be, with its name. */
const char *bench_limit(int parameter);

/* What is wrong with the parameters, or NULL. */
const char *bench_fault(const double parameter[BENCH_PARAMETERS]);

/* A bench at its start. Returns 0 if its parameters cannot be used. */
int bench_start(bench *b, const double parameter[BENCH_PARAMETERS], int mode, const bench_initial *initial);

/* The tables for the parameters in the state, after either was changed. Returns 0 if these cannot be used. */
int bench_prepare(bench *b);

/* Moves the bench on. Returns 0 if its state leaves the finite numbers. */
int bench_step(bench *b, const bench_inputs *inputs, double seconds);

/* The same in pieces, for those who integrate the state themselves: the encoders are read when a sample is reached,
 * the controller runs on the inputs then, and a demand may change within the sample. */
void bench_read_encoders(bench_state *s);
void bench_run_controller(bench_state *s, const bench_inputs *inputs);
int bench_part_at(const bench *b, double phase);
void bench_hold(bench *b, int part);
void bench_derivative(const bench *b, double engine_torque_nm, double derivative[STATES]);

/* Outputs. Speeds as encoders show them, and T_d*, are those of the last sample. */
double bench_shaft_torque_nm(const bench_state *s);
double bench_air_gap_torque_nm(const bench_state *s);

#endif
