/* Calls an FMU's functions wrongly, and then at random: each wrong call must return an error with a message, and nothing may crash.
 * Arguments: the folder of the resources, the token, how many random calls, and `bench` or `linear`. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2.h"
#include "fmi3.h"

static int messages, warnings, failures;
/* The last message of an error. */
static char said[256];

static void keep(const char *message) { snprintf(said, sizeof said, "%s", message); }

static void log2_(void *environment, const char *name, fmi2Status status, const char *category, const char *message, ...) {
    (void)environment, (void)name, (void)category;
    if (status == fmi2Warning) warnings++;
    else messages++, keep(message);
}

static void log3(void *environment, fmi3Status status, const char *category, const char *message) {
    (void)environment, (void)category;
    if (status == fmi3Warning) warnings++;
    else messages++, keep(message);
}

static const fmi2CallbackFunctions CALLBACKS = {log2_, NULL, NULL, NULL, NULL};

/* A call that must fail with one message or more. */
#define FAILS(call)                                                                       \
    do {                                                                                  \
        int before = messages;                                                            \
        if ((call) != 3 || messages == before) failures++, printf("not refused: %s\n", #call); \
    } while (0)
#define WORKS(call)                                                        \
    do {                                                                   \
        if ((call) != 0) failures++, printf("does not work: %s\n", #call); \
    } while (0)
#define HOLDS(condition)                                                        \
    do {                                                                        \
        if (!(condition)) failures++, printf("does not hold: %s\n", #condition); \
    } while (0)

static const char *folder, *token;
static char uri[4096];

static fmi2Component made2(fmi2Type type) {
    return fmi2Instantiate("one", type, token, uri, &CALLBACKS, 0, 0);
}

static fmi2Component started2(fmi2Type type) {
    fmi2Component c = made2(type);
    WORKS(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0));
    WORKS(fmi2EnterInitializationMode(c));
    WORKS(fmi2ExitInitializationMode(c));
    return c;
}

static void refused_instances(void) {
    int before = messages;
    HOLDS(fmi2Instantiate("x", fmi2CoSimulation, token, "file:///no/such/folder", &CALLBACKS, 0, 0) == NULL);
    HOLDS(fmi2Instantiate("x", fmi2CoSimulation, token, NULL, &CALLBACKS, 0, 0) == NULL);
    HOLDS(fmi2Instantiate("x", fmi2CoSimulation, "{other}", uri, &CALLBACKS, 0, 0) == NULL);
    HOLDS(fmi2Instantiate("x", fmi2CoSimulation, NULL, uri, &CALLBACKS, 0, 0) == NULL);
    HOLDS(fmi3InstantiateCoSimulation("x", token, "/no/such/folder/", 0, 0, 0, 0, NULL, 0, NULL, log3, NULL) == NULL);
    HOLDS(fmi3InstantiateModelExchange("x", token, NULL, 0, 0, NULL, log3) == NULL);
    HOLDS(fmi3InstantiateScheduledExecution("x", token, folder, 0, 0, NULL, log3, NULL, NULL, NULL) == NULL);
    HOLDS(messages - before == 7);
    HOLDS(fmi2Instantiate(NULL, fmi2CoSimulation, token, "", NULL, 0, 0) == NULL);
}

static void wrong_steps(void) {
    fmi2Component c = started2(fmi2CoSimulation);
    fmi2ValueReference engine = 3, limit = 23, initial = 30, output = 50, unknown = 999, draw = 41, mode = 40;
    fmi2Real value = 1.0, none = NAN, negative = -1.0;
    fmi2Integer many = 201, other = 3;
    WORKS(fmi2DoStep(c, 0.0, 0.01, 1));
    FAILS(fmi2DoStep(c, 0.0, 0.01, 1));
    FAILS(fmi2DoStep(c, 0.02, 0.01, 1));
    FAILS(fmi2DoStep(c, 0.01, -0.01, 1));
    FAILS(fmi2DoStep(c, 0.01, 0.0, 1));
    FAILS(fmi2DoStep(c, 0.01, NAN, 1));
    FAILS(fmi2DoStep(c, NAN, 0.01, 1));
    FAILS(fmi2DoStep(c, 0.01, INFINITY, 1));
    FAILS(fmi2DoStep(c, 0.01, 1e300, 1));
    FAILS(fmi2SetReal(c, &engine, 1, &none));
    FAILS(fmi2SetReal(c, &unknown, 1, &value));
    FAILS(fmi2GetReal(c, &unknown, 1, &value));
    FAILS(fmi2SetReal(c, &output, 1, &value));
    FAILS(fmi2SetReal(c, &initial, 1, &value));
    FAILS(fmi2SetReal(c, &limit, 1, &negative));
    FAILS(fmi2SetReal(c, NULL, 1, &value));
    FAILS(fmi2GetReal(c, &engine, 1, NULL));
    FAILS(fmi2SetInteger(c, &draw, 1, &many));
    FAILS(fmi2SetInteger(c, &mode, 1, &other));
    FAILS(fmi2GetInteger(c, &engine, 1, &other));
    FAILS(fmi2GetBoolean(c, &engine, 1, &other));
    FAILS(fmi2EnterInitializationMode(c));
    FAILS(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0));
    FAILS(fmi2NewDiscreteStates(c, NULL));
    FAILS(fmi2SetTime(c, 0.0));
    FAILS(fmi2EnterEventMode(c));
    FAILS(fmi2SetFMUstate(c, NULL));
    FAILS(fmi2DeSerializeFMUstate(c, "nonsense", 8, NULL));
    WORKS(fmi2GetDirectionalDerivative(c, &output, 1, &engine, 1, &value, &value));
    FAILS(fmi2GetDirectionalDerivative(c, &unknown, 1, &engine, 1, &value, &value));
    FAILS(fmi2GetDirectionalDerivative(c, &output, 1, &draw, 1, &value, &value));
    FAILS(fmi2GetDirectionalDerivative(c, &output, 1, &engine, 1, NULL, &value));
    WORKS(fmi2DoStep(c, 0.01, 0.01, 1));
    WORKS(fmi2Terminate(c));
    FAILS(fmi2DoStep(c, 0.02, 0.01, 1));
    FAILS(fmi2SetReal(c, &engine, 1, &value));
    WORKS(fmi2Reset(c));
    fmi2FreeInstance(c);
    HOLDS(fmi2DoStep(NULL, 0.0, 0.1, 1) == fmi2Error);
    HOLDS(fmi2SetReal(NULL, NULL, 0, NULL) == fmi2Error);
    fmi2FreeInstance(NULL);
}

/* A parameter that no bench has is refused with its name and its limit, and the value before stays. */
static void named_limits(void) {
    static const struct {
        fmi2ValueReference reference;
        fmi2Real value;
        const char *said;
    } CASES[] = {
        {10, 0.0, "J_d must be a finite number above 0 kg m2"}, {12, -1.0, "K must be a finite number, 0 Nm/rad or above"},
        {13, -1e-9, "B must be"},  {14, NAN, "K_p must be a finite number"}, {16, -1e-3, "tau_c must be a finite number, 0 s or above"},
        {17, -1e-3, "tau_n must be"}, {21, -1e-3, "tau_t must be"}, {23, -1.0, "T_limit must be a finite number, 0 Nm or above"},
        {16, 3.0, "tau_c + tau_t must be at most 508 T_s"}, {24, 3.0, "T_gate must be at most 508 T_s"},
    };
    fmi2Component c = started2(fmi2CoSimulation);
    for (size_t k = 0; k < sizeof CASES / sizeof *CASES; k++) {
        fmi2Real before = 0.0, after = 1.0;
        WORKS(fmi2GetReal(c, &CASES[k].reference, 1, &before));
        FAILS(fmi2SetReal(c, &CASES[k].reference, 1, &CASES[k].value));
        if (!strstr(said, CASES[k].said)) failures++, printf("said: %s, not: %s\n", said, CASES[k].said);
        WORKS(fmi2GetReal(c, &CASES[k].reference, 1, &after));
        HOLDS(before == after);
    }
    fmi2FreeInstance(c);
}

/* A loop that is not stable ends with an error, and an earlier state helps. */
static void unstable(void) {
    fmi2Component c = started2(fmi2CoSimulation);
    fmi2ValueReference gain = 14, demand = 1, limit = 23;
    fmi2Real high = 1e9, far = 500.0, no_limit = 0.0;
    fmi2FMUstate kept = NULL;
    int outcome = 0;
    WORKS(fmi2GetFMUstate(c, &kept));
    WORKS(fmi2SetReal(c, &limit, 1, &no_limit));
    WORKS(fmi2SetReal(c, &gain, 1, &high));
    WORKS(fmi2SetReal(c, &demand, 1, &far));
    for (int k = 0; k < 100 && outcome == 0; k++) outcome = fmi2DoStep(c, 0.1 * k, 0.1, 0);
    HOLDS(outcome == fmi2Error);
    FAILS(fmi2DoStep(c, 0.0, 0.1, 0));
    WORKS(fmi2SetFMUstate(c, kept));
    WORKS(fmi2DoStep(c, 0.0, 0.1, 0));
    HOLDS(warnings > 0);
    WORKS(fmi2FreeFMUstate(c, &kept));
    fmi2FreeInstance(c);
}

/* Bytes of a state come back; damaged ones are refused. */
static void states(void) {
    fmi2Component c = started2(fmi2CoSimulation), d = started2(fmi2CoSimulation);
    fmi2ValueReference outputs[] = {50, 52, 53};
    fmi2Real first[3], second[3];
    fmi2FMUstate kept = NULL, other = NULL;
    size_t size = 0;
    char *bytes;
    WORKS(fmi2DoStep(c, 0.0, 0.0123, 0));
    WORKS(fmi2GetFMUstate(c, &kept));
    WORKS(fmi2SerializedFMUstateSize(c, kept, &size));
    bytes = malloc(size);
    WORKS(fmi2SerializeFMUstate(c, kept, bytes, size));
    FAILS(fmi2SerializeFMUstate(c, kept, bytes, size - 1));
    WORKS(fmi2DeSerializeFMUstate(d, bytes, size, &other));
    WORKS(fmi2SetFMUstate(d, other));
    WORKS(fmi2DoStep(c, 0.0123, 0.05, 0));
    WORKS(fmi2DoStep(d, 0.0123, 0.05, 0));
    WORKS(fmi2GetReal(c, outputs, 3, first));
    WORKS(fmi2GetReal(d, outputs, 3, second));
    HOLDS(memcmp(first, second, sizeof first) == 0);
    WORKS(fmi2FreeFMUstate(d, &other));
    bytes[size / 2] ^= 1;
    FAILS(fmi2DeSerializeFMUstate(d, bytes, size, &other));
    WORKS(fmi2FreeFMUstate(c, &kept));
    free(bytes);
    fmi2FreeInstance(c);
    fmi2FreeInstance(d);
}

/* A linear model with two inputs, two outputs and draws. */
static void linear(void) {
    fmi2Component c = started2(fmi2CoSimulation), d = started2(fmi2CoSimulation), e = started2(fmi2ModelExchange);
    fmi2ValueReference inputs[] = {10, 11}, outputs[] = {12, 13}, initial = 14, unknown = 999, draw = 1;
    fmi2Real values[] = {3.0, -1.0}, none = NAN, first[2], second[2];
    fmi2Integer many = 201, seventh = 7;
    fmi2FMUstate kept = NULL, other = NULL;
    fmi2EventInfo info;
    size_t size = 0;
    char *bytes;
    WORKS(fmi2SetReal(c, inputs, 2, values));
    WORKS(fmi2SetInteger(c, &draw, 1, &seventh));
    WORKS(fmi2DoStep(c, 0.0, 0.0123, 1));
    FAILS(fmi2DoStep(c, 0.0, 0.01, 1));
    FAILS(fmi2DoStep(c, 0.0123, -0.01, 1));
    FAILS(fmi2DoStep(c, 0.0123, NAN, 1));
    FAILS(fmi2DoStep(c, 0.0123, 1e300, 1));
    FAILS(fmi2SetReal(c, inputs, 1, &none));
    FAILS(fmi2SetReal(c, &unknown, 1, values));
    FAILS(fmi2GetReal(c, &unknown, 1, values));
    FAILS(fmi2SetReal(c, outputs, 1, values));
    FAILS(fmi2SetReal(c, &initial, 1, values));
    FAILS(fmi2SetInteger(c, &draw, 1, &many));
    FAILS(fmi2GetBoolean(c, inputs, 1, &many));
    FAILS(fmi2GetDirectionalDerivative(e, outputs, 1, inputs, 1, values, first));
    FAILS(fmi2SetTime(c, 0.0));
    FAILS(fmi2SetFMUstate(e, NULL));
    WORKS(fmi2GetFMUstate(c, &kept));
    FAILS(fmi2SetFMUstate(e, kept));
    WORKS(fmi2SerializedFMUstateSize(c, kept, &size));
    bytes = malloc(size);
    FAILS(fmi2SerializeFMUstate(c, kept, bytes, size - 1));
    WORKS(fmi2SerializeFMUstate(c, kept, bytes, size));
    WORKS(fmi2DeSerializeFMUstate(d, bytes, size, &other));
    WORKS(fmi2SetFMUstate(d, other));
    WORKS(fmi2DoStep(c, 0.0123, 0.05, 0));
    WORKS(fmi2DoStep(d, 0.0123, 0.05, 0));
    WORKS(fmi2GetReal(c, outputs, 2, first));
    WORKS(fmi2GetReal(d, outputs, 2, second));
    HOLDS(memcmp(first, second, sizeof first) == 0 && first[0] != 0.0);
    bytes[size / 2] ^= 1;
    WORKS(fmi2FreeFMUstate(d, &other));
    FAILS(fmi2DeSerializeFMUstate(d, bytes, size, &other));
    WORKS(fmi2NewDiscreteStates(e, &info));
    WORKS(fmi2SetTime(e, 0.01));
    FAILS(fmi2NewDiscreteStates(e, &info));
    WORKS(fmi2FreeFMUstate(c, &kept));
    WORKS(fmi2Terminate(c));
    FAILS(fmi2DoStep(c, 0.0623, 0.01, 1));
    FAILS(fmi2SetReal(c, inputs, 2, values));
    free(bytes);
    fmi2FreeInstance(c), fmi2FreeInstance(d), fmi2FreeInstance(e);
}

/* ---- at random ----------------------------------------------------------------------------------------------- */

static unsigned long long state = 88172645463325252ull;

static unsigned int roll(unsigned int below) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (unsigned int)(state >> 33) % below;
}

static double any(void) {
    static const double odd[] = {0.0, 1.0, -1.0, 1e-3, 2.5e-4, 0.1, 1e300, -1e300, NAN, INFINITY, 1e-300, 0.01, 50.0};
    return roll(3) ? odd[roll(13)] : (double)roll(1000) * 1e-3;
}

static void random_calls(int count) {
    fmi2Component c = NULL;
    fmi3Instance e = NULL;
    fmi2FMUstate kept = NULL;
    double time = 0.0;
    for (int k = 0; k < count; k++) {
        fmi2ValueReference vr[2] = {roll(90), roll(90)};
        double value[2] = {any(), any()}, x[6] = {any(), 1.0, 0.0, 5.0, 0.0, 0.0}, result[2];
        int whole[2] = {(int)roll(300) - 10, 1};
        bool flag[2], flags[5];
        double length = fabs(any());
        fmi2EventInfo info;
        if (!c) {
            c = made2(roll(2) ? fmi2CoSimulation : fmi2ModelExchange);
            e = roll(2) ? fmi3InstantiateCoSimulation("e", token, folder, 0, 0, 0, 0, NULL, 0, NULL, log3, NULL)
                        : fmi3InstantiateModelExchange("e", token, folder, 0, 0, NULL, log3);
            time = 0.0;
        }
        switch (roll(24)) {
        case 0: fmi2SetupExperiment(c, 0, 0.0, any(), roll(2) != 0, any()); break;
        case 1: fmi2EnterInitializationMode(c), fmi3EnterInitializationMode(e, false, 0, 0, false, 0); break;
        case 2: fmi2ExitInitializationMode(c), fmi3ExitInitializationMode(e); break;
        case 3: fmi2SetReal(c, vr, 2, value), fmi3SetFloat64(e, vr, 2, value, 2); break;
        case 4: fmi2GetReal(c, vr, 2, result), fmi3GetFloat64(e, vr, 2, result, 2); break;
        case 5: fmi2SetInteger(c, vr, 2, whole), fmi3SetInt32(e, vr, 2, whole, 2); break;
        case 6: fmi2GetInteger(c, vr, 1, whole), fmi3GetInt32(e, vr, 1, whole, 1); break;
        case 7: fmi3GetBoolean(e, vr, 1, flag, 1); break;
        case 8: fmi2GetFMUstate(c, &kept); break;
        case 9: if (kept) fmi2SetFMUstate(c, kept); break;
        case 10: fmi2SetTime(c, any()), fmi3SetTime(e, any()); break;
        case 11: fmi2SetContinuousStates(c, x, roll(2) ? 6 : 5), fmi3SetContinuousStates(e, x, 6); break;
        case 12: fmi2GetDerivatives(c, x, 6), fmi3GetContinuousStateDerivatives(e, x, 6); break;
        case 13: fmi2NewDiscreteStates(c, &info); break;
        case 14: fmi3UpdateDiscreteStates(e, flags, flags + 1, flags + 2, flags + 3, flags + 4, result); break;
        case 15: fmi2EnterContinuousTimeMode(c), fmi3EnterContinuousTimeMode(e); break;
        case 16: fmi2EnterEventMode(c), fmi3EnterEventMode(e); break;
        case 17: fmi2GetDirectionalDerivative(c, vr, 1, vr + 1, 1, value, result); break;
        case 18: if (roll(20) == 0) fmi2Terminate(c), fmi3Terminate(e); break;
        case 19: if (roll(20) == 0) fmi2Reset(c), fmi3Reset(e), time = 0.0; break;
        case 20: if (roll(50) == 0) {
            fmi2FreeFMUstate(c, &kept);
            fmi2FreeInstance(c), fmi3FreeInstance(e);
            c = e = NULL;
        } break;
        default:
            if (length > 1.0 && length < 1e9) length = 1.0;
            if (fmi2GetReal(c, (fmi2ValueReference[]){0}, 1, &time) == fmi2OK) fmi2DoStep(c, time, length, 0);
            fmi3DoStep(e, time, length, false, flags, flags + 1, flags + 2, result);
        }
    }
    if (c) fmi2FreeFMUstate(c, &kept);
    fmi2FreeInstance(c), fmi3FreeInstance(e);
}

int main(int count, char **arguments) {
    if (count < 5) return 2;
    folder = arguments[1];
    token = arguments[2];
    snprintf(uri, sizeof uri, "file://%s", folder);
    refused_instances();
    if (strcmp(arguments[4], "bench") == 0) {
        wrong_steps();
        unstable();
        named_limits();
        states();
    } else {
        linear();
    }
    random_calls(atoi(arguments[3]));
    printf("failures %d\n", failures);
    return failures != 0;
}
