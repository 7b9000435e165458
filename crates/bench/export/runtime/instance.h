/* One simulated bench behind FMI: its variables, its modes and its messages, the same for FMI 2.0 and 3.0. */
#ifndef DYNOID_INSTANCE_H
#define DYNOID_INSTANCE_H

#include "interface.h"
#include "model_file.h"

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

/* Everything about an instance that changes, but for its life and the bench itself. */
typedef struct {
    int control_mode, draw;
    int is_valid, told_invalid;
    int fresh;                       /* the bench has not been started with the present parameters */
    double set[BENCH_PARAMETERS];    /* as set; where equal to the estimate, the draw has the word */
    double initial[INITIALS];
    bench_inputs inputs;
    double interpolated_rate_nm_s;   /* slope of the engine torque within the next step, by FMI 2.0's input derivatives */
} situation;

struct instance {
    instance_head head;
    situation now;
    bench bench;
    bench_model model;
};

struct kept_state {
    unsigned long long mark;         /* of the layout */
    unsigned long long check;        /* of the bytes after it */
    life life;
    situation now;
    bench_state bench;
};

/* Starts the bench with the present parameters, if it has not been. */
call_status start_bench(instance *i);
void judge_validity(instance *i);

#endif
