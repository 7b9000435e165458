/* dynoid runtime. The bench in time; see bench.h. */
#include "bench.h"

#include <math.h>
#include <string.h>

/* Part of a sample below which two instants count as one. */
static const double INSTANT = 1e-9;
/* Part of a sample to which the end of a step is taken as a sample. The rest is part of the next step. */
static const double NEAR = 1e-5;
/* Part of a sample to which the length of a step within a sample is rounded: 2^-40. */
static const double ROUNDED = 1.0 / 1099511627776.0;
/* Angles are taken back by this, rad, so that they keep their precision: 160 turns, which are 80 working cycles of four strokes. What
 * an importer calculates from the angle of the cycle does not jump then. An angle just beyond loses nothing by it. */
static const double TURN_BACK = 160.0 * 6.283185307179586;

static int at(long long sample) { return (int)((unsigned long long)sample & (BENCH_HISTORY - 1)); }

static long long not_below_zero(long long sample) { return sample < 0 ? 0 : sample; }

static double limit(const bench_state *s, double torque_nm) {
    double most = s->parameter[BENCH_TORQUE_LIMIT];
    if (most <= 0.0) return torque_nm;
    return torque_nm > most ? most : torque_nm < -most ? -most : torque_nm;
}

/* ---- parameters ---------------------------------------------------------------------------------------------- */

/* What a parameter can be, and what is said of another value. */
enum { ANY_NUMBER, FROM_ZERO, ABOVE_ZERO, FROM_HALF_A_SAMPLE_BEFORE_ZERO };

#define NUMBER(name) ANY_NUMBER, name " must be a finite number"
#define NOT_NEGATIVE(name, unit) FROM_ZERO, name " must be a finite number, 0 " unit " or above"
#define POSITIVE(name, unit) ABOVE_ZERO, name " must be a finite number above 0 " unit
/* These count in whole samples, so that a little below zero is zero. */
#define SAMPLED(name) FROM_HALF_A_SAMPLE_BEFORE_ZERO, name " must be a finite number, 0 s or above"

static const struct {
    int can_be;
    const char *fault;
} LIMIT[BENCH_PARAMETERS] = {
    [BENCH_DYNO_INERTIA] = {POSITIVE("J_d", "kg m2")},
    [BENCH_ENGINE_INERTIA] = {POSITIVE("J_e", "kg m2")},
    [BENCH_STIFFNESS] = {NOT_NEGATIVE("K", "Nm/rad")},
    [BENCH_DAMPING] = {NOT_NEGATIVE("B", "Nm s/rad")},
    [BENCH_PROPORTIONAL] = {NUMBER("K_p")},
    [BENCH_INTEGRAL] = {NUMBER("K_i")},
    [BENCH_CONTROLLER_DELAY] = {NOT_NEGATIVE("tau_c", "s")},
    [BENCH_DEMAND_DELAY] = {SAMPLED("tau_n")},
    [BENCH_SPEED_FEED_FORWARD] = {NUMBER("k")},
    [BENCH_ACCELERATION_FEED_FORWARD] = {NUMBER("k_a")},
    [BENCH_FEED_FORWARD_DELAY] = {SAMPLED("tau_f")},
    [BENCH_TORQUE_DELAY] = {NOT_NEGATIVE("tau_t", "s")},
    [BENCH_TORQUE_BANDWIDTH] = {NOT_NEGATIVE("a", "rad/s")},
    [BENCH_TORQUE_LIMIT] = {NOT_NEGATIVE("T_limit", "Nm")},
    [BENCH_ENCODER_GATE] = {NOT_NEGATIVE("T_gate", "s")},
    [BENCH_SAMPLE_TIME] = {POSITIVE("T_s", "s")},
};

static int is_possible(int can_be, double value, double sample_time) {
    if (!isfinite(value)) return 0;
    switch (can_be) {
    case FROM_ZERO: return value >= 0.0;
    case ABOVE_ZERO: return value > 0.0;
    case FROM_HALF_A_SAMPLE_BEFORE_ZERO: return value > -0.5 * sample_time;
    default: return 1;
    }
}

const char *bench_limit(int parameter) { return LIMIT[parameter].fault; }

const char *bench_fault(const double p[BENCH_PARAMETERS]) {
    double sample_time = p[BENCH_SAMPLE_TIME], longest = (BENCH_HISTORY - 4) * sample_time;
    if (!is_possible(ABOVE_ZERO, sample_time, sample_time)) return bench_limit(BENCH_SAMPLE_TIME);
    for (int i = 0; i < BENCH_PARAMETERS; i++) {
        if (!is_possible(LIMIT[i].can_be, p[i], sample_time)) return bench_limit(i);
    }
    if (p[BENCH_CONTROLLER_DELAY] + p[BENCH_TORQUE_DELAY] > longest) return "tau_c + tau_t must be at most 508 T_s";
    if (p[BENCH_DEMAND_DELAY] + p[BENCH_TORQUE_DELAY] > longest) return "tau_n + tau_t must be at most 508 T_s";
    if (p[BENCH_FEED_FORWARD_DELAY] > longest) return "tau_f must be at most 508 T_s";
    if (p[BENCH_ENCODER_GATE] > longest) return "T_gate must be at most 508 T_s";
    return NULL;
}

/* Without a lag the first input is T_d itself. */
static void continuous(const double p[BENCH_PARAMETERS], linear_system *system) {
    double jd = p[BENCH_DYNO_INERTIA], je = p[BENCH_ENGINE_INERTIA];
    double k = p[BENCH_STIFFNESS], b = p[BENCH_DAMPING], bandwidth = p[BENCH_TORQUE_BANDWIDTH];
    memset(system, 0, sizeof *system);
    system->a[BENCH_DYNO_SPEED][BENCH_DYNO_SPEED] = -b / jd;
    system->a[BENCH_DYNO_SPEED][BENCH_ENGINE_SPEED] = b / jd;
    system->a[BENCH_DYNO_SPEED][BENCH_TWIST] = k / jd;
    system->a[BENCH_ENGINE_SPEED][BENCH_DYNO_SPEED] = b / je;
    system->a[BENCH_ENGINE_SPEED][BENCH_ENGINE_SPEED] = -b / je;
    system->a[BENCH_ENGINE_SPEED][BENCH_TWIST] = -k / je;
    system->a[BENCH_TWIST][BENCH_DYNO_SPEED] = -1.0;
    system->a[BENCH_TWIST][BENCH_ENGINE_SPEED] = 1.0;
    system->a[BENCH_DYNO_ANGLE][BENCH_DYNO_SPEED] = 1.0;
    system->a[BENCH_ENGINE_ANGLE][BENCH_ENGINE_SPEED] = 1.0;
    system->b[BENCH_ENGINE_SPEED][1] = 1.0 / je;
    if (bandwidth > 0.0) {
        system->a[BENCH_DYNO_SPEED][BENCH_TORQUE] = -1.0 / jd;
        system->a[BENCH_TORQUE][BENCH_TORQUE] = -bandwidth;
        system->b[BENCH_TORQUE][0] = bandwidth;
    } else {
        system->b[BENCH_DYNO_SPEED][0] = -1.0 / jd;
    }
}

/* Which sample of a demand is in force, counted back from the last one, if it acts a delay after its own sample. */
static int samples_back(double delay, double position) {
    double back = ceil(delay - position - INSTANT);
    return back > 0.0 ? (int)back : 0;
}

/* The instants within a sample at which a demand may change, with both ends; returns how many. */
static int instants(double delayed, double immediate, double instant[4]) {
    const double delay[2] = {delayed, immediate};
    int count = 2;
    instant[0] = 0.0;
    instant[1] = 1.0;
    for (int i = 0; i < 2; i++) {
        double new_one = delay[i] - floor(delay[i]);
        int place = 0, known = 0;
        for (int j = 0; j < count; j++) known |= fabs(instant[j] - new_one) <= INSTANT;
        if (known) continue;
        for (place = count++; instant[place - 1] > new_one; place--) instant[place] = instant[place - 1];
        instant[place] = new_one;
    }
    return count;
}

int bench_prepare(bench *b) {
    const double *p = b->state.parameter;
    bench_tables *t = &b->tables;
    double instant[4], immediate, delayed;
    if (bench_fault(p)) return 0;
    continuous(p, &t->system);
    immediate = p[BENCH_TORQUE_DELAY] / p[BENCH_SAMPLE_TIME];
    delayed = (p[BENCH_TORQUE_DELAY] + p[BENCH_CONTROLLER_DELAY]) / p[BENCH_SAMPLE_TIME];
    t->parts = instants(delayed, immediate, instant) - 1;
    t->shorter_count = t->shorter_next = 0;
    for (int i = 0; i < t->parts; i++) {
        bench_part *part = &t->part[i];
        part->from = instant[i];
        part->to = instant[i + 1];
        part->delayed_back = samples_back(delayed, part->from);
        part->immediate_back = samples_back(immediate, part->from);
        if (!linear_step_of(&t->system, (part->to - part->from) * p[BENCH_SAMPLE_TIME], &part->step)) return 0;
    }
    return 1;
}

/* ---- start --------------------------------------------------------------------------------------------------- */

int bench_start(bench *b, const double parameter[BENCH_PARAMETERS], int mode, const bench_initial *initial) {
    bench_state *s = &b->state;
    double torque_nm = initial->torque_nm, stiffness = parameter[BENCH_STIFFNESS];
    double feed_forward = parameter[BENCH_SPEED_FEED_FORWARD] * initial->speed_rad_s;
    memset(b, 0, sizeof *b);
    memcpy(s->parameter, parameter, sizeof s->parameter);
    s->mode = mode;
    if (!bench_prepare(b)) return 0;
    s->x[BENCH_DYNO_SPEED] = initial->speed_rad_s;
    s->x[BENCH_ENGINE_SPEED] = initial->speed_rad_s + initial->speed_difference_rad_s;
    s->x[BENCH_TWIST] = (stiffness > 0.0 ? torque_nm / stiffness : 0.0) + initial->twist_offset_rad;
    s->x[BENCH_TORQUE] = torque_nm + initial->air_gap_torque_offset_nm;
    s->integral_nm = torque_nm - feed_forward + initial->integrator_offset_nm;
    s->before_nm = mode == BENCH_SPEED_CONTROL ? s->integral_nm : 0.0;
    s->held_nm = s->x[BENCH_TORQUE];
    s->limited_nm = limit(s, torque_nm);
    s->newest = -1;
    bench_read_encoders(s);
    s->due = 1;
    return 1;
}

/* ---- encoders ------------------------------------------------------------------------------------------------ */

/* The angle at an earlier position in samples: the cubic through both neighbours with the speeds there. Before the first
 * sample the speed was constant. */
static double angle_at(const bench_state *s, int side, long long whole, double x) {
    const double *angle = s->angles[side], *speed = s->speeds[side];
    double sample_time_s = s->parameter[BENCH_SAMPLE_TIME], a, b, da, db, y = 1.0 - x;
    if (whole < 0) return angle[0] + ((double)whole + x) * sample_time_s * speed[0];
    if (x == 0.0) return angle[at(whole)];
    a = angle[at(whole)];
    b = angle[at(whole + 1)];
    da = speed[at(whole)] * sample_time_s;
    db = speed[at(whole + 1)] * sample_time_s;
    return a + (b - a) * x * x * (3.0 - 2.0 * x) + x * y * (da * y - db * x);
}

static double reading_of(const bench_state *s, int side) {
    double gate = s->parameter[BENCH_ENCODER_GATE] / s->parameter[BENCH_SAMPLE_TIME];
    double back = ceil(gate);
    if (gate <= 0.0) return s->x[BENCH_DYNO_SPEED + side];
    return (s->x[BENCH_DYNO_ANGLE + side] - angle_at(s, side, s->tick - (long long)back, back - gate)) /
           (gate * s->parameter[BENCH_SAMPLE_TIME]);
}

void bench_read_encoders(bench_state *s) {
    for (int side = 0; side < 2; side++) {
        s->angles[side][at(s->tick)] = s->x[BENCH_DYNO_ANGLE + side];
        s->speeds[side][at(s->tick)] = s->x[BENCH_DYNO_SPEED + side];
        s->reading[side] = reading_of(s, side);
    }
    s->readings[at(s->tick)] = s->reading[0];
}

/* Takes a large angle back, and those that the encoder remembers with it. */
static void turn_back(bench_state *s, int side) {
    double *angle = &s->x[BENCH_DYNO_ANGLE + side];
    double by = *angle > TURN_BACK ? TURN_BACK : *angle < -TURN_BACK ? -TURN_BACK : 0.0;
    if (by == 0.0) return;
    *angle -= by;
    for (int i = 0; i < BENCH_HISTORY; i++) s->angles[side][i] -= by;
}

/* ---- controller ---------------------------------------------------------------------------------------------- */

/* Samples by which the demand of the speed error is earlier than its reading: the error waits for the demand then. */
static long long waits(const bench_state *s) {
    const double *p = s->parameter;
    double samples = round((p[BENCH_DEMAND_DELAY] - p[BENCH_CONTROLLER_DELAY]) / p[BENCH_SAMPLE_TIME]);
    return samples < 0.0 ? (long long)-samples : 0;
}

static double demand_at(const bench_state *s, long long sample) { return s->demands[at(not_below_zero(sample))]; }

static double feed_forward_nm(const bench_state *s, long long sample) {
    const double *p = s->parameter;
    long long late = (long long)round(p[BENCH_FEED_FORWARD_DELAY] / p[BENCH_SAMPLE_TIME]);
    double demand = demand_at(s, sample - late), before = demand_at(s, sample - late - 1);
    double acceleration = (demand - before) / p[BENCH_SAMPLE_TIME];
    return p[BENCH_SPEED_FEED_FORWARD] * demand + p[BENCH_ACCELERATION_FEED_FORWARD] * acceleration;
}

/* The output of the PI controller at a sample. The integrator rests if the demand is beyond its limit and the error would
 * drive it further. */
static double pi_nm(bench_state *s, long long sample) {
    const double *p = s->parameter;
    double late = round((p[BENCH_DEMAND_DELAY] - p[BENCH_CONTROLLER_DELAY]) / p[BENCH_SAMPLE_TIME]);
    double error = s->readings[at(sample)] - demand_at(s, sample - (long long)late);
    double output = p[BENCH_PROPORTIONAL] * error + s->integral_nm;
    double change = p[BENCH_INTEGRAL] * p[BENCH_SAMPLE_TIME] * error;
    double demand = output + s->immediate[at(sample)];
    int is_limited = p[BENCH_TORQUE_LIMIT] > 0.0 && fabs(demand) > p[BENCH_TORQUE_LIMIT];
    if (!(is_limited && change * demand > 0.0)) s->integral_nm += change;
    return output;
}

/* T_d* of so many samples back. */
static double demand_nm(const bench_state *s, int delayed_back, int immediate_back) {
    long long delayed = s->tick - delayed_back;
    double output = s->before_nm;
    if (delayed > s->newest) delayed = s->newest;
    if (delayed >= 0) output = s->delayed[at(delayed)];
    return limit(s, output + s->immediate[at(not_below_zero(s->tick - immediate_back))]);
}

/* The PI controller up to a sample: once for each sample, also if a delay was changed. */
static void run_pi(bench_state *s, long long sample) {
    double output;
    if (sample <= s->newest) return;
    output = pi_nm(s, sample);
    for (long long i = s->newest < sample - BENCH_HISTORY ? sample : s->newest + 1; i <= sample; i++) {
        s->delayed[at(i)] = output;
    }
    s->newest = sample;
}

void bench_run_controller(bench_state *s, const bench_inputs *inputs) {
    double updates = s->parameter[BENCH_CONTROLLER_DELAY] / s->parameter[BENCH_SAMPLE_TIME];
    s->due = 0;
    s->demands[at(s->tick)] = inputs->speed_demand_rad_s;
    if (s->mode == BENCH_SPEED_CONTROL) {
        s->immediate[at(s->tick)] = feed_forward_nm(s, s->tick);
        run_pi(s, s->tick - waits(s));
        s->limited_nm = demand_nm(s, samples_back(updates, 0.0), 0);
    } else {
        s->immediate[at(s->tick)] = inputs->torque_demand_nm;
        s->limited_nm = limit(s, inputs->torque_demand_nm);
    }
}

/* ---- motion -------------------------------------------------------------------------------------------------- */

int bench_part_at(const bench *b, double phase) {
    int part = 0;
    while (part + 1 < b->tables.parts && phase >= b->tables.part[part].to - INSTANT) part++;
    return part;
}

void bench_hold(bench *b, int part) {
    const bench_part *p = &b->tables.part[part];
    b->state.held_nm = demand_nm(&b->state, p->delayed_back, p->immediate_back);
}

void bench_derivative(const bench *b, double engine_torque_nm, double derivative[STATES]) {
    const linear_system *system = &b->tables.system;
    for (int i = 0; i < STATES; i++) {
        double sum = system->b[i][0] * b->state.held_nm + system->b[i][1] * engine_torque_nm;
        for (int j = 0; j < STATES; j++) sum += system->a[i][j] * b->state.x[j];
        derivative[i] = sum;
    }
}

/* The step over a part of a sample. Steps are kept for others of the same length, which is therefore rounded: so the result does
 * not depend on which are kept. */
static const linear_step *step_over(bench *b, const bench_part *part, double from, double to) {
    bench_tables *t = &b->tables;
    double seconds = round((to - from) / ROUNDED) * ROUNDED * b->state.parameter[BENCH_SAMPLE_TIME];
    int slot;
    if (from == part->from && to == part->to) return &part->step;
    for (int i = 0; i < t->shorter_count; i++) {
        if (t->shorter[i].seconds == seconds) return &t->shorter[i];
    }
    slot = t->shorter_next;
    t->shorter_next = (slot + 1) % 16;
    if (t->shorter_count < 16) t->shorter_count++;
    return linear_step_of(&t->system, seconds, &t->shorter[slot]) ? &t->shorter[slot] : NULL;
}

static void see(double seen[2], double value) {
    if (value < seen[0]) seen[0] = value;
    if (value > seen[1]) seen[1] = value;
}

static void see_all(bench_state *s) {
    see(s->speeds_seen, s->reading[0]);
    see(s->torques_seen, bench_air_gap_torque_nm(s));
}

static void reach_sample(bench_state *s) {
    s->tick++;
    s->phase = 0.0;
    turn_back(s, 0);
    turn_back(s, 1);
    bench_read_encoders(s);
    see_all(s);
    s->due = 1;
}

/* Moves on to the end of the part, or of the step; `done` counts samples since the step began. Returns 0 on a fault. */
static int move(bench *b, const bench_inputs *inputs, double *done, double samples) {
    bench_state *s = &b->state;
    int number = bench_part_at(b, s->phase);
    const bench_part *part = &b->tables.part[number];
    double left = samples - *done, from = s->phase < part->from ? part->from : s->phase, to = part->to;
    double slope = inputs->engine_torque_rate_nm_s * s->parameter[BENCH_SAMPLE_TIME];
    const linear_step *step;
    double u0[INPUTS], u1[INPUTS];
    if (to - from > left + NEAR) to = from + left;
    bench_hold(b, number);
    step = step_over(b, part, from, to);
    if (!step) return 0;
    u0[0] = u1[0] = s->held_nm;
    u0[1] = inputs->engine_torque_nm + slope * *done;
    *done += to - from;
    u1[1] = inputs->engine_torque_nm + slope * *done;
    linear_step_apply(step, s->x, u0, u1);
    s->phase = to;
    if (to == 1.0) reach_sample(s);
    return 1;
}

int bench_step(bench *b, const bench_inputs *inputs, double seconds) {
    bench_state *s = &b->state;
    double samples = seconds / s->parameter[BENCH_SAMPLE_TIME] + s->remainder, done = 0.0;
    s->speeds_seen[0] = s->speeds_seen[1] = s->reading[0];
    s->torques_seen[0] = s->torques_seen[1] = bench_air_gap_torque_nm(s);
    while (samples - done > NEAR) {
        if (s->due) bench_run_controller(s, inputs);
        if (!move(b, inputs, &done, samples)) return 0;
        if (!isfinite(s->x[BENCH_DYNO_SPEED] + s->x[BENCH_TORQUE])) return 0;
    }
    see_all(s);
    s->remainder = samples - done;
    return 1;
}

/* ---- outputs ------------------------------------------------------------------------------------------------- */

double bench_shaft_torque_nm(const bench_state *s) {
    return s->parameter[BENCH_STIFFNESS] * s->x[BENCH_TWIST] +
           s->parameter[BENCH_DAMPING] * (s->x[BENCH_ENGINE_SPEED] - s->x[BENCH_DYNO_SPEED]);
}

double bench_air_gap_torque_nm(const bench_state *s) {
    return s->parameter[BENCH_TORQUE_BANDWIDTH] > 0.0 ? s->x[BENCH_TORQUE] : s->held_nm;
}
