/* What FMI 2.0 calls its types and functions, as far as an FMU gives them. */
#ifndef DYNOID_FMI2_H
#define DYNOID_FMI2_H

#include <stddef.h>

#include "export.h"

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String instance, fmi2Status, fmi2String category, fmi2String message, ...);
    void *(*allocateMemory)(size_t count, size_t size);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded;
    fmi2Boolean terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

/* Where sources are linked into one program, an importer gives each FMU a prefix of its own. */
#ifdef FMI2_FUNCTION_PREFIX
#define FMI2_JOIN(prefix, name) prefix##name
#define FMI2_EXPAND(prefix, name) FMI2_JOIN(prefix, name)
#define FMI2(name) FMI2_EXPAND(FMI2_FUNCTION_PREFIX, name)
#else
#define FMI2(name) name
#endif
#define FMI2_CALL DYNOID_EXPORT fmi2Status

DYNOID_EXPORT const char *FMI2(fmi2GetTypesPlatform)(void);
DYNOID_EXPORT const char *FMI2(fmi2GetVersion)(void);
FMI2_CALL FMI2(fmi2SetDebugLogging)(fmi2Component, fmi2Boolean, size_t, const fmi2String[]);
DYNOID_EXPORT fmi2Component FMI2(fmi2Instantiate)(fmi2String, fmi2Type, fmi2String, fmi2String,
                                                 const fmi2CallbackFunctions *, fmi2Boolean, fmi2Boolean);
DYNOID_EXPORT void FMI2(fmi2FreeInstance)(fmi2Component);
FMI2_CALL FMI2(fmi2SetupExperiment)(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real);
FMI2_CALL FMI2(fmi2EnterInitializationMode)(fmi2Component);
FMI2_CALL FMI2(fmi2ExitInitializationMode)(fmi2Component);
FMI2_CALL FMI2(fmi2Terminate)(fmi2Component);
FMI2_CALL FMI2(fmi2Reset)(fmi2Component);
FMI2_CALL FMI2(fmi2GetReal)(fmi2Component, const fmi2ValueReference[], size_t, fmi2Real[]);
FMI2_CALL FMI2(fmi2GetInteger)(fmi2Component, const fmi2ValueReference[], size_t, fmi2Integer[]);
FMI2_CALL FMI2(fmi2GetBoolean)(fmi2Component, const fmi2ValueReference[], size_t, fmi2Boolean[]);
FMI2_CALL FMI2(fmi2GetString)(fmi2Component, const fmi2ValueReference[], size_t, fmi2String[]);
FMI2_CALL FMI2(fmi2SetReal)(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Real[]);
FMI2_CALL FMI2(fmi2SetInteger)(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Integer[]);
FMI2_CALL FMI2(fmi2SetBoolean)(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Boolean[]);
FMI2_CALL FMI2(fmi2SetString)(fmi2Component, const fmi2ValueReference[], size_t, const fmi2String[]);
FMI2_CALL FMI2(fmi2GetFMUstate)(fmi2Component, fmi2FMUstate *);
FMI2_CALL FMI2(fmi2SetFMUstate)(fmi2Component, fmi2FMUstate);
FMI2_CALL FMI2(fmi2FreeFMUstate)(fmi2Component, fmi2FMUstate *);
FMI2_CALL FMI2(fmi2SerializedFMUstateSize)(fmi2Component, fmi2FMUstate, size_t *);
FMI2_CALL FMI2(fmi2SerializeFMUstate)(fmi2Component, fmi2FMUstate, fmi2Byte[], size_t);
FMI2_CALL FMI2(fmi2DeSerializeFMUstate)(fmi2Component, const fmi2Byte[], size_t, fmi2FMUstate *);
FMI2_CALL FMI2(fmi2GetDirectionalDerivative)(fmi2Component, const fmi2ValueReference[], size_t,
                                             const fmi2ValueReference[], size_t, const fmi2Real[], fmi2Real[]);
/* Model Exchange */
FMI2_CALL FMI2(fmi2EnterEventMode)(fmi2Component);
FMI2_CALL FMI2(fmi2NewDiscreteStates)(fmi2Component, fmi2EventInfo *);
FMI2_CALL FMI2(fmi2EnterContinuousTimeMode)(fmi2Component);
FMI2_CALL FMI2(fmi2CompletedIntegratorStep)(fmi2Component, fmi2Boolean, fmi2Boolean *, fmi2Boolean *);
FMI2_CALL FMI2(fmi2SetTime)(fmi2Component, fmi2Real);
FMI2_CALL FMI2(fmi2SetContinuousStates)(fmi2Component, const fmi2Real[], size_t);
FMI2_CALL FMI2(fmi2GetDerivatives)(fmi2Component, fmi2Real[], size_t);
FMI2_CALL FMI2(fmi2GetEventIndicators)(fmi2Component, fmi2Real[], size_t);
FMI2_CALL FMI2(fmi2GetContinuousStates)(fmi2Component, fmi2Real[], size_t);
FMI2_CALL FMI2(fmi2GetNominalsOfContinuousStates)(fmi2Component, fmi2Real[], size_t);
/* Co-Simulation */
FMI2_CALL FMI2(fmi2SetRealInputDerivatives)(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Integer[],
                                            const fmi2Real[]);
FMI2_CALL FMI2(fmi2GetRealOutputDerivatives)(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Integer[],
                                             fmi2Real[]);
FMI2_CALL FMI2(fmi2DoStep)(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean);
FMI2_CALL FMI2(fmi2CancelStep)(fmi2Component);
FMI2_CALL FMI2(fmi2GetStatus)(fmi2Component, const fmi2StatusKind, fmi2Status *);
FMI2_CALL FMI2(fmi2GetRealStatus)(fmi2Component, const fmi2StatusKind, fmi2Real *);
FMI2_CALL FMI2(fmi2GetIntegerStatus)(fmi2Component, const fmi2StatusKind, fmi2Integer *);
FMI2_CALL FMI2(fmi2GetBooleanStatus)(fmi2Component, const fmi2StatusKind, fmi2Boolean *);
FMI2_CALL FMI2(fmi2GetStringStatus)(fmi2Component, const fmi2StatusKind, fmi2String *);

#endif
