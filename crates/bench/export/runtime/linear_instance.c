/* A linear model behind FMI. It is sampled: at each sample it takes the inputs, gives the outputs and moves its state. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "interface.h"
#include "linear_file.h"

/* Part of a sample by which an event or the end of a step may miss it. */
static const double NEAR = 1e-5;

/* Value references; the outputs and the initial states come after the inputs. */
enum { VR_TIME = 0, VR_DRAW = 1, VR_INPUT = 10 };

/* What changes beside the numbers. */
typedef struct {
    int draw;
    int due;          /* the sample has been reached, but not run */
    long long tick;   /* samples reached since the start */
    double phase;     /* samples since then */
} situation;

struct instance {
    instance_head head;
    situation now;
    linear_file file;
    linear_model model;   /* that of the draw */
    /* The initial state, the state of the next sample to run, the inputs, and the outputs of the last sample that ran. */
    double *initial, *x, *u, *y;
    double *next;         /* room for one more state */
    size_t count;         /* numbers in the first four */
};

struct kept_state {
    unsigned long long mark;
    unsigned long long check;   /* of the bytes after it */
    life life;
    situation now;
    double numbers[];
};

/* ---- life ---------------------------------------------------------------------------------------------------- */

static void begin(instance *i) {
    life *l = life_of(i);
    int kind = l->kind;
    memset(l, 0, sizeof *l);
    l->kind = kind;
    l->mode = MODE_INSTANTIATED;
    memset(&i->now, 0, sizeof i->now);
    i->now.due = 1;
    i->model = linear_file_draw(&i->file, 0);
    memset(i->initial, 0, i->count * sizeof(double));
}

static const char *load(instance *i, const char *token, const char *folder) {
    const char *fault = linear_file_read(&i->file, folder);
    const linear_model *m = &i->file.estimate;
    if (fault) return fault;
    if (!token || strcmp(token, i->file.token) != 0) {
        return "the token is not that of the resources: they belong to another model description";
    }
    i->count = (size_t)(2 * m->states + m->inputs + m->outputs);
    i->initial = (double *)calloc(i->count + (size_t)m->states + 1, sizeof(double));
    if (!i->initial) return "there is no memory for an instance";
    i->x = i->initial + m->states;
    i->u = i->x + m->states;
    i->y = i->u + m->inputs;
    i->next = i->y + m->outputs;
    return NULL;
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
        instance_free(i);
        return NULL;
    }
    life_of(i)->kind = (int)kind;
    begin(i);
    return i;
}

void instance_free(instance *i) {
    if (!i) return;
    linear_file_free(&i->file);
    free(i->initial);
    free(i);
}

call_status reset(instance *i) {
    if (!i) return STATUS_ERROR;
    begin(i);
    return STATUS_OK;
}

call_status leave_initialization(instance *i) {
    if (!allowed(i, MODE_INITIALIZATION, "exitInitializationMode")) return STATUS_ERROR;
    life_of(i)->mode = life_of(i)->kind == INTERFACE_EXCHANGE ? MODE_EVENT : MODE_STEP;
    return STATUS_OK;
}

/* ---- values -------------------------------------------------------------------------------------------------- */

/* Where the value of a reference begins: an input, an output or an initial state. */
static double *slot(const instance *i, unsigned int reference) {
    unsigned int m = (unsigned int)i->model.inputs, p = (unsigned int)i->model.outputs, n = (unsigned int)i->model.states;
    if (reference < VR_INPUT || reference - VR_INPUT >= m + p + n) return NULL;
    reference -= VR_INPUT;
    if (reference < m) return i->u + reference;
    return reference < m + p ? i->y + (reference - m) : i->initial + (reference - m - p);
}

static int is_output(const instance *i, const double *value) { return value >= i->y && value < i->next; }

static int is_initial(const instance *i, const double *value) { return value < i->x; }

call_status get_reals(instance *i, const unsigned int *reference, size_t count, double *value) {
    if (!allowed(i, GET_MODES, "get")) return STATUS_ERROR;
    if (count > 0 && (!reference || !value)) return fail(i, "there is no room for the values");
    /* A sample that has not run takes the present inputs. */
    if (i->now.due) linear_output(&i->model, i->x, i->u, i->y);
    for (size_t k = 0; k < count; k++) {
        const double *found = slot(i, reference[k]);
        if (!found && reference[k] != VR_TIME) return fail(i, "no real variable has this value reference");
        value[k] = found ? *found : life_of(i)->time;
    }
    return STATUS_OK;
}

static call_status set_real(instance *i, unsigned int reference, double value) {
    double *found = slot(i, reference);
    if (!isfinite(value)) return fail(i, "a value that is set is not a finite number");
    if (!found || is_output(i, found)) return fail(i, "no real input or parameter has this value reference");
    if (!allowed(i, is_initial(i, found) ? BEFORE_START : INPUT_MODES, "set")) return STATUS_ERROR;
    *found = value;
    if (is_initial(i, found)) i->x[found - i->initial] = value;
    return STATUS_OK;
}

call_status set_reals(instance *i, const unsigned int *reference, size_t count, const double *value) {
    if (!i) return STATUS_ERROR;
    if (count > 0 && (!reference || !value)) return fail(i, "there are no values to set");
    for (size_t k = 0; k < count; k++) {
        if (set_real(i, reference[k], value[k]) != STATUS_OK) return STATUS_ERROR;
    }
    return STATUS_OK;
}

call_status get_whole(instance *i, whole_kind kind, unsigned int reference, long long *value) {
    if (!allowed(i, GET_MODES, "get")) return STATUS_ERROR;
    if (reference != VR_DRAW || !(kind & WHOLE_INTEGER)) return fail(i, "no variable of this type has this value reference");
    *value = i->now.draw;
    return STATUS_OK;
}

call_status set_whole(instance *i, whole_kind kind, unsigned int reference, long long value) {
    if (!i) return STATUS_ERROR;
    if (reference != VR_DRAW || !(kind & WHOLE_INTEGER)) return fail(i, "no parameter of this type has this value reference");
    if (!allowed(i, TUNABLE_MODES, "set of draw")) return STATUS_ERROR;
    if (value < 0 || value > i->file.draws) return fail(i, "draw is below 0 or beyond the number of stored draws");
    i->now.draw = (int)value;
    i->model = linear_file_draw(&i->file, i->now.draw);
    return STATUS_OK;
}

call_status get_valid(instance *i, unsigned int reference, int *value) {
    (void)reference, (void)value;
    return fail(i, "no Boolean variable has this value reference");
}

call_status set_slope(instance *i, unsigned int reference, double slope) {
    const double *found = slot(i, reference);
    (void)slope; /* the model samples its inputs, so that their slopes have no effect */
    if (!found || is_output(i, found) || is_initial(i, found)) return fail(i, "no real input has this value reference");
    return allowed(i, MODE_STEP | BEFORE_START, "the derivative of an input") ? STATUS_OK : STATUS_ERROR;
}

/* ---- states -------------------------------------------------------------------------------------------------- */

/* Tells the layout: its version and its numbers. */
static unsigned long long mark_of(const instance *i) { return 0x64796e6f69640101ull ^ (unsigned long long)i->count << 20; }

size_t size_of_state(const instance *i) { return i ? sizeof(kept_state) + i->count * sizeof(double) : 0; }

static unsigned long long check_of(const instance *i, const kept_state *kept) {
    return checksum(&kept->life, size_of_state(i) - offsetof(kept_state, life));
}

call_status keep_state(instance *i, kept_state **kept) {
    if (!i) return STATUS_ERROR;
    if (!kept) return fail(i, "there is no room for the state");
    if (!*kept) *kept = (kept_state *)calloc(1, size_of_state(i));
    if (!*kept) return fail(i, "there is no memory for the state");
    (*kept)->mark = mark_of(i);
    (*kept)->life = i->head.life;
    (*kept)->now = i->now;
    memcpy((*kept)->numbers, i->initial, i->count * sizeof(double));
    return STATUS_OK;
}

call_status restore_state(instance *i, const kept_state *kept) {
    if (!i) return STATUS_ERROR;
    if (!kept || kept->mark != mark_of(i)) return fail(i, "this is no state of such an instance");
    if (kept->life.kind != life_of(i)->kind) return fail(i, "the state is of another interface type");
    if (kept->now.draw < 0 || kept->now.draw > i->file.draws) return fail(i, "the state has a draw that this model does not have");
    i->head.life = kept->life;
    i->now = kept->now;
    i->model = linear_file_draw(&i->file, i->now.draw);
    memcpy(i->initial, kept->numbers, i->count * sizeof(double));
    return STATUS_OK;
}

call_status serialize_state(instance *i, const kept_state *kept, void *bytes, size_t size) {
    if (!i) return STATUS_ERROR;
    if (!kept || kept->mark != mark_of(i) || !bytes) return fail(i, "this is no state of such an instance");
    if (size < size_of_state(i)) return fail(i, "the room for the bytes of the state is too small");
    unsigned long long check = check_of(i, kept);
    memcpy(bytes, kept, size_of_state(i));
    memcpy((char *)bytes + offsetof(kept_state, check), &check, sizeof check);
    return STATUS_OK;
}

call_status deserialize_state(instance *i, const void *bytes, size_t size, kept_state **kept) {
    kept_state *copy;
    if (!i) return STATUS_ERROR;
    if (!bytes || !kept || size < size_of_state(i)) return fail(i, "these are not the bytes of a state");
    copy = (kept_state *)malloc(size_of_state(i));
    if (!copy) return fail(i, "there is no memory for the state");
    memcpy(copy, bytes, size_of_state(i));
    if (copy->mark != mark_of(i) || copy->check != check_of(i, copy)) {
        free(copy);
        return fail(i, "these are not the bytes of a state, or they are damaged");
    }
    *kept = copy;
    return STATUS_OK;
}

/* ---- samples ------------------------------------------------------------------------------------------------- */

/* Runs the sample that is due. Returns 0 if the outputs or the state leave the finite numbers. */
static int run_sample(instance *i) {
    const linear_model *m = &i->model;
    double sum = 0.0;
    linear_output(m, i->x, i->u, i->y);
    linear_advance(m, i->x, i->u, i->next);
    memcpy(i->x, i->next, (size_t)m->states * sizeof(double));
    for (int k = 0; k < m->states; k++) sum += i->x[k];
    for (int k = 0; k < m->outputs; k++) sum += i->y[k];
    i->now.due = 0;
    return isfinite(sum);
}

static int move(instance *i, double samples) {
    situation *s = &i->now;
    double left = s->phase + samples;
    while (left > NEAR) {
        if (s->due && !run_sample(i)) return 0;
        if (left < 1.0 - NEAR) break;
        left -= 1.0;
        s->tick++;
        s->due = 1;
    }
    s->phase = left;
    return 1;
}

call_status do_step(instance *i, double from, double length) {
    double sample_time_s;
    const char *fault;
    if (!allowed(i, MODE_STEP, "doStep")) return STATUS_ERROR;
    sample_time_s = i->model.sample_time_s;
    fault = fault_of_step(life_of(i), from, length, sample_time_s);
    if (fault) return fail(i, fault);
    if (!move(i, length / sample_time_s)) {
        life_of(i)->mode = MODE_BROKEN;
        return fail(i, "the model grows without bound: it is not stable, or the draw is not");
    }
    life_of(i)->time = from + length;
    return STATUS_OK;
}

call_status update_discrete(instance *i, double *next_event) {
    double sample_time_s, samples;
    if (!is_exchange(i, MODE_EVENT, "the update of discrete states")) return STATUS_ERROR;
    sample_time_s = i->model.sample_time_s;
    samples = (life_of(i)->time - life_of(i)->start) / sample_time_s - (double)i->now.tick;
    if (samples >= 2.0 - NEAR) return fail(i, "a sample of the model was passed over; stop at the event times");
    if (samples < -NEAR) return fail(i, "the time is before the last sample of the model");
    if (samples >= 1.0 - NEAR) {
        i->now.tick++;
        i->now.due = 1;
    }
    if (i->now.due && !run_sample(i)) {
        life_of(i)->mode = MODE_BROKEN;
        return fail(i, "the model grows without bound: it is not stable, or the draw is not");
    }
    *next_event = life_of(i)->start + ((double)i->now.tick + 1.0) * sample_time_s;
    return STATUS_OK;
}

/* ---- Model Exchange without continuous states ---------------------------------------------------------------- */

size_t states_of(const instance *i) {
    (void)i;
    return 0;
}

static call_status none(instance *i, int modes, size_t count, const char *call) {
    if (!is_exchange(i, modes, call)) return STATUS_ERROR;
    return count == 0 ? STATUS_OK : fail(i, "the model has no continuous states");
}

call_status set_states(instance *i, const double *x, size_t count) {
    (void)x;
    return none(i, MODE_CONTINUOUS, count, "setContinuousStates");
}

call_status get_states(instance *i, double *x, size_t count) {
    (void)x;
    return none(i, EVALUATION_MODES, count, "getContinuousStates");
}

call_status get_derivatives(instance *i, double *derivative, size_t count) {
    (void)derivative;
    return none(i, EVALUATION_MODES, count, "getDerivatives");
}

call_status get_nominals(instance *i, double *nominal, size_t count) {
    (void)nominal;
    return none(i, MODE_INSTANTIATED | EVALUATION_MODES, count, "getNominalsOfContinuousStates");
}

call_status derivatives_along(instance *i, int adjoint, const unsigned int *unknown, size_t unknowns,
                              const unsigned int *known, size_t knowns, const double *seed, double *result) {
    (void)adjoint, (void)unknown, (void)unknowns, (void)known, (void)knowns, (void)seed, (void)result;
    return fail(i, "the model is sampled and has no directional derivatives");
}
