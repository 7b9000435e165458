/* FMI 2.0, Co-Simulation and Model Exchange, on an instance. */
#include "fmi2.h"

#include <stdlib.h>
#include <string.h>

#include "interface.h"

/* The instance and whom it tells. */
typedef struct {
    instance *bench;
    fmi2CallbackFunctions callbacks;
    char *name;
} component;

static instance *of(fmi2Component c) { return c ? ((component *)c)->bench : NULL; }

static fmi2Status status(call_status s) { return (fmi2Status)s; }

static void pass_on(void *to, call_status s, const char *category, const char *message) {
    const component *c = (const component *)to;
    if (c->callbacks.logger) c->callbacks.logger(c->callbacks.componentEnvironment, c->name, status(s), category, message);
}

/* ---- life ---------------------------------------------------------------------------------------------------- */

const char *FMI2(fmi2GetTypesPlatform)(void) { return "default"; }
const char *FMI2(fmi2GetVersion)(void) { return "2.0"; }

fmi2Status FMI2(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[]) {
    (void)on, (void)count, (void)categories; /* only errors and the warning of validity are told, and these always */
    return c ? fmi2OK : fmi2Error;
}

static int hex(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* The folder of a URI: file:/path, file:///path, file://localhost/path, with %XX; on Windows file:///C:/path. */
static char *folder_of(const char *uri) {
    const char *from = uri;
    char *folder, *to;
    if (strncmp(from, "file:", 5) == 0) {
        from += 5;
        if (strncmp(from, "//localhost/", 12) == 0) from += 11;
        else if (strncmp(from, "///", 3) == 0) from += 2;
#ifdef _WIN32
        if (from[0] == '/' && from[1] && from[2] == ':') from++;
#endif
    }
    folder = to = (char *)malloc(strlen(from) + 1);
    if (!folder) return NULL;
    while (*from) {
        int is_code = from[0] == '%' && hex(from[1]) >= 0 && hex(from[2]) >= 0;
        *to++ = is_code ? (char)(hex(from[1]) * 16 + hex(from[2])) : *from;
        from += is_code ? 3 : 1;
    }
    *to = '\0';
    return folder;
}

fmi2Component FMI2(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String location,
                                    const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    component *c = (component *)calloc(1, sizeof *c);
    char *folder = folder_of(location ? location : "");
    size_t length = name ? strlen(name) : 0;
    (void)visible, (void)logging;
    if (c) c->name = (char *)calloc(length + 1, 1);
    if (c && c->name && folder) {
        if (length > 0) memcpy(c->name, name, length);
        if (functions) c->callbacks = *functions;
        c->bench = instance_new(type == fmi2CoSimulation ? INTERFACE_COSIMULATION : INTERFACE_EXCHANGE, guid, folder,
                                pass_on, c);
    }
    free(folder);
    if (c && !c->bench) {
        FMI2(fmi2FreeInstance)(c);
        return NULL;
    }
    return c;
}

void FMI2(fmi2FreeInstance)(fmi2Component c) {
    if (!c) return;
    instance_free(of(c));
    free(((component *)c)->name);
    free(c);
}

fmi2Status FMI2(fmi2SetupExperiment)(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start,
                                     fmi2Boolean stop_defined, fmi2Real stop) {
    (void)tolerance_defined, (void)tolerance; /* the solution is exact */
    if (!allowed(of(c), MODE_INSTANTIATED, "fmi2SetupExperiment")) return fmi2Error;
    return status(set_times(of(c), start, stop_defined != 0, stop));
}

fmi2Status FMI2(fmi2EnterInitializationMode)(fmi2Component c) {
    return status(enter_mode(of(c), MODE_INSTANTIATED, MODE_INITIALIZATION, "fmi2EnterInitializationMode"));
}

fmi2Status FMI2(fmi2ExitInitializationMode)(fmi2Component c) { return status(leave_initialization(of(c))); }

fmi2Status FMI2(fmi2Terminate)(fmi2Component c) {
    int from = MODE_EVENT | MODE_CONTINUOUS | MODE_STEP | MODE_BROKEN;
    return status(enter_mode(of(c), from, MODE_TERMINATED, "fmi2Terminate"));
}

fmi2Status FMI2(fmi2Reset)(fmi2Component c) { return status(reset(of(c))); }

/* ---- values -------------------------------------------------------------------------------------------------- */

fmi2Status FMI2(fmi2GetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    return status(get_reals(of(c), vr, n, value));
}

fmi2Status FMI2(fmi2SetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    return status(set_reals(of(c), vr, n, value));
}

/* Whether there is an instance, and room for so many values. */
static int has_room(fmi2Component c, size_t n, const void *vr, const void *value) {
    if (!c) return 0;
    if (n == 0 || (vr && value)) return 1;
    fail(of(c), "there is no room for the values");
    return 0;
}

fmi2Status FMI2(fmi2GetInteger)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer value[]) {
    if (!has_room(c, n, vr, value)) return fmi2Error;
    for (size_t k = 0; k < n; k++) {
        long long whole;
        if (get_whole(of(c), (whole_kind)(WHOLE_INTEGER | WHOLE_ENUMERATION), vr[k], &whole) != STATUS_OK) return fmi2Error;
        value[k] = (fmi2Integer)whole;
    }
    return fmi2OK;
}

fmi2Status FMI2(fmi2SetInteger)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer value[]) {
    if (!has_room(c, n, vr, value)) return fmi2Error;
    for (size_t k = 0; k < n; k++) {
        whole_kind kind = (whole_kind)(WHOLE_INTEGER | WHOLE_ENUMERATION);
        if (set_whole(of(c), kind, vr[k], value[k]) != STATUS_OK) return fmi2Error;
    }
    return fmi2OK;
}

fmi2Status FMI2(fmi2GetBoolean)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean value[]) {
    if (!has_room(c, n, vr, value)) return fmi2Error;
    for (size_t k = 0; k < n; k++) {
        if (get_valid(of(c), vr[k], &value[k]) != STATUS_OK) return fmi2Error;
    }
    return fmi2OK;
}

static fmi2Status no_variable(fmi2Component c, size_t n, const char *message) {
    if (!c) return fmi2Error;
    return n == 0 ? fmi2OK : status(fail(of(c), message));
}

fmi2Status FMI2(fmi2SetBoolean)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Boolean value[]) {
    (void)vr, (void)value;
    return no_variable(c, n, "no Boolean variable can be set");
}

fmi2Status FMI2(fmi2GetString)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[]) {
    (void)vr, (void)value;
    return no_variable(c, n, "there are no strings");
}

fmi2Status FMI2(fmi2SetString)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[]) {
    (void)vr, (void)value;
    return no_variable(c, n, "there are no strings");
}

/* ---- states -------------------------------------------------------------------------------------------------- */

fmi2Status FMI2(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    return status(keep_state(of(c), (kept_state **)state));
}

fmi2Status FMI2(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state) {
    return status(restore_state(of(c), (const kept_state *)state));
}

fmi2Status FMI2(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    if (!c) return fmi2Error;
    if (!state) return fmi2OK;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

fmi2Status FMI2(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size) {
    if (!c) return fmi2Error;
    if (!state || !size) return status(fail(of(c), "there is no state, or no room for its size"));
    *size = size_of_state(of(c));
    return fmi2OK;
}

fmi2Status FMI2(fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    return status(serialize_state(of(c), (const kept_state *)state, bytes, size));
}

fmi2Status FMI2(fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    return status(deserialize_state(of(c), bytes, size, (kept_state **)state));
}

fmi2Status FMI2(fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                              const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[],
                                              fmi2Real result[]) {
    return status(derivatives_along(of(c), 0, unknown, unknowns, known, knowns, seed, result));
}

/* ---- Model Exchange ------------------------------------------------------------------------------------------ */

static int is_kind(fmi2Component c, interface_kind kind) {
    if (!c) return 0;
    if (life_of(of(c))->kind == (int)kind) return 1;
    fail(of(c), "this call belongs to the other interface type than the instance was made for");
    return 0;
}

fmi2Status FMI2(fmi2EnterEventMode)(fmi2Component c) {
    if (!is_kind(c, INTERFACE_EXCHANGE)) return fmi2Error;
    return status(enter_mode(of(c), MODE_CONTINUOUS | MODE_EVENT, MODE_EVENT, "fmi2EnterEventMode"));
}

fmi2Status FMI2(fmi2NewDiscreteStates)(fmi2Component c, fmi2EventInfo *info) {
    double next;
    call_status outcome;
    if (!c) return fmi2Error;
    if (!info) return status(fail(of(c), "there is no room for the event"));
    outcome = update_discrete(of(c), &next);
    if (outcome != STATUS_OK) return status(outcome);
    memset(info, 0, sizeof *info);
    info->nextEventTimeDefined = 1;
    info->nextEventTime = next;
    return fmi2OK;
}

fmi2Status FMI2(fmi2EnterContinuousTimeMode)(fmi2Component c) {
    if (!is_kind(c, INTERFACE_EXCHANGE)) return fmi2Error;
    return status(enter_mode(of(c), MODE_EVENT, MODE_CONTINUOUS, "fmi2EnterContinuousTimeMode"));
}

fmi2Status FMI2(fmi2CompletedIntegratorStep)(fmi2Component c, fmi2Boolean no_earlier, fmi2Boolean *enter_event_mode,
                                             fmi2Boolean *terminate) {
    (void)no_earlier;
    if (!is_kind(c, INTERFACE_EXCHANGE)) return fmi2Error;
    if (!allowed(of(c), MODE_CONTINUOUS, "fmi2CompletedIntegratorStep")) return fmi2Error;
    if (enter_event_mode) *enter_event_mode = 0;
    if (terminate) *terminate = 0;
    return fmi2OK;
}

fmi2Status FMI2(fmi2SetTime)(fmi2Component c, fmi2Real time) { return status(set_time(of(c), time)); }

fmi2Status FMI2(fmi2SetContinuousStates)(fmi2Component c, const fmi2Real x[], size_t n) {
    return status(set_states(of(c), x, n));
}

fmi2Status FMI2(fmi2GetDerivatives)(fmi2Component c, fmi2Real derivatives[], size_t n) {
    return status(get_derivatives(of(c), derivatives, n));
}

fmi2Status FMI2(fmi2GetEventIndicators)(fmi2Component c, fmi2Real indicators[], size_t n) {
    (void)indicators;
    return no_variable(c, n, "there are no event indicators");
}

fmi2Status FMI2(fmi2GetContinuousStates)(fmi2Component c, fmi2Real x[], size_t n) { return status(get_states(of(c), x, n)); }

fmi2Status FMI2(fmi2GetNominalsOfContinuousStates)(fmi2Component c, fmi2Real nominals[], size_t n) {
    return status(get_nominals(of(c), nominals, n));
}

/* ---- Co-Simulation ------------------------------------------------------------------------------------------- */

fmi2Status FMI2(fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                             const fmi2Integer order[], const fmi2Real value[]) {
    if (!is_kind(c, INTERFACE_COSIMULATION) || !has_room(c, n, vr, value)) return fmi2Error;
    if (n > 0 && !order) return status(fail(of(c), "the order of the derivatives is missing"));
    for (size_t k = 0; k < n; k++) {
        if (order[k] != 1) return status(fail(of(c), "only first derivatives of inputs are known"));
        if (!(value[k] - value[k] == 0.0)) return status(fail(of(c), "a derivative is not a finite number"));
        if (set_slope(of(c), vr[k], value[k]) != STATUS_OK) return fmi2Error;
    }
    return fmi2OK;
}

fmi2Status FMI2(fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                              const fmi2Integer order[], fmi2Real value[]) {
    (void)vr, (void)order, (void)value;
    return no_variable(c, n, "there are no derivatives of outputs");
}

fmi2Status FMI2(fmi2DoStep)(fmi2Component c, fmi2Real from, fmi2Real length, fmi2Boolean no_earlier) {
    (void)no_earlier;
    return status(do_step(of(c), from, length));
}

fmi2Status FMI2(fmi2CancelStep)(fmi2Component c) { return no_variable(c, 1, "no step runs that could be cancelled"); }

fmi2Status FMI2(fmi2GetStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    (void)kind, (void)value; /* a step is over when its call returns */
    return c ? fmi2Discard : fmi2Error;
}

fmi2Status FMI2(fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    if (!c || !value) return fmi2Error;
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = life_of(of(c))->time;
    return fmi2OK;
}

fmi2Status FMI2(fmi2GetIntegerStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    (void)kind, (void)value;
    return c ? fmi2Discard : fmi2Error;
}

fmi2Status FMI2(fmi2GetBooleanStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    if (!c || !value) return fmi2Error;
    if (kind != fmi2Terminated) return fmi2Discard;
    *value = life_of(of(c))->mode == MODE_TERMINATED;
    return fmi2OK;
}

fmi2Status FMI2(fmi2GetStringStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    (void)kind, (void)value;
    return c ? fmi2Discard : fmi2Error;
}
