/* What FMI 2.0 and 3.0 need of an instance, whatever it simulates: its life, its values, its states and its steps. */
#ifndef DYNOID_INTERFACE_H
#define DYNOID_INTERFACE_H

#include <stddef.h>

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

/* When inputs and tunable parameters may be set, and values be read. Parameters may not change while a solver integrates. */
enum {
    BEFORE_START = MODE_INSTANTIATED | MODE_INITIALIZATION,
    INPUT_MODES = MODE_INSTANTIATED | MODE_INITIALIZATION | MODE_EVENT | MODE_CONTINUOUS | MODE_STEP,
    TUNABLE_MODES = MODE_INSTANTIATED | MODE_INITIALIZATION | MODE_EVENT | MODE_STEP,
    GET_MODES = 0xff,
    EVALUATION_MODES = MODE_INITIALIZATION | MODE_EVENT | MODE_CONTINUOUS | MODE_TERMINATED
};

typedef enum { INTERFACE_EXCHANGE, INTERFACE_COSIMULATION } interface_kind;

/* Types of whole numbers: FMI 3.0 has one for enumerations and one for integers. */
typedef enum { WHOLE_INTEGER = 1, WHOLE_ENUMERATION = 2 } whole_kind;

/* Mode and times of an instance. */
typedef struct {
    int mode, kind, stop_defined;
    double start, stop, time;
} life;

/* Passes a message on to the importer. */
typedef void (*message_function)(void *to, call_status status, const char *category, const char *message);

/* What every instance begins with. */
typedef struct {
    life life;
    message_function message;
    void *to;
} instance_head;

/* One simulation, and a kept state of one; each runtime has its own. */
typedef struct instance instance;
typedef struct kept_state kept_state;

/* ---- the same for all: life.c --------------------------------------------------------------------------------- */

life *life_of(instance *i);
/* Says what is wrong; returns STATUS_ERROR. */
call_status fail(instance *i, const char *message);
/* Whether a call is allowed in the present mode; says so if it is not. */
int allowed(instance *i, int modes, const char *call);
/* The same for a call of Model Exchange. */
int is_exchange(instance *i, int modes, const char *call);
call_status set_times(instance *i, double start, int stop_defined, double stop);
call_status set_time(instance *i, double time);
call_status enter_mode(instance *i, int from, int mode, const char *call);
/* What is wrong with a step, or NULL. */
const char *fault_of_step(const life *l, double from, double length, double sample_time_s);
/* FNV-1a, so that damaged bytes are refused. */
unsigned long long checksum(const void *bytes, size_t size);

/* ---- of each runtime ------------------------------------------------------------------------------------------ */

/* A new instance, or NULL after a message. `folder` is that of the resources, with or without a separator at its end. */
instance *instance_new(interface_kind kind, const char *token, const char *folder, message_function message, void *to);
void instance_free(instance *i);
call_status leave_initialization(instance *i);
call_status reset(instance *i);

call_status get_reals(instance *i, const unsigned int *reference, size_t count, double *value);
call_status set_reals(instance *i, const unsigned int *reference, size_t count, const double *value);
call_status get_whole(instance *i, whole_kind kind, unsigned int reference, long long *value);
call_status set_whole(instance *i, whole_kind kind, unsigned int reference, long long value);
call_status get_valid(instance *i, unsigned int reference, int *value);
/* The slope of an input within the next step. */
call_status set_slope(instance *i, unsigned int reference, double slope);

call_status keep_state(instance *i, kept_state **kept);
call_status restore_state(instance *i, const kept_state *kept);
size_t size_of_state(const instance *i);
call_status serialize_state(instance *i, const kept_state *kept, void *bytes, size_t size);
call_status deserialize_state(instance *i, const void *bytes, size_t size, kept_state **kept);

call_status do_step(instance *i, double from, double length);

/* The derivative of one variable with respect to another; forward and, with `adjoint`, backward. */
call_status derivatives_along(instance *i, int adjoint, const unsigned int *unknown, size_t unknowns,
                              const unsigned int *known, size_t knowns, const double *seed, double *result);

/* Model Exchange. */
size_t states_of(const instance *i);
call_status set_states(instance *i, const double *x, size_t count);
call_status get_states(instance *i, double *x, size_t count);
call_status get_derivatives(instance *i, double *derivative, size_t count);
call_status get_nominals(instance *i, double *nominal, size_t count);
call_status update_discrete(instance *i, double *next_event);

#endif
