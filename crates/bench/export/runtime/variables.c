/* The variables of an instance, by their value references. */
#include "instance.h"

#include <math.h>
#include <string.h>

static int is_in(unsigned int reference, unsigned int first, unsigned int count) {
    return reference >= first && reference < first + count;
}

static double *input_slot(situation *s, unsigned int reference) {
    switch (reference) {
    case VR_SPEED_DEMAND: return &s->inputs.speed_demand_rad_s;
    case VR_TORQUE_DEMAND: return &s->inputs.torque_demand_nm;
    case VR_ENGINE_TORQUE: return &s->inputs.engine_torque_nm;
    case VR_ENGINE_TORQUE_RATE: return &s->inputs.engine_torque_rate_nm_s;
    default: return NULL;
    }
}

/* ---- get ----------------------------------------------------------------------------------------------------- */

static int output(const instance *i, unsigned int reference, double *value) {
    const bench_state *s = &i->bench.state;
    switch (reference) {
    case VR_DYNO_SPEED: *value = s->reading[0]; return 1;
    case VR_ENGINE_SPEED: *value = s->reading[1]; return 1;
    case VR_AIR_GAP_TORQUE: *value = bench_air_gap_torque_nm(s); return 1;
    case VR_SHAFT_TORQUE: *value = bench_shaft_torque_nm(s); return 1;
    case VR_LIMITED_DEMAND: *value = s->limited_nm; return 1;
    default: return 0;
    }
}

static int real_value(instance *i, unsigned int reference, double *value) {
    const double *input = input_slot(&i->now, reference);
    if (reference == VR_TIME) {
        *value = i->head.life.time;
    } else if (input) {
        *value = *input;
    } else if (is_in(reference, VR_PARAMETER, BENCH_PARAMETERS)) {
        *value = i->bench.state.parameter[reference - VR_PARAMETER];
    } else if (is_in(reference, VR_INITIAL, INITIALS)) {
        *value = i->now.initial[reference - VR_INITIAL];
    } else if (is_in(reference, VR_STATE, STATES)) {
        *value = i->bench.state.x[reference - VR_STATE];
    } else if (is_in(reference, VR_DERIVATIVE, STATES)) {
        double derivative[STATES];
        bench_derivative(&i->bench, i->now.inputs.engine_torque_nm, derivative);
        *value = derivative[reference - VR_DERIVATIVE];
    } else {
        return output(i, reference, value);
    }
    return 1;
}

call_status get_reals(instance *i, const unsigned int *reference, size_t count, double *value) {
    if (!allowed(i, GET_MODES, "get")) return STATUS_ERROR;
    if (count > 0 && (!reference || !value)) return fail(i, "there is no room for the values");
    if (start_bench(i) != STATUS_OK) return STATUS_ERROR;
    for (size_t k = 0; k < count; k++) {
        if (!real_value(i, reference[k], &value[k])) return fail(i, "no real variable has this value reference");
    }
    return STATUS_OK;
}

call_status get_whole(instance *i, whole_kind kind, unsigned int reference, long long *value) {
    if (!allowed(i, GET_MODES, "get")) return STATUS_ERROR;
    if (reference == VR_CONTROL_MODE && kind & WHOLE_ENUMERATION) {
        *value = i->now.control_mode;
    } else if (reference == VR_DRAW && kind & WHOLE_INTEGER) {
        *value = i->now.draw;
    } else {
        return fail(i, "no variable of this type has this value reference");
    }
    return STATUS_OK;
}

call_status get_valid(instance *i, unsigned int reference, int *value) {
    if (!allowed(i, GET_MODES, "get")) return STATUS_ERROR;
    if (reference != VR_VALID) return fail(i, "no Boolean variable has this value reference");
    *value = i->now.is_valid;
    return STATUS_OK;
}

/* ---- set ----------------------------------------------------------------------------------------------------- */

/* A parameter that fits the others. Before the start several may be set that fit only together. */
static call_status set_parameter(instance *i, int parameter, double value) {
    int modes = parameter == BENCH_SAMPLE_TIME ? BEFORE_START : TUNABLE_MODES;
    double before = i->now.set[parameter];
    if (!allowed(i, modes, "set of a parameter")) return STATUS_ERROR;
    i->now.set[parameter] = value;
    i->now.fresh = 1;
    if (i->head.life.mode == MODE_INSTANTIATED || start_bench(i) == STATUS_OK) return STATUS_OK;
    i->now.set[parameter] = before;
    return STATUS_ERROR;
}

static call_status set_real(instance *i, unsigned int reference, double value) {
    double *input = input_slot(&i->now, reference);
    if (!isfinite(value)) {
        int is_parameter = is_in(reference, VR_PARAMETER, BENCH_PARAMETERS);
        return fail(i, is_parameter ? bench_limit((int)(reference - VR_PARAMETER)) : "a value that is set is not a finite number");
    }
    if (input) {
        if (!allowed(i, INPUT_MODES, "set of an input")) return STATUS_ERROR;
        *input = value;
        return STATUS_OK;
    }
    if (is_in(reference, VR_PARAMETER, BENCH_PARAMETERS)) return set_parameter(i, (int)(reference - VR_PARAMETER), value);
    if (is_in(reference, VR_INITIAL, INITIALS)) {
        if (!allowed(i, BEFORE_START, "set of an initial value")) return STATUS_ERROR;
        i->now.initial[reference - VR_INITIAL] = value;
        i->now.fresh = 1;
        return STATUS_OK;
    }
    return fail(i, "no real input or parameter has this value reference");
}

call_status set_reals(instance *i, const unsigned int *reference, size_t count, const double *value) {
    if (!i) return STATUS_ERROR;
    if (count > 0 && (!reference || !value)) return fail(i, "there are no values to set");
    for (size_t k = 0; k < count; k++) {
        if (set_real(i, reference[k], value[k]) != STATUS_OK) return STATUS_ERROR;
    }
    return STATUS_OK;
}

static call_status set_draw(instance *i, long long value) {
    int before = i->now.draw;
    if (!allowed(i, TUNABLE_MODES, "set of draw")) return STATUS_ERROR;
    if (value < 0 || value > i->model.draws) return fail(i, "draw is below 0 or beyond the number of stored draws");
    i->now.draw = (int)value;
    i->now.fresh = 1;
    if (i->head.life.mode == MODE_INSTANTIATED || start_bench(i) == STATUS_OK) return STATUS_OK;
    i->now.draw = before;
    return STATUS_ERROR;
}

call_status set_whole(instance *i, whole_kind kind, unsigned int reference, long long value) {
    if (!i) return STATUS_ERROR;
    if (reference == VR_DRAW && kind & WHOLE_INTEGER) return set_draw(i, value);
    if (reference == VR_CONTROL_MODE && kind & WHOLE_ENUMERATION) {
        if (!allowed(i, BEFORE_START, "set of control_mode")) return STATUS_ERROR;
        if (value != BENCH_SPEED_CONTROL && value != BENCH_TORQUE_CONTROL) {
            return fail(i, "control_mode is neither 1 (speed control) nor 2 (torque control)");
        }
        i->now.control_mode = (int)value;
        i->now.fresh = 1;
        return STATUS_OK;
    }
    return fail(i, "no input and no parameter of this type has this value reference");
}
