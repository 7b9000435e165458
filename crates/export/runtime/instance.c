/* An instance's life and its steps. */
#include "instance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A longer step would not end. */
static const double MOST_SAMPLES = 1e9;
/* How far a communication point may be off, in samples, and relative to the time. */
static const double TIME_SAMPLES = 1e-2, TIME_RELATIVE = 1e-9;

call_status fail(instance *i, const char *message) {
    if (i && i->message) i->message(i->to, STATUS_ERROR, "logStatusError", message);
    return STATUS_ERROR;
}

int allowed(instance *i, int modes, const char *call) {
    char message[200] = "this call is not allowed now: ";
    if (!i) return 0;
    if (i->now.mode & modes) return 1;
    strncat(message, call, 60);
    strcat(message, i->now.mode == MODE_BROKEN ? ". A step failed; reset the instance or set an earlier state"
                                               : ". See the modes in the FMI standard");
    fail(i, message);
    return 0;
}

/* ---- life ---------------------------------------------------------------------------------------------------- */

static void begin(instance *i) {
    situation *s = &i->now;
    int kind = s->kind;
    memset(s, 0, sizeof *s);
    s->kind = kind;
    s->mode = MODE_INSTANTIATED;
    s->control_mode = i->model.has_speed_control ? BENCH_SPEED_CONTROL : BENCH_TORQUE_CONTROL;
    s->is_valid = 1;
    s->fresh = 1;
    memcpy(s->set, i->model.estimate, sizeof s->set);
    s->initial[0] = i->model.initial.speed_rad_s;
    s->initial[1] = i->model.initial.torque_nm;
    s->inputs.speed_demand_rad_s = i->model.initial.speed_rad_s;
    s->inputs.torque_demand_nm = i->model.initial.torque_nm;
    s->inputs.engine_torque_nm = i->model.initial.torque_nm;
}

static const char *load(instance *i, const char *token, const char *folder) {
    static const char FILE_NAME[] = "bench.txt";
    size_t length = folder ? strlen(folder) : 0;
    const char *fault;
    char *path;
    if (length == 0) return "there is no folder of resources; the model is in the file bench.txt there";
    path = (char *)malloc(length + 1 + sizeof FILE_NAME);
    if (!path) return "there is no memory for an instance";
    memcpy(path, folder, length);
    if (path[length - 1] != '/' && path[length - 1] != '\\') path[length++] = '/';
    memcpy(path + length, FILE_NAME, sizeof FILE_NAME);
    fault = model_file_read(&i->model, path);
    free(path);
    if (fault) return fault;
    if (!token || strcmp(token, i->model.token) != 0) {
        model_file_free(&i->model);
        return "the token is not that of the resources: they belong to another model description";
    }
    return NULL;
}

instance *instance_new(interface_kind kind, const char *token, const char *folder, message_function message, void *to) {
    instance *i = (instance *)calloc(1, sizeof *i);
    const char *fault;
    if (!i) return NULL;
    i->message = message;
    i->to = to;
    fault = load(i, token, folder);
    if (fault) {
        fail(i, fault);
        free(i);
        return NULL;
    }
    i->now.kind = kind;
    begin(i);
    return i;
}

void instance_free(instance *i) {
    if (!i) return;
    model_file_free(&i->model);
    free(i);
}

call_status reset(instance *i) {
    if (!i) return STATUS_ERROR;
    begin(i);
    memset(&i->bench, 0, sizeof i->bench);
    return STATUS_OK;
}

call_status set_times(instance *i, double start, int stop_defined, double stop) {
    if (!isfinite(start)) return fail(i, "the start time is not a number");
    if (stop_defined && !(stop >= start && isfinite(stop))) return fail(i, "the stop time is before the start time");
    i->now.start = i->now.time = start;
    i->now.stop_defined = stop_defined;
    i->now.stop = stop_defined ? stop : 0.0;
    return STATUS_OK;
}

call_status enter_mode(instance *i, int from, int mode, const char *call) {
    if (!allowed(i, from, call)) return STATUS_ERROR;
    i->now.mode = mode;
    return STATUS_OK;
}

/* The parameters that act: as set, or else of the draw, or else the estimate. */
static void acting_parameters(const instance *i, double acting[BENCH_PARAMETERS]) {
    const bench_model *model = &i->model;
    memcpy(acting, i->now.set, sizeof i->now.set);
    if (i->now.draw < 1 || i->now.draw > model->draws) return;
    for (int j = 0; j < model->columns; j++) {
        int parameter = model->column[j];
        if (i->now.set[parameter] != model->estimate[parameter]) continue;
        acting[parameter] = model->draw[(size_t)(i->now.draw - 1) * (size_t)model->columns + (size_t)j];
    }
}

call_status start_bench(instance *i) {
    double acting[BENCH_PARAMETERS];
    const double *initial = i->now.initial;
    bench_initial start = {initial[0], initial[1], initial[2], initial[3], initial[4], initial[5]};
    if (!i->now.fresh) return STATUS_OK;
    acting_parameters(i, acting);
    if (i->now.mode & (MODE_INSTANTIATED | MODE_CONFIGURATION | MODE_INITIALIZATION)) {
        if (!bench_start(&i->bench, acting, i->now.control_mode, &start)) {
            const char *fault = bench_fault(acting);
            return fail(i, fault ? fault : "the parameters are so large that the model has no exact step");
        }
    } else {
        memcpy(i->bench.state.parameter, acting, sizeof acting);
        if (!bench_prepare(&i->bench)) {
            const char *fault = bench_fault(acting);
            return fail(i, fault ? fault : "the parameters are so large that the model has no exact step");
        }
    }
    i->now.fresh = 0;
    return STATUS_OK;
}

call_status leave_initialization(instance *i) {
    if (!allowed(i, MODE_INITIALIZATION, "exitInitializationMode")) return STATUS_ERROR;
    if (i->now.control_mode == BENCH_SPEED_CONTROL && !i->model.has_speed_control) {
        return fail(i, "the model has no speed controller: set control_mode to torque control (2)");
    }
    if (start_bench(i) != STATUS_OK) return STATUS_ERROR;
    i->now.mode = i->now.kind == INTERFACE_EXCHANGE ? MODE_EVENT : MODE_STEP;
    return STATUS_OK;
}

/* ---- steps --------------------------------------------------------------------------------------------------- */

static int is_within(const double range[2], const double seen[2]) { return seen[0] >= range[0] && seen[1] <= range[1]; }

void judge_validity(instance *i) {
    const bench_state *s = &i->bench.state;
    i->now.is_valid = is_within(i->model.speed_range_rad_s, s->speeds_seen) &&
                      is_within(i->model.torque_range_nm, s->torques_seen);
    if (i->now.is_valid || i->now.told_invalid) return;
    i->now.told_invalid = 1;
    if (!i->message) return;
    i->message(i->to, STATUS_WARNING, "logStatusWarning",
               "the bench is outside the range of speed and torque in which the model was validated; the output `valid` "
               "shows when. The documentation states the range");
}

static const char *fault_of_step(const situation *s, double from, double length, double sample_time_s) {
    double near = TIME_SAMPLES * sample_time_s + TIME_RELATIVE * fabs(s->time);
    if (!isfinite(from) || !isfinite(length)) return "the time or the length of the step is not a number";
    if (!(length > 0.0)) return "the length of the step is not above zero";
    if (from < s->time - near) return "the step begins before the present time; set an earlier state to go back";
    if (from > s->time + near) return "the step begins after the present time; steps must follow one another";
    if (s->stop_defined && from + length > s->stop + near) return "the step ends after the stop time";
    if (length > MOST_SAMPLES * sample_time_s) return "the step is longer than 1e9 samples of the controller";
    return NULL;
}

call_status do_step(instance *i, double from, double length) {
    bench_inputs inputs;
    const char *fault;
    if (!allowed(i, MODE_STEP, "doStep")) return STATUS_ERROR;
    if (start_bench(i) != STATUS_OK) return STATUS_ERROR;
    fault = fault_of_step(&i->now, from, length, i->bench.state.parameter[BENCH_SAMPLE_TIME]);
    if (fault) return fail(i, fault);
    inputs = i->now.inputs;
    inputs.engine_torque_rate_nm_s += i->now.interpolated_rate_nm_s;
    i->now.interpolated_rate_nm_s = 0.0;
    if (!bench_step(&i->bench, &inputs, length)) {
        i->now.mode = MODE_BROKEN;
        return fail(i, "speeds or torques grow without bound: the speed control is not stable with these parameters");
    }
    i->now.time = from + length;
    judge_validity(i);
    return STATUS_OK;
}
