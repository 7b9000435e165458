/* An instance's life and its steps. */
#include "instance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- life ---------------------------------------------------------------------------------------------------- */

static void begin(instance *i) {
    situation *s = &i->now;
    life *l = life_of(i);
    int kind = l->kind;
    memset(s, 0, sizeof *s);
    memset(l, 0, sizeof *l);
    l->kind = kind;
    l->mode = MODE_INSTANTIATED;
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
    const char *fault = model_file_read(&i->model, folder);
    if (fault) return fault;
    if (token && strcmp(token, i->model.token) == 0) return NULL;
    model_file_free(&i->model);
    return "the token is not that of the resources: they belong to another model description";
}

instance *instance_new(interface_kind kind, const char *token, const char *folder, message_function message, void *to) {
    instance *i = (instance *)calloc(1, sizeof *i);
    const char *fault;
    if (!i) return NULL;
    i->head.message = message;
    i->head.to = to;
    fault = load(i, token, folder);
    if (fault) {
        fail(i, fault);
        free(i);
        return NULL;
    }
    i->head.life.kind = kind;
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
    if (i->head.life.mode & (MODE_INSTANTIATED | MODE_CONFIGURATION | MODE_INITIALIZATION)) {
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
    i->head.life.mode = i->head.life.kind == INTERFACE_EXCHANGE ? MODE_EVENT : MODE_STEP;
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
    if (!i->head.message) return;
    i->head.message(i->head.to, STATUS_WARNING, "logStatusWarning",
               "the bench is outside the range of speed and torque in which the model was validated; the output `valid` "
               "shows when. The documentation states the range");
}

call_status do_step(instance *i, double from, double length) {
    bench_inputs inputs;
    const char *fault;
    if (!allowed(i, MODE_STEP, "doStep")) return STATUS_ERROR;
    if (start_bench(i) != STATUS_OK) return STATUS_ERROR;
    fault = fault_of_step(life_of(i), from, length, i->bench.state.parameter[BENCH_SAMPLE_TIME]);
    if (fault) return fail(i, fault);
    inputs = i->now.inputs;
    inputs.engine_torque_rate_nm_s += i->now.interpolated_rate_nm_s;
    i->now.interpolated_rate_nm_s = 0.0;
    if (!bench_step(&i->bench, &inputs, length)) {
        i->head.life.mode = MODE_BROKEN;
        return fail(i, "speeds or torques grow without bound: the speed control is not stable with these parameters");
    }
    i->head.life.time = from + length;
    judge_validity(i);
    return STATUS_OK;
}

call_status set_slope(instance *i, unsigned int reference, double slope) {
    if (reference < VR_SPEED_DEMAND || reference > VR_ENGINE_TORQUE_RATE) {
        return fail(i, "no real input has this value reference");
    }
    if (!allowed(i, MODE_STEP | BEFORE_START, "the derivative of an input")) return STATUS_ERROR;
    /* The controller samples its demands, so that their slopes have no effect. */
    if (reference == VR_ENGINE_TORQUE) i->now.interpolated_rate_nm_s = slope;
    return STATUS_OK;
}
