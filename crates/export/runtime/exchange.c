/* Model Exchange: the importer integrates, and the instance gives derivatives and its next event. */
#include <math.h>

#include "instance.h"

/* Part of a sample by which an event may come early. */
static const double EARLY = 1e-5;
/* Steps of the states that matter: rad/s, rad and Nm. */
static const double NOMINALS[STATES] = {100.0, 100.0, 0.01, 100.0, 100.0, 100.0};

static call_status check_count(instance *i, size_t count, const double *values) {
    if (count != STATES || !values) return fail(i, "the model has 6 continuous states");
    return STATUS_OK;
}

size_t states_of(const instance *i) { return i ? STATES : 0; }

call_status set_states(instance *i, const double *x, size_t count) {
    if (!is_exchange(i, MODE_CONTINUOUS, "setContinuousStates")) return STATUS_ERROR;
    if (check_count(i, count, x) != STATUS_OK) return STATUS_ERROR;
    for (int j = 0; j < STATES; j++) {
        if (!isfinite(x[j])) return fail(i, "a continuous state is not a finite number");
    }
    for (int j = 0; j < STATES; j++) i->bench.state.x[j] = x[j];
    return STATUS_OK;
}

call_status get_states(instance *i, double *x, size_t count) {
    if (!is_exchange(i, EVALUATION_MODES, "getContinuousStates")) return STATUS_ERROR;
    if (check_count(i, count, x) != STATUS_OK || start_bench(i) != STATUS_OK) return STATUS_ERROR;
    for (int j = 0; j < STATES; j++) x[j] = i->bench.state.x[j];
    return STATUS_OK;
}

call_status get_derivatives(instance *i, double *derivative, size_t count) {
    if (!is_exchange(i, EVALUATION_MODES, "getDerivatives")) return STATUS_ERROR;
    if (check_count(i, count, derivative) != STATUS_OK || start_bench(i) != STATUS_OK) return STATUS_ERROR;
    bench_derivative(&i->bench, i->now.inputs.engine_torque_nm, derivative);
    return STATUS_OK;
}

call_status get_nominals(instance *i, double *nominal, size_t count) {
    if (!is_exchange(i, MODE_INSTANTIATED | EVALUATION_MODES, "getNominalsOfContinuousStates")) return STATUS_ERROR;
    if (check_count(i, count, nominal) != STATUS_OK) return STATUS_ERROR;
    for (int j = 0; j < STATES; j++) nominal[j] = NOMINALS[j];
    return STATUS_OK;
}

/* ---- events -------------------------------------------------------------------------------------------------- */

static void see(instance *i) {
    bench_state *s = &i->bench.state;
    s->speeds_seen[0] = s->speeds_seen[1] = s->reading[0];
    s->torques_seen[0] = s->torques_seen[1] = bench_air_gap_torque_nm(s);
    judge_validity(i);
}

call_status update_discrete(instance *i, double *next_event) {
    bench_state *s;
    double sample_time_s, samples;
    int part;
    if (!is_exchange(i, MODE_EVENT, "the update of discrete states")) return STATUS_ERROR;
    if (start_bench(i) != STATUS_OK) return STATUS_ERROR;
    s = &i->bench.state;
    sample_time_s = s->parameter[BENCH_SAMPLE_TIME];
    samples = (i->head.life.time - i->head.life.start) / sample_time_s - (double)s->tick;
    if (samples >= 2.0 - EARLY) return fail(i, "an event of the controller was passed over; stop at the event times");
    if (samples < -EARLY) return fail(i, "the time is before the last event of the controller");
    if (samples >= 1.0 - EARLY) {
        s->tick++;
        samples -= 1.0;
        bench_read_encoders(s);
        s->due = 1;
    }
    if (s->due) bench_run_controller(s, &i->now.inputs);
    part = bench_part_at(&i->bench, samples + EARLY);
    bench_hold(&i->bench, part);
    see(i);
    *next_event = i->head.life.start + ((double)s->tick + i->bench.tables.part[part].to) * sample_time_s;
    return STATUS_OK;
}

/* ---- directional derivatives --------------------------------------------------------------------------------- */

static int state_of(unsigned int reference) {
    return reference >= VR_STATE && reference < VR_STATE + STATES ? (int)(reference - VR_STATE) : -1;
}

/* What one known contributes to one unknown; what is held between events contributes nothing. 0 for a wrong reference. */
static int partial(const instance *i, unsigned int unknown, unsigned int known, double *value) {
    const double *p = i->bench.state.parameter;
    int state = state_of(known);
    int is_input = known >= VR_SPEED_DEMAND && known <= VR_ENGINE_TORQUE_RATE;
    *value = 0.0;
    if (state < 0 && !is_input) return 0;
    if (unknown >= VR_DERIVATIVE && unknown < VR_DERIVATIVE + STATES) {
        int row = (int)(unknown - VR_DERIVATIVE);
        if (state >= 0) *value = i->bench.tables.system.a[row][state];
        if (known == VR_ENGINE_TORQUE) *value = i->bench.tables.system.b[row][1];
        return 1;
    }
    if (state_of(unknown) >= 0) {
        *value = unknown == known ? 1.0 : 0.0;
        return 1;
    }
    switch (unknown) {
    case VR_SHAFT_TORQUE:
        if (state == BENCH_TWIST) *value = p[BENCH_STIFFNESS];
        if (state == BENCH_ENGINE_SPEED) *value = p[BENCH_DAMPING];
        if (state == BENCH_DYNO_SPEED) *value = -p[BENCH_DAMPING];
        return 1;
    case VR_AIR_GAP_TORQUE:
        if (state == BENCH_TORQUE && p[BENCH_TORQUE_BANDWIDTH] > 0.0) *value = 1.0;
        return 1;
    case VR_DYNO_SPEED:
    case VR_ENGINE_SPEED:
    case VR_LIMITED_DEMAND: return 1;
    default: return 0;
    }
}

call_status derivatives_along(instance *i, int adjoint, const unsigned int *unknown, size_t unknowns,
                              const unsigned int *known, size_t knowns, const double *seed, double *result) {
    if (!is_exchange(i, EVALUATION_MODES, "a directional derivative")) return STATUS_ERROR;
    if (start_bench(i) != STATUS_OK) return STATUS_ERROR;
    if (!unknown || !known || !seed || !result) return fail(i, "a directional derivative lacks its arguments");
    for (size_t k = 0; k < (adjoint ? knowns : unknowns); k++) result[k] = 0.0;
    for (size_t row = 0; row < unknowns; row++) {
        for (size_t column = 0; column < knowns; column++) {
            double value;
            if (!partial(i, unknown[row], known[column], &value)) {
                return fail(i, "a directional derivative exists of derivatives and outputs, by states and inputs");
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
