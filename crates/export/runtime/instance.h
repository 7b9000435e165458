/* One simulated bench behind FMI: its variables, its modes and its messages, the same for FMI 2.0 and 3.0. */
#ifndef DYNOID_INSTANCE_H
#define DYNOID_INSTANCE_H

#include <stddef.h>

#include "model_file.h"

/* The status of a call, with the numbers of FMI. */
typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL } call_status;

/* Where an instance is in its life. Bits, so that a call can name all the modes in which it is allowed. */
enum {
    MODE_INSTANTIATED = 1,
    MODE_CONFIGURATION = 2,
    MODE_INITIALIZATION = 4,
    MODE_EVENT = 8,
    MODE_CONTINUOUS = 16,
    MODE_STEP = 32,
    MODE_TERMINATED = 64,
    MODE_BROKEN = 128 /* a step failed; a reset or an earlier state helps */
};

/* Value references. */
enum {
    VR_TIME = 0,
    VR_SPEED_DEMAND = 1,
    VR_TORQUE_DEMAND,
    VR_ENGINE_TORQUE,
    VR_ENGINE_TORQUE_RATE,
    VR_PARAMETER = 10, /* and those after it, in the order of bench.h */
    VR_INITIAL = 30,   /* and those after it, in the order of bench_initial */
    VR_CONTROL_MODE = 40,
    VR_DRAW,
    VR_DYNO_SPEED = 50,
    VR_ENGINE_SPEED,
    VR_AIR_GAP_TORQUE,
    VR_SHAFT_TORQUE,
    VR_LIMITED_DEMAND,
    VR_VALID,
    VR_STATE = 60,
    VR_DERIVATIVE = 70
};
#define INITIALS 6

typedef enum { INTERFACE_EXCHANGE, INTERFACE_COSIMULATION } interface_kind;

/* Types of whole numbers: FMI 3.0 has one for enumerations and one for integers. */
typedef enum { WHOLE_INTEGER = 1, WHOLE_ENUMERATION = 2 } whole_kind;

/* Everything about an instance that changes, but for the bench itself. */
typedef struct {
    int mode, kind;
    int control_mode, draw;
    int stop_defined, is_valid, told_invalid;
    int fresh;                       /* the bench has not been started with the present parameters */
    double start, stop, time;
    double set[BENCH_PARAMETERS];    /* as set; where equal to the estimate, the draw has the word */
    double initial[INITIALS];
    bench_inputs inputs;
    double interpolated_rate_nm_s;   /* slope of the engine torque within the next step, by FMI 2.0's input derivatives */
} situation;

/* Passes a message on to the importer. */
typedef void (*message_function)(void *to, call_status status, const char *category, const char *message);

typedef struct {
    situation now;
    bench bench;
    bench_model model;
    message_function message;
    void *to;
} instance;

/* A kept state. */
typedef struct {
    unsigned long long mark;         /* of the layout */
    unsigned long long check;        /* of the bytes after it */
    situation now;
    bench_state bench;
} kept_state;

/* A new instance, or NULL after a message. `folder` is that of the resources, with or without a separator at its end. */
instance *instance_new(interface_kind kind, const char *token, const char *folder, message_function message, void *to);
void instance_free(instance *i);

/* Says what is wrong; returns STATUS_ERROR. */
call_status fail(instance *i, const char *message);
/* Whether a call is allowed in the present mode; says so if it is not. */
int allowed(instance *i, int modes, const char *call);

call_status set_times(instance *i, double start, int stop_defined, double stop);
call_status enter_mode(instance *i, int from, int mode, const char *call);
call_status leave_initialization(instance *i);
call_status reset(instance *i);
/* Starts the bench with the present parameters, if it has not been. */
call_status start_bench(instance *i);

call_status get_reals(instance *i, const unsigned int *reference, size_t count, double *value);
call_status set_reals(instance *i, const unsigned int *reference, size_t count, const double *value);
call_status get_whole(instance *i, whole_kind kind, unsigned int reference, long long *value);
call_status set_whole(instance *i, whole_kind kind, unsigned int reference, long long value);
call_status get_valid(instance *i, unsigned int reference, int *value);

call_status keep_state(instance *i, kept_state **kept);
call_status restore_state(instance *i, const kept_state *kept);
call_status serialize_state(instance *i, const kept_state *kept, void *bytes, size_t size);
call_status deserialize_state(instance *i, const void *bytes, size_t size, kept_state **kept);

call_status do_step(instance *i, double from, double length);
void judge_validity(instance *i);

/* Model Exchange. */
call_status set_time(instance *i, double time);
call_status set_states(instance *i, const double *x, size_t count);
call_status get_states(instance *i, double *x, size_t count);
call_status get_derivatives(instance *i, double *derivative, size_t count);
call_status get_nominals(instance *i, double *nominal, size_t count);
call_status update_discrete(instance *i, double *next_event);
/* The derivative of one variable with respect to another; forward and, with `adjoint`, backward. */
call_status derivatives_along(instance *i, int adjoint, const unsigned int *unknown, size_t unknowns,
                              const unsigned int *known, size_t knowns, const double *seed, double *result);

#endif
