/* FMI 3.0, Co-Simulation and Model Exchange, on an instance. What the model does not have is in fmi3_absent.c. */
#include "fmi3.h"

#include <stdlib.h>

#include "fmi3_component.h"

static fmi3Status status(call_status s) { return (fmi3Status)s; }

instance *fmi3_instance(fmi3Instance c) { return c ? ((fmi3_component *)c)->bench : NULL; }

/* ---- life ---------------------------------------------------------------------------------------------------- */

static void pass_on(void *to, call_status s, const char *category, const char *message) {
    const fmi3_component *c = (const fmi3_component *)to;
    if (c->log) c->log(c->environment, status(s), category, message);
}

static fmi3Instance instantiate(interface_kind kind, fmi3String token, fmi3String resources,
                                fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    fmi3_component *c = (fmi3_component *)calloc(1, sizeof *c);
    if (!c) return NULL;
    c->environment = environment;
    c->log = log;
    c->bench = instance_new(kind, token, resources, pass_on, c);
    if (c->bench) return c;
    free(c);
    return NULL;
}

const char *FMI3(fmi3GetVersion)(void) { return "3.0"; }

fmi3Status FMI3(fmi3SetDebugLogging)(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[]) {
    (void)on, (void)count, (void)categories; /* only errors and the warning of validity are told, and these always */
    return c ? fmi3OK : fmi3Error;
}

fmi3Instance FMI3(fmi3InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                                fmi3Boolean visible, fmi3Boolean logging,
                                                fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    (void)name, (void)visible, (void)logging;
    return instantiate(INTERFACE_EXCHANGE, token, resources, environment, log);
}

fmi3Instance FMI3(fmi3InstantiateCoSimulation)(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode,
                                               fmi3Boolean early_return, const fmi3ValueReference intermediate[],
                                               size_t intermediates, fmi3InstanceEnvironment environment,
                                               fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
    (void)name, (void)visible, (void)logging, (void)event_mode, (void)early_return;
    (void)intermediate, (void)intermediates, (void)update; /* an FMU without event mode takes no notice of these */
    return instantiate(INTERFACE_COSIMULATION, token, resources, environment, log);
}

fmi3Instance FMI3(fmi3InstantiateScheduledExecution)(fmi3String name, fmi3String token, fmi3String resources,
                                                     fmi3Boolean visible, fmi3Boolean logging,
                                                     fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                                     fmi3ClockUpdateCallback clock, fmi3LockPreemptionCallback lock,
                                                     fmi3UnlockPreemptionCallback unlock) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)clock, (void)lock, (void)unlock;
    if (log) log(environment, fmi3Error, "logStatusError", "the model has no Scheduled Execution");
    return NULL;
}

void FMI3(fmi3FreeInstance)(fmi3Instance c) {
    instance_free(fmi3_instance(c));
    free(c);
}

fmi3Status FMI3(fmi3EnterInitializationMode)(fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                             fmi3Float64 start, fmi3Boolean stop_defined, fmi3Float64 stop) {
    (void)tolerance_defined, (void)tolerance; /* the solution is exact */
    if (!allowed(fmi3_instance(c), MODE_INSTANTIATED, "fmi3EnterInitializationMode")) return fmi3Error;
    if (set_times(fmi3_instance(c), start, stop_defined, stop) != STATUS_OK) return fmi3Error;
    return status(enter_mode(fmi3_instance(c), MODE_INSTANTIATED, MODE_INITIALIZATION, ""));
}

fmi3Status FMI3(fmi3ExitInitializationMode)(fmi3Instance c) { return status(leave_initialization(fmi3_instance(c))); }

fmi3Status FMI3(fmi3Terminate)(fmi3Instance c) {
    int from = MODE_EVENT | MODE_CONTINUOUS | MODE_STEP | MODE_BROKEN;
    return status(enter_mode(fmi3_instance(c), from, MODE_TERMINATED, "fmi3Terminate"));
}

fmi3Status FMI3(fmi3Reset)(fmi3Instance c) { return status(reset(fmi3_instance(c))); }

fmi3Status FMI3(fmi3EnterConfigurationMode)(fmi3Instance c) {
    return status(enter_mode(fmi3_instance(c), MODE_INSTANTIATED, MODE_CONFIGURATION, "fmi3EnterConfigurationMode"));
}

fmi3Status FMI3(fmi3ExitConfigurationMode)(fmi3Instance c) {
    return status(enter_mode(fmi3_instance(c), MODE_CONFIGURATION, MODE_INSTANTIATED, "fmi3ExitConfigurationMode"));
}

/* ---- values -------------------------------------------------------------------------------------------------- */

/* Whether there is an instance, and as many values as references. */
static int matches(fmi3Instance c, const void *vr, size_t n, const void *values, size_t count) {
    if (!c) return 0;
    if (n == count && (n == 0 || (vr && values))) return 1;
    fail(fmi3_instance(c), "there are not as many values as value references");
    return 0;
}

fmi3Status FMI3(fmi3GetFloat64)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 values[], size_t count) {
    return matches(c, vr, n, values, count) ? status(get_reals(fmi3_instance(c), vr, n, values)) : fmi3Error;
}

fmi3Status FMI3(fmi3SetFloat64)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 values[],
                                size_t count) {
    return matches(c, vr, n, values, count) ? status(set_reals(fmi3_instance(c), vr, n, values)) : fmi3Error;
}

fmi3Status FMI3(fmi3GetInt32)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Int32 values[], size_t count) {
    if (!matches(c, vr, n, values, count)) return fmi3Error;
    for (size_t k = 0; k < n; k++) {
        long long whole;
        if (get_whole(fmi3_instance(c), WHOLE_INTEGER, vr[k], &whole) != STATUS_OK) return fmi3Error;
        values[k] = (fmi3Int32)whole;
    }
    return fmi3OK;
}

fmi3Status FMI3(fmi3SetInt32)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Int32 values[],
                              size_t count) {
    if (!matches(c, vr, n, values, count)) return fmi3Error;
    for (size_t k = 0; k < n; k++) {
        if (set_whole(fmi3_instance(c), WHOLE_INTEGER, vr[k], values[k]) != STATUS_OK) return fmi3Error;
    }
    return fmi3OK;
}

fmi3Status FMI3(fmi3GetInt64)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Int64 values[], size_t count) {
    if (!matches(c, vr, n, values, count)) return fmi3Error;
    for (size_t k = 0; k < n; k++) {
        long long whole;
        if (get_whole(fmi3_instance(c), WHOLE_ENUMERATION, vr[k], &whole) != STATUS_OK) return fmi3Error;
        values[k] = whole;
    }
    return fmi3OK;
}

fmi3Status FMI3(fmi3SetInt64)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Int64 values[],
                              size_t count) {
    if (!matches(c, vr, n, values, count)) return fmi3Error;
    for (size_t k = 0; k < n; k++) {
        if (set_whole(fmi3_instance(c), WHOLE_ENUMERATION, vr[k], values[k]) != STATUS_OK) return fmi3Error;
    }
    return fmi3OK;
}

fmi3Status FMI3(fmi3GetBoolean)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Boolean values[],
                                size_t count) {
    if (!matches(c, vr, n, values, count)) return fmi3Error;
    for (size_t k = 0; k < n; k++) {
        int valid;
        if (get_valid(fmi3_instance(c), vr[k], &valid) != STATUS_OK) return fmi3Error;
        values[k] = valid != 0;
    }
    return fmi3OK;
}

/* ---- states -------------------------------------------------------------------------------------------------- */

fmi3Status FMI3(fmi3GetFMUState)(fmi3Instance c, fmi3FMUState *state) {
    return status(keep_state(fmi3_instance(c), (kept_state **)state));
}

fmi3Status FMI3(fmi3SetFMUState)(fmi3Instance c, fmi3FMUState state) {
    return status(restore_state(fmi3_instance(c), (const kept_state *)state));
}

fmi3Status FMI3(fmi3FreeFMUState)(fmi3Instance c, fmi3FMUState *state) {
    if (!c) return fmi3Error;
    if (!state) return fmi3OK;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

fmi3Status FMI3(fmi3SerializedFMUStateSize)(fmi3Instance c, fmi3FMUState state, size_t *size) {
    if (!c) return fmi3Error;
    if (!state || !size) return status(fail(fmi3_instance(c), "there is no state, or no room for its size"));
    *size = size_of_state(fmi3_instance(c));
    return fmi3OK;
}

fmi3Status FMI3(fmi3SerializeFMUState)(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    return status(serialize_state(fmi3_instance(c), (const kept_state *)state, bytes, size));
}

fmi3Status FMI3(fmi3DeserializeFMUState)(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    return status(deserialize_state(fmi3_instance(c), bytes, size, (kept_state **)state));
}

/* ---- derivatives --------------------------------------------------------------------------------------------- */

fmi3Status FMI3(fmi3GetDirectionalDerivative)(fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns,
                                              const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[],
                                              size_t seeds, fmi3Float64 result[], size_t results) {
    if (!matches(c, known, knowns, seed, seeds) || !matches(c, unknown, unknowns, result, results)) return fmi3Error;
    return status(derivatives_along(fmi3_instance(c), 0, unknown, unknowns, known, knowns, seed, result));
}

fmi3Status FMI3(fmi3GetAdjointDerivative)(fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns,
                                          const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[],
                                          size_t seeds, fmi3Float64 result[], size_t results) {
    if (!matches(c, unknown, unknowns, seed, seeds) || !matches(c, known, knowns, result, results)) return fmi3Error;
    return status(derivatives_along(fmi3_instance(c), 1, unknown, unknowns, known, knowns, seed, result));
}

/* ---- Model Exchange ------------------------------------------------------------------------------------------ */

static int is_kind(fmi3Instance c, interface_kind kind) {
    if (!c) return 0;
    if (life_of(fmi3_instance(c))->kind == (int)kind) return 1;
    fail(fmi3_instance(c), "this call belongs to the other interface type than the instance was made for");
    return 0;
}

fmi3Status FMI3(fmi3EnterEventMode)(fmi3Instance c) {
    if (!is_kind(c, INTERFACE_EXCHANGE)) return fmi3Error;
    return status(enter_mode(fmi3_instance(c), MODE_CONTINUOUS | MODE_EVENT, MODE_EVENT, "fmi3EnterEventMode"));
}

fmi3Status FMI3(fmi3EvaluateDiscreteStates)(fmi3Instance c) {
    return allowed(fmi3_instance(c), MODE_INITIALIZATION | MODE_EVENT, "fmi3EvaluateDiscreteStates") ? fmi3OK : fmi3Error;
}

fmi3Status FMI3(fmi3UpdateDiscreteStates)(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate,
                                          fmi3Boolean *nominals_changed, fmi3Boolean *states_changed,
                                          fmi3Boolean *next_defined, fmi3Float64 *next) {
    call_status outcome;
    double time;
    if (!c) return fmi3Error;
    outcome = update_discrete(fmi3_instance(c), &time);
    if (outcome != STATUS_OK) return status(outcome);
    if (again) *again = false;
    if (terminate) *terminate = false;
    if (nominals_changed) *nominals_changed = false;
    if (states_changed) *states_changed = false;
    if (next_defined) *next_defined = true;
    if (next) *next = time;
    return fmi3OK;
}

fmi3Status FMI3(fmi3EnterContinuousTimeMode)(fmi3Instance c) {
    if (!is_kind(c, INTERFACE_EXCHANGE)) return fmi3Error;
    return status(enter_mode(fmi3_instance(c), MODE_EVENT, MODE_CONTINUOUS, "fmi3EnterContinuousTimeMode"));
}

fmi3Status FMI3(fmi3CompletedIntegratorStep)(fmi3Instance c, fmi3Boolean no_earlier, fmi3Boolean *enter_event_mode,
                                             fmi3Boolean *terminate) {
    (void)no_earlier;
    if (!is_kind(c, INTERFACE_EXCHANGE)) return fmi3Error;
    if (!allowed(fmi3_instance(c), MODE_CONTINUOUS, "fmi3CompletedIntegratorStep")) return fmi3Error;
    if (enter_event_mode) *enter_event_mode = false;
    if (terminate) *terminate = false;
    return fmi3OK;
}

fmi3Status FMI3(fmi3SetTime)(fmi3Instance c, fmi3Float64 time) { return status(set_time(fmi3_instance(c), time)); }

fmi3Status FMI3(fmi3SetContinuousStates)(fmi3Instance c, const fmi3Float64 x[], size_t n) {
    return status(set_states(fmi3_instance(c), x, n));
}

fmi3Status FMI3(fmi3GetContinuousStateDerivatives)(fmi3Instance c, fmi3Float64 derivatives[], size_t n) {
    return status(get_derivatives(fmi3_instance(c), derivatives, n));
}

fmi3Status FMI3(fmi3GetContinuousStates)(fmi3Instance c, fmi3Float64 x[], size_t n) {
    return status(get_states(fmi3_instance(c), x, n));
}

fmi3Status FMI3(fmi3GetNominalsOfContinuousStates)(fmi3Instance c, fmi3Float64 nominals[], size_t n) {
    return status(get_nominals(fmi3_instance(c), nominals, n));
}

fmi3Status FMI3(fmi3GetNumberOfEventIndicators)(fmi3Instance c, size_t *count) {
    if (!c || !count) return fmi3Error;
    *count = 0;
    return fmi3OK;
}

fmi3Status FMI3(fmi3GetNumberOfContinuousStates)(fmi3Instance c, size_t *count) {
    if (!c || !count) return fmi3Error;
    *count = states_of(fmi3_instance(c));
    return fmi3OK;
}

/* ---- Co-Simulation ------------------------------------------------------------------------------------------- */

fmi3Status FMI3(fmi3EnterStepMode)(fmi3Instance c) {
    if (!is_kind(c, INTERFACE_COSIMULATION)) return fmi3Error;
    return status(enter_mode(fmi3_instance(c), MODE_EVENT, MODE_STEP, "fmi3EnterStepMode"));
}

fmi3Status FMI3(fmi3DoStep)(fmi3Instance c, fmi3Float64 from, fmi3Float64 length, fmi3Boolean no_earlier,
                            fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached) {
    call_status outcome = do_step(fmi3_instance(c), from, length);
    (void)no_earlier;
    if (!c) return fmi3Error;
    if (event) *event = false;
    if (terminate) *terminate = false;
    if (early) *early = false;
    if (reached) *reached = life_of(fmi3_instance(c))->time;
    return status(outcome);
}
