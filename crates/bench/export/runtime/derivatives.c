/* Directional and adjoint derivatives: how outputs, states and their derivatives change with inputs, states, parameters and
 * initial values, at one instant. What the controller's samples hold is held, and follows the initial values at the start. */
#include <string.h>

#include "instance.h"

/* How everything that an output is made of changes with one known. */
typedef struct {
    double parameter[BENCH_PARAMETERS];
    double x[STATES];
    double held_nm, limited_nm, reading[2], engine_torque_nm;
} change;

static int index_in(unsigned int reference, unsigned int first, int count) {
    return reference >= first && reference < first + (unsigned int)count ? (int)(reference - first) : -1;
}

/* ---- by one known -------------------------------------------------------------------------------------------- */

/* What bench_start makes of an initial value, at the place of it in bench_initial. */
static void change_by_initial(const bench_state *s, const situation *now, int place, change *c) {
    const double *p = s->parameter;
    double torque_nm = now->initial[1], most = p[BENCH_TORQUE_LIMIT];
    switch (place) {
    case 0:
        c->x[BENCH_DYNO_SPEED] = c->x[BENCH_ENGINE_SPEED] = 1.0;
        c->reading[0] = c->reading[1] = 1.0;
        break;
    case 1:
        c->x[BENCH_TWIST] = p[BENCH_STIFFNESS] > 0.0 ? 1.0 / p[BENCH_STIFFNESS] : 0.0;
        c->x[BENCH_TORQUE] = c->held_nm = 1.0;
        c->limited_nm = most > 0.0 && (torque_nm > most || torque_nm < -most) ? 0.0 : 1.0;
        break;
    case 2: c->x[BENCH_ENGINE_SPEED] = c->reading[1] = 1.0; break;
    case 3: c->x[BENCH_TWIST] = 1.0; break;
    case 4: c->x[BENCH_TORQUE] = c->held_nm = 1.0; break;
    default: break; /* the integrator acts after the next sample */
    }
}

/* The same of a parameter. */
static void change_at_start(const bench_state *s, const situation *now, int parameter, change *c) {
    double value = s->parameter[parameter], torque_nm = now->initial[1];
    if (parameter == BENCH_STIFFNESS && value > 0.0) c->x[BENCH_TWIST] = -torque_nm / (value * value);
    if (parameter == BENCH_TORQUE_LIMIT && value > 0.0) {
        c->limited_nm = torque_nm > value ? 1.0 : torque_nm < -value ? -1.0 : 0.0;
    }
}

/* Returns 0 for what is no known. */
static int change_by(const instance *i, unsigned int known, change *c) {
    const bench_state *s = &i->bench.state;
    int is_start = i->head.life.mode == MODE_INITIALIZATION;
    int state = index_in(known, VR_STATE, STATES), parameter = index_in(known, VR_PARAMETER, BENCH_PARAMETERS);
    int initial = index_in(known, VR_INITIAL, INITIALS);
    memset(c, 0, sizeof *c);
    if (state >= 0) {
        c->x[state] = 1.0;
    } else if (parameter >= 0) {
        c->parameter[parameter] = 1.0;
        if (is_start) change_at_start(s, &i->now, parameter, c);
    } else if (initial >= 0) {
        if (is_start) change_by_initial(s, &i->now, initial, c);
    } else if (known == VR_ENGINE_TORQUE) {
        c->engine_torque_nm = 1.0;
    } else {
        return known >= VR_SPEED_DEMAND && known <= VR_ENGINE_TORQUE_RATE; /* the controller samples its demands */
    }
    return 1;
}

/* ---- of one unknown ------------------------------------------------------------------------------------------ */

static double shaft_torque_change(const bench_state *s, const change *c) {
    const double *p = s->parameter, *x = s->x;
    return p[BENCH_STIFFNESS] * c->x[BENCH_TWIST] + p[BENCH_DAMPING] * (c->x[BENCH_ENGINE_SPEED] - c->x[BENCH_DYNO_SPEED]) +
           c->parameter[BENCH_STIFFNESS] * x[BENCH_TWIST] +
           c->parameter[BENCH_DAMPING] * (x[BENCH_ENGINE_SPEED] - x[BENCH_DYNO_SPEED]);
}

static double air_gap_torque_change(const bench_state *s, const change *c) {
    return s->parameter[BENCH_TORQUE_BANDWIDTH] > 0.0 ? c->x[BENCH_TORQUE] : c->held_nm;
}

/* Of torque / inertia. */
static double acceleration_change(double torque_nm, double torque_change, double inertia, double inertia_change) {
    return (torque_change - torque_nm / inertia * inertia_change) / inertia;
}

static double derivative_change(const instance *i, int state, const change *c) {
    const bench_state *s = &i->bench.state;
    const double *p = s->parameter;
    double shaft_nm = bench_shaft_torque_nm(s), shaft_change = shaft_torque_change(s, c);
    switch (state) {
    case BENCH_DYNO_SPEED:
        return acceleration_change(shaft_nm - bench_air_gap_torque_nm(s), shaft_change - air_gap_torque_change(s, c),
                                   p[BENCH_DYNO_INERTIA], c->parameter[BENCH_DYNO_INERTIA]);
    case BENCH_ENGINE_SPEED:
        return acceleration_change(i->now.inputs.engine_torque_nm - shaft_nm, c->engine_torque_nm - shaft_change,
                                   p[BENCH_ENGINE_INERTIA], c->parameter[BENCH_ENGINE_INERTIA]);
    case BENCH_TWIST: return c->x[BENCH_ENGINE_SPEED] - c->x[BENCH_DYNO_SPEED];
    case BENCH_TORQUE: /* at 0 the bandwidth means that there is no lag */
        if (p[BENCH_TORQUE_BANDWIDTH] <= 0.0) return 0.0;
        return p[BENCH_TORQUE_BANDWIDTH] * (c->held_nm - c->x[BENCH_TORQUE]) +
               c->parameter[BENCH_TORQUE_BANDWIDTH] * (s->held_nm - s->x[BENCH_TORQUE]);
    case BENCH_DYNO_ANGLE: return c->x[BENCH_DYNO_SPEED];
    default: return c->x[BENCH_ENGINE_SPEED];
    }
}

/* Returns 0 for what is no unknown. */
static int change_of(const instance *i, unsigned int unknown, const change *c, double *value) {
    int derivative = index_in(unknown, VR_DERIVATIVE, STATES), state = index_in(unknown, VR_STATE, STATES);
    if (derivative >= 0) {
        *value = derivative_change(i, derivative, c);
    } else if (state >= 0) {
        *value = c->x[state];
    } else {
        switch (unknown) {
        case VR_SHAFT_TORQUE: *value = shaft_torque_change(&i->bench.state, c); break;
        case VR_AIR_GAP_TORQUE: *value = air_gap_torque_change(&i->bench.state, c); break;
        case VR_DYNO_SPEED: *value = c->reading[0]; break;
        case VR_ENGINE_SPEED: *value = c->reading[1]; break;
        case VR_LIMITED_DEMAND: *value = c->limited_nm; break;
        default: return 0;
        }
    }
    return 1;
}

call_status derivatives_along(instance *i, int adjoint, const unsigned int *unknown, size_t unknowns,
                              const unsigned int *known, size_t knowns, const double *seed, double *result) {
    if (!allowed(i, EVALUATION_MODES | MODE_STEP, "a directional derivative")) return STATUS_ERROR;
    if (start_bench(i) != STATUS_OK) return STATUS_ERROR;
    if (!unknown || !known || !seed || !result) return fail(i, "a directional derivative lacks its arguments");
    for (size_t k = 0; k < (adjoint ? knowns : unknowns); k++) result[k] = 0.0;
    for (size_t column = 0; column < knowns; column++) {
        change by;
        int is_known = change_by(i, known[column], &by);
        for (size_t row = 0; row < unknowns; row++) {
            double value;
            if (!is_known || !change_of(i, unknown[row], &by, &value)) {
                return fail(i, "a directional derivative exists of outputs, states and their derivatives, by inputs, states, "
                               "parameters and initial values");
            }
            if (adjoint) {
                result[column] += value * seed[row];
            } else {
                result[row] += value * seed[column];
            }
        }
    }
    return STATUS_OK;
}
