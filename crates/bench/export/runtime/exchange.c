/* Model Exchange: the importer integrates, and the instance gives derivatives and its next event. */
#include <math.h>

#include "instance.h"

/* Part of a sample by which an event may come early. */
static const double EARLY = 1e-5;

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
    for (int j = 0; j < STATES; j++) nominal[j] = i->model.nominal[j];
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
